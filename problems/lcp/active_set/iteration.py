"""The active-set iteration: solve on a face, change the wrong signs, repeat.

It is Newton's method on the natural map, for an LCP min(x, A x + q) = 0.

References
----------
Hintermueller, Ito and Kunisch, SIAM J. Optim. 13 (2003); Kostreva, Linear Algebra Appl. 21 (1978).
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.counts import Counts
from problems.lcp.active_set.face import Face, Faces
from problems.lcp.data.problem import BETWEEN, UPPER, State

Judge = Callable[[Face, Array, Array], tuple[Array, Array, bool]]
"""(face, x, w) -> (x, w, solved); may improve the point."""


class Ended(Enum):
    """Why an iteration ended."""

    SOLVED = "the point was judged to be the solution"
    SETTLED = "the signs ask for the same set again"
    TRIED = "the set was tried before"
    SINGULAR = "the equations of the face have no finite solution, or too many were singular"
    CYCLING = "the number of changes does not fall"
    STEPS = "all steps are used up"


@frozen
class Policy:
    """How long the iteration goes on.

    `steps`: most corrections. `patience`: as `PATIENCE`. `singular`: so many singular faces are not counted as steps
    (None: all are); 0 ends at the first one.
    """

    steps: int
    patience: int | None = None
    singular: int | None = None


AT_END = Policy(steps=2)
"""The last corrections of a method, whose set is right but for rounding."""


def key_of(state: State) -> bytes:
    """A short key of a state."""
    key, above = np.packbits(state == BETWEEN).tobytes(), state == UPPER
    return key + np.packbits(above).tobytes() if above.any() else key


@frozen(eq=False)
class Iterated:
    """The end of an iteration."""

    ended: Ended
    state: State
    x: Array


def iterate(
    faces: Faces,
    state: State,
    policy: Policy,
    *,
    near: Array | None = None,
    shift: float | None = None,
    judge: Judge | None = None,
    tried: set[bytes] | None = None,
    counts: Counts | None = None,
) -> Iterated:
    """Correct an active set until it is right or given up.

    A singular face gives a point near the last x, at first `near`. With a shift LCP(q - shift near, A + shift I) is
    solved. `judge` recognises a solution. Sets in `tried` end the iteration, which adds its own.
    """
    x = np.zeros(faces.problem.n) if near is None else near
    centre = None if shift is None else x
    changes: list[int] = []
    singular = 0
    while len(changes) - min(singular, policy.singular or 0) <= policy.steps:
        if tried is not None:
            key = key_of(state)
            if key in tried or key + x.tobytes() in tried:
                return Iterated(Ended.TRIED, state, x)
        if counts is not None:
            counts.factorizations += 1
        face = faces.face(state, shift or 0.0, centre, policy.singular == 0)
        singular += face is None or not face.exact
        if policy.singular == 0 and singular:
            return Iterated(Ended.SINGULAR, state, x)
        if tried is not None:
            tried.add(key if face is None or face.exact else key + x.tobytes())
        point = None if face is None else face.point(x)
        if face is None or point is None:
            return Iterated(Ended.SINGULAR, state, x)
        x, w = point
        if judge is not None:
            x, w, solved = judge(face, x, w)
            if solved:
                return Iterated(Ended.SOLVED, state, x)
        following = faces.problem.corrected(state, x, w)
        changes.append(int(np.count_nonzero(following != state)))
        if changes[-1] == 0:
            return Iterated(Ended.SETTLED, state, x)
        if policy.patience is not None and _cycling(changes, policy.patience):
            return Iterated(Ended.CYCLING, state, x)
        state = following
    return Iterated(Ended.STEPS, state, x)


def _cycling(changes: list[int], patience: int) -> bool:
    return len(changes) > patience and min(changes[-patience:]) >= min(changes[:-patience])
