"""Checks of shapes, types and repeatability."""

from __future__ import annotations

import math
import pickle
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.linear import SingularError, factor_bordered
from continuation.testing.subject import (
    CheckFailure,
    Place,
    Subject,
    compare,
    dense,
    random_directions,
    reporting,
    require,
)

_ENTRY = re.compile(r"\s*@\w+\s*\{\s*[^,\s]+\s*,", re.ASCII)


def answers(
    name: str, ask: Callable[[Any, Place], Any], good: Callable[[Any, int], bool], wanted: str
) -> Callable[[Subject], None]:
    """A check that `good(answer, N)` holds at every place."""

    def examine(subject: Subject) -> None:
        for place in subject.places:
            with reporting(name, place.where):
                found = ask(subject.homotopy, place)
                well = good(found, place.u.size - 1)
            require(well, f"{name}: {place.where} expected {wanted}, found {found!r:.80}")

    return examine


def _number(x: Any) -> bool:
    return isinstance(x, int | float | np.integer | np.floating)


def _double(x: Any, n: int) -> bool:
    kinds = x.dtype.kind in "iu" or x.dtype == np.float64
    return x.shape == (n,) and kinds and bool(np.isfinite(x).all())


def _weights(homotopy: Any, place: Place) -> tuple[Any, Any]:
    v = random_directions(place.u.size, 1, 2)[0]
    first = homotopy.metric.weights(place.u.copy(), v, None)
    return first, homotopy.metric.weights(place.u.copy(), v, first)


def _observed(homotopy: Any, place: Place) -> tuple[Any, Any]:
    y, lam = homotopy.start()
    return homotopy.observe(place.y, place.lam), homotopy.observe(np.array(y, dtype=float), float(lam))


def _monitored(homotopy: Any, place: Place) -> list[float]:
    v = random_directions(place.u.size, 1, 3)[0]
    return [float(event.monitor(place.u.copy(), v)) for event in homotopy.events]


def _entries(found: Any, n: int) -> bool:
    entries = [] if isinstance(found, str) else [str(entry) for entry in found]
    whole = all(_ENTRY.match(entry) and entry.count("{") == entry.count("}") for entry in entries)
    return whole and not isinstance(found, str)


def _factored(answer: Any, n: int) -> bool:
    if not isinstance(answer, tuple) or len(answer) != 2 or np.shape(answer[1]) != (n,):
        return False
    # Another check tests regularity.
    with suppress(SingularError):
        factor_bordered(answer[0], np.asarray(answer[1], dtype=float), np.ones(n + 1))
    return True


residual = answers(
    "residual",
    lambda h, place: np.asarray(h.residual(place.y, place.lam)),
    _double,
    "one finite number of float64 for each unknown",
)
target = answers(
    "target", lambda h, _: h.target, lambda x, _: _number(x) and math.isfinite(x), "a finite number or None"
)
metric = answers(
    "metric",
    _weights,
    lambda pair, n: all(np.shape(w) == (n + 1,) and np.isfinite(w).all() and (w > 0.0).all() for w in pair),
    "one positive finite weight for each component",
)
observe = answers(
    "observe",
    _observed,
    lambda pair, _: isinstance(pair[0], Mapping) and [*pair[0]] == [*pair[1]] and all(map(_number, pair[0].values())),
    "a dictionary of real numbers with names that are the same everywhere",
)
finish = answers(
    "finish",
    lambda h, place: h.finish(place.y, place.lam),
    lambda y, n: y is None or (np.shape(y) == (n,) and bool(np.isfinite(y).all())),
    "None or one finite number for each unknown",
)
events = answers("events", _monitored, lambda x, _: bool(np.isfinite(x).all()), "a finite number of every monitor")
jacobian_types = answers(
    "jacobian",
    lambda h, place: h.jacobian(place.y, place.lam),
    _factored,
    "a tuple (H_y, H_lam), of which H_lam has one number for each unknown",
)
references = answers(
    "references", lambda h, _: h.references, _entries, "a sequence of BibTeX entries (@kind{key, ...})"
)


def repeatable(subject: Subject) -> None:
    """Equal arguments give equal bits; calls change neither arguments nor earlier answers."""
    first, second = (subject.homotopy.start()[0] for _ in range(2))
    if isinstance(first, np.ndarray) and first.flags.writeable:
        kept = "start: it returns its own array; changing y0 in place changes the homotopy (return a copy)"
        require(not np.shares_memory(first, second), kept)
    for name in filter(subject.has, _METHODS):
        asked = [(place, _asked(subject, place, name)) for place in subject.places]
        for place, (answer, before) in asked:
            changes = "an answer changes when the method is called again (return new arrays): number"
            compare(name, place, changes, _numbers(name, answer, place), before)
            differs = "a second call with the same arguments differs from the first: number"
            compare(name, place, differs, _asked(subject, place, name)[1], before)


def picklable(subject: Subject) -> None:
    """A pickled copy is the same homotopy."""
    try:
        again = pickle.loads(pickle.dumps(subject.homotopy))
    except Exception as error:  # Pickle raises anything.
        said = f"picklable: {type(error).__name__}: {error} (sweeps in several processes need it)"
        raise CheckFailure(said) from error
    require(np.array_equal(Subject(again).start.u, subject.start.u), "picklable: the copy starts elsewhere")
    same_residual(subject, again, "picklable", "the copy")


def same_residual(subject: Subject, other: Any, name: str, what: str) -> None:
    """Both residuals agree bit for bit."""
    for place in subject.places:
        with reporting(f"residual of {what}", place.where):
            found, wanted = (h.residual(place.y, place.lam) for h in (other, subject.homotopy))
        compare(name, place, f"{what} has another residual: number", found, wanted)


_METHODS = ("residual", "jacobian", "bordered", "differential", "max_step", "observe", "switches")

_PARTS: Mapping[str, Callable[[Any, int], list[Any]]] = {
    "jacobian": lambda answer, n: [dense(answer[0], n), answer[1]],
    "bordered": lambda answer, n: [answer.solve(np.ones(n), 1.0), answer.sign],
    "observe": lambda answer, _: list(answer.values()),
}
"""An answer's numbers."""


def _asked(subject: Subject, place: Place, name: str) -> tuple[Any, Array]:
    """An answer, and its numbers now."""
    v, border = random_directions(place.u.size, 2, 1)
    more = {"bordered": (border,), "differential": (v,)}.get(name, ())
    arguments = (place.u, v) if name == "max_step" else (place.y, place.lam, *more)
    given = [np.copy(x) if isinstance(x, np.ndarray) else x for x in arguments]
    with reporting(name, place.where):
        answer = getattr(subject.homotopy, name)(*given)
    compare(name, place, "it changes its arguments: number", np.hstack(given), np.hstack(arguments))
    return answer, _numbers(name, answer, place)


def _numbers(name: str, answer: Any, place: Place) -> Array:
    parts = _PARTS[name](answer, place.u.size - 1) if name in _PARTS else [answer]
    return np.hstack([np.ravel(part) for part in parts]).astype(float)
