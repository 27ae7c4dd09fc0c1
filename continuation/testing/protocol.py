"""Checks of the protocol: shapes, types, and that results depend on the arguments only."""

from __future__ import annotations

import math
import pickle
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.linear import SingularError, factor_bordered
from continuation.testing.subject import Place, Subject, called, dense, directions, fail

_ENTRY = re.compile(r"\s*@\w+\s*\{\s*[^,\s]+\s*,", re.ASCII)

Call = Callable[..., Any]


def start(subject: Subject) -> None:
    """`start` gives a finite vector and a number, and the residual fits it."""
    _ = subject.start  # It is checked when it is first asked for, as a trace checks it.


def start_on_path(subject: Subject) -> None:
    """The start is on the path or near it, and H' has full rank there."""
    _ = subject.first  # Computed when it is first asked for, as a trace begins.


def residual(subject: Subject) -> None:
    """The residual is a float64 vector of shape (N,), finite on the path."""
    for place in subject.places:
        with called("residual", place.where):
            value = np.asarray(subject.homotopy.residual(place.y, place.lam))
        if value.shape != (place.u.size - 1,):
            fail(f"residual: {place.where} expected shape {(place.u.size - 1,)}, found {value.shape}")
        if value.dtype.kind not in "fiu" or (value.dtype.kind == "f" and value.dtype.itemsize < 8):
            fail(f"residual: {place.where} expected float64, found {value.dtype}")
        if not np.isfinite(value).all():
            i = int(np.argmin(np.isfinite(value)))
            fail(f"residual: {place.where} component {i} is {value[i]}, expected a finite number")


def target(subject: Subject) -> None:
    """The target is a finite number or None."""
    value = subject.homotopy.target
    if not isinstance(value, (int, float, np.integer, np.floating)) or not math.isfinite(value):
        fail(f"target: expected a finite number or None, found {value!r}")


def jacobian_types(subject: Subject) -> None:
    """`jacobian` gives a matrix that the engine factors, and a vector, of the right shapes."""
    for place in subject.places:
        with called("jacobian", place.where):
            answer = subject.homotopy.jacobian(place.y, place.lam)
        if not isinstance(answer, tuple) or len(answer) != 2:
            fail(f"jacobian: {place.where} expected a tuple (H_y, H_lam), found {type(answer).__name__}")
        n = place.u.size - 1
        shape = np.shape(answer[1])
        if shape != (n,):
            fail(f"jacobian: {place.where} expected H_lam of shape {(n,)}, found {shape}")
        try:
            with np.errstate(all="ignore"):
                factor_bordered(answer[0], np.asarray(answer[1], dtype=float), np.ones(n + 1))
        except SingularError:
            # Singular with this border: the start has been found regular by a check of its own.
            continue
        except (TypeError, ValueError) as error:
            fail(f"jacobian: {place.where} {error}")


def inputs_not_modified(subject: Subject) -> None:
    """No method changes an array that it is given."""
    for place in subject.places:
        for name, method, arguments in _calls(subject, place):
            given = [np.array(a) if isinstance(a, np.ndarray) else a for a in arguments]
            with called(name, place.where):
                method(*given)
            for number, (before, after) in enumerate(zip(arguments, given)):
                if isinstance(before, np.ndarray) and not np.array_equal(before, after, equal_nan=True):
                    change = float(np.abs(after - before).max())
                    fail(f"{name}: {place.where} it changes its argument number {number + 1}, by up to {change:.3g}")


def repeatable(subject: Subject) -> None:
    """The same arguments give the same bits after other calls, and no later call changes an earlier answer."""
    _check_start_is_new(subject)
    for place in subject.places:
        for name, method, arguments in _calls(subject, place):
            with called(name, place.where):
                kept = method(*arguments)
                before = _numbers(kept, place)
            for elsewhere in subject.places:
                if elsewhere is not place:
                    for other, ask, values in _calls(subject, elsewhere):
                        if other == name:
                            with called(name, elsewhere.where):
                                ask(*values)
            with called(name, place.where):
                now, again = _numbers(kept, place), _numbers(method(*arguments), place)
            _same(name, place, before, again, "a second call with the same arguments differs from the first")
            _same(name, place, before, now, "an answer changes when the method is called again: return new arrays")


def _check_start_is_new(subject: Subject) -> None:
    y0, _ = subject.homotopy.start()
    if isinstance(y0, np.ndarray) and y0.flags.writeable:
        kept = y0.copy()
        y0 += np.ones_like(y0)
        again = np.array(subject.homotopy.start()[0])
        y0[...] = kept
        if not np.array_equal(again, kept):
            fail("start: it returns its own array; changing y0 in place changes the homotopy (return a copy)")


def metric(subject: Subject) -> None:
    """The weights are positive and finite, one a component, at the start and after it."""
    for place in subject.places:
        v = directions(place.u.size, 1, 2)[0]
        with called("metric.weights", place.where):
            first = subject.homotopy.metric.weights(place.u.copy(), v, None)
            second = subject.homotopy.metric.weights(place.u.copy(), v, first)
        for weights in (first, second):
            if not isinstance(weights, np.ndarray) or weights.shape != place.u.shape:
                fail(f"metric: {place.where} expected weights of shape {place.u.shape}, found {np.shape(weights)}")
            good = np.isfinite(weights) & (weights > 0.0)
            if not good.all():
                i = int(np.argmin(good))
                fail(f"metric: {place.where} weight {i} is {weights[i]}, expected a positive finite number")


def observe(subject: Subject) -> None:
    """`observe` gives the same names everywhere, and numbers."""
    names: list[str] | None = None
    for place in subject.places:
        with called("observe", place.where):
            found = subject.homotopy.observe(place.y, place.lam)
        if not isinstance(found, Mapping):
            fail(f"observe: {place.where} expected a dictionary of numbers, found {type(found).__name__}")
        for name, value in found.items():
            if not isinstance(name, str) or not isinstance(value, (int, float, np.integer, np.floating)):
                fail(f"observe: {place.where} expected names and real numbers, found {name!r}: {value!r}")
        if names is not None and list(found) != names:
            fail(f"observe: {place.where} the names are {list(found)}, at the start {names}")
        names = list(found)


def finish(subject: Subject) -> None:
    """`finish` gives None, or the unknowns of an end."""
    for place in subject.places:
        with called("finish", place.where):
            y = subject.homotopy.finish(place.y, place.lam)
        if y is not None and (np.shape(y) != place.y.shape or not np.isfinite(y).all()):
            fail(f"finish: {place.where} expected None or {place.u.size - 1} finite numbers, found {y!r}")


def events(subject: Subject) -> None:
    """Each event has a name, a kind, when it ends the path, and a monitor that gives a number."""
    for event in subject.homotopy.events:
        for name in ("name", "kind", "terminal", "direction", "monitor"):
            if not hasattr(event, name):
                fail(f"events: expected `{name}` on {event!r}, found none")
        for place in subject.places:
            with called(f"monitor of event {event.name!r}", place.where):
                value = float(event.monitor(place.u.copy(), directions(place.u.size, 1, 3)[0]))
            if not math.isfinite(value):
                fail(f"events: {place.where} the monitor of {event.name!r} is {value}, expected a finite number")


def references(subject: Subject) -> None:
    """Each reference is a BibTeX entry."""
    found = subject.homotopy.references
    if isinstance(found, str):
        fail("references: expected a sequence of BibTeX entries, found one string")
    for k, entry in enumerate(found):
        if not isinstance(entry, str) or not _ENTRY.match(entry) or entry.count("{") != entry.count("}"):
            fail(f"references: number {k} is no BibTeX entry (@kind{{key, ...}}), found {str(entry)[:40]!r}")


def picklable(subject: Subject) -> None:
    """A copy made by pickle, as for another process, is the same homotopy."""
    try:
        again = pickle.loads(pickle.dumps(subject.homotopy))
    except Exception as error:  # Pickle raises what the object's methods raise.
        fail(f"picklable: {type(error).__name__}: {error} (sweeps in several processes need it)")
    twin = Subject(again)
    if not np.array_equal(twin.start.u, subject.start.u):
        fail(f"picklable: the copy starts elsewhere, by {float(np.abs(twin.start.u - subject.start.u).max()):.3g}")
    for place in subject.places:
        with called("residual of the pickled copy", place.where):
            found, wanted = (h.residual(place.y, place.lam) for h in (again, subject.homotopy))
        if not np.array_equal(found, wanted):
            fail(f"picklable: {place.where} the copy's residual differs by {difference(found, wanted):.3g}")


def _calls(subject: Subject, place: Place) -> list[tuple[str, Call, tuple[Any, ...]]]:
    """Every method that the homotopy has, with arguments at a place."""
    h, y, lam, u = subject.homotopy, place.y, place.lam, place.u
    v, border = directions(u.size, 2, 1)
    found: list[tuple[str, Call, tuple[Any, ...]]] = [("residual", h.residual, (y, lam))]
    for name, arguments in (
        ("jacobian", (y, lam)),
        ("bordered", (y, lam, border)),
        ("differential", (y, lam, v)),
        ("max_step", (u, v)),
        ("observe", (y, lam)),
    ):
        if subject.has(name):
            found.append((name, getattr(h, name), arguments))
    return found


def _numbers(answer: Any, place: Place) -> list[Array]:
    """The numbers in an answer; of a factorisation, what it answers."""
    n = place.u.size - 1
    if hasattr(answer, "solve"):
        return [np.array(answer.solve(np.ones(n), 1.0)), np.array([float(answer.sign)])]
    if isinstance(answer, Mapping):
        return [np.array(list(answer.values()), dtype=float)]
    if isinstance(answer, tuple):
        return [dense(answer[0], n).copy(), np.array(answer[1], dtype=float)]
    return [np.array(answer, dtype=float)]


def _same(name: str, place: Place, before: list[Array], after: list[Array], sentence: str) -> None:
    for p, q in zip(before, after, strict=True):
        if not np.array_equal(p, q, equal_nan=True):
            fail(f"{name}: {place.where} {sentence}, by up to {difference(p, q):.3g}")


def difference(p: Array, q: Array) -> float:
    """The largest one; infinite where the shapes differ."""
    return float(np.abs(p - q).max()) if np.shape(p) == np.shape(q) else math.inf
