"""Checks of shapes, types and repeatability."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.linear import SingularError, factor_bordered
from continuation.testing.subject import (
    CheckFailure,
    Subject,
    TestedPoint,
    compare,
    dense,
    random_directions,
    reporting,
    require,
)


def answers(
    name: str, ask: Callable[[Any, TestedPoint], Any], good: Callable[[Any, int], bool], wanted: str
) -> Callable[[Subject], None]:
    """A check that `good(answer, N)` holds at every place."""

    def examine(subject: Subject) -> None:
        for place in subject.places:
            with reporting(name, place.where):
                found = ask(subject.homotopy, place)
                well = good(found, place.u.size - 1)
            require(well, f"{name}: {place.where} expected {wanted}, found {found!r:.80}")

    return examine


def _double(x: Any, n: int) -> bool:
    kinds = x.dtype.kind in "iu" or x.dtype == np.float64
    return x.shape == (n,) and kinds and bool(np.isfinite(x).all())


def _weights(homotopy: Any, place: TestedPoint) -> tuple[Any, Any]:
    v = random_directions(place.u.size, 1, 2)[0]
    first = homotopy.metric.weights(place.u.copy(), v, None)
    return first, homotopy.metric.weights(place.u.copy(), v, first)


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
metric = answers(
    "metric",
    _weights,
    lambda pair, n: all(np.shape(w) == (n + 1,) and np.isfinite(w).all() and (w > 0.0).all() for w in pair),
    "one positive finite weight for each component",
)
jacobian_types = answers(
    "jacobian",
    lambda h, place: h.jacobian(place.y, place.lam),
    _factored,
    "a tuple (H_y, H_lam), of which H_lam has one number for each unknown",
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
    for place in subject.places:
        with reporting("residual of the copy", place.where):
            found, wanted = (h.residual(place.y, place.lam) for h in (again, subject.homotopy))
        compare("picklable", place, "the copy has another residual: number", found, wanted)


_METHODS = ("residual", "jacobian", "bordered", "differential", "max_step", "observe", "switches")

_PARTS: Mapping[str, Callable[[Any, int], list[Any]]] = {
    "jacobian": lambda answer, n: [dense(answer[0], n), answer[1]],
    "bordered": lambda answer, n: [answer.solve(np.ones(n), 1.0), answer.sign],
    "observe": lambda answer, _: list(answer.values()),
}
"""An answer's numbers."""


def _asked(subject: Subject, place: TestedPoint, name: str) -> tuple[Any, Array]:
    """An answer, and its numbers now."""
    v, border = random_directions(place.u.size, 2, 1)
    more = {"bordered": (border,), "differential": (v,)}.get(name, ())
    arguments = (place.u, v) if name == "max_step" else (place.y, place.lam, *more)
    given = [np.copy(x) if isinstance(x, np.ndarray) else x for x in arguments]
    with reporting(name, place.where):
        answer = getattr(subject.homotopy, name)(*given)
    compare(name, place, "it changes its arguments: number", np.hstack(given), np.hstack(arguments))
    return answer, _numbers(name, answer, place)


def _numbers(name: str, answer: Any, place: TestedPoint) -> Array:
    parts = _PARTS[name](answer, place.u.size - 1) if name in _PARTS else [answer]
    return np.hstack([np.ravel(part) for part in parts]).astype(float)
