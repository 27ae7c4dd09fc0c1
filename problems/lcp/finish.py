"""The exact end: guess which x_i are positive, solve on that face, verify; or correct the guess a few times.

A step from a guess is one of the primal-dual active-set method, which is Newton's method on min(x, A x + q) = 0.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from continuation.arrays import Array
from continuation.evaluation import Counts
from problems.lcp.certificate import certify
from problems.lcp.faces import Face, Faces
from problems.lcp.problem import LCP

Mask = NDArray[np.bool_]

LATEST_START = 0.5
"""The finish is first tried on a path when its parameter has fallen to this."""

CAPABILITIES = (
    "target", "metric", "references", "start", "residual", "jacobian", "bordered", "differential", "taylor", "max_step",
    "observe",
)  # fmt: skip

SPACING = 0.4
"""and then each time it has fallen by this factor since."""

STEPS = 4
"""Corrections of the guess at each try on a path."""


@define(eq=False)
class Finish:
    """Tries active sets of one problem and remembers which were tried; shared by all of its paths.

    Attributes
    ----------
    faces : Faces
        Of the problem.
    tolerance : float
        What `Certificate.solves` is asked.
    counts : Counts
        Where factorisations are added up.
    """

    faces: Faces
    tolerance: float
    counts: Counts = field(factory=Counts)
    _tried: set[bytes] = field(factory=set, init=False)

    @property
    def problem(self) -> LCP:
        """The problem."""
        return self.faces.problem

    def settle(self, active: Mask, steps: int, near: Array | None = None) -> Array | None:
        """The solution on the face {x_i = 0 off `active`, w_i = 0 on it}, or on one of `steps` corrected faces.

        Parameters
        ----------
        active : Mask
            The guess.
        steps : int
        near : Array, optional
            Where a face holds many points, the one nearest to this is taken; zero by default.
        """
        x = np.zeros(self.problem.n) if near is None else near
        for _ in range(steps + 1):
            key = np.packbits(active).tobytes()
            if key in self._tried:
                return None
            self._tried.add(key)
            self.counts.factorizations += 1
            face = self.faces.face(active)
            point = None if face is None else face.point(x)
            if face is None or point is None:
                return None
            x, w = point
            found = self._accepted(face, x, w)
            if found is not None:
                return found
            active = np.where(active, x > 0.0, w < 0.0)
        return None

    def _accepted(self, face: Face, x: Array, w: Array) -> Array | None:
        """The certified point, corrected in twice the working precision if need be; None where it does not solve."""
        lowest = -self.tolerance * self.problem.scale(x)
        if float(x.min()) < lowest or float(w.min()) < lowest:
            return None
        candidate = x
        for _ in range(3):
            candidate = np.maximum(candidate, 0.0)
            if certify(self.problem, candidate).solves(self.tolerance):
                return candidate
            candidate = face.refined(candidate)
            if not np.isfinite(candidate).all():
                return None
        return None


@define(eq=False, slots=False)
class Finishing:
    """A homotopy of this package with the finish as its own way to end; everything else is the homotopy's own.

    Attributes
    ----------
    homotopy : KKTHomotopy or TwoVectorHomotopy
        Its first n unknowns are x.
    attempt : Finish or None
        None in a homotopy read from an archive, which has no finish of its own.
    next_lam : float
        The finish is tried when the parameter has fallen to this.
    """

    homotopy: Any
    attempt: Finish
    next_lam: float = field(default=LATEST_START, init=False)

    def __attrs_post_init__(self) -> None:
        # As attributes of the object itself: a wrapped call costs nothing, and each capability is found by its presence.
        for name in CAPABILITIES:
            setattr(self, name, getattr(self.homotopy, name))

    def finish(self, y: Array, lam: float) -> Array | None:
        """The certified end, its x in place of the first n unknowns; None to go on."""
        if lam > self.next_lam:
            return None
        self.next_lam = SPACING * lam
        problem = self.attempt.problem
        x = y[: problem.n]
        solved = self.attempt.settle(x > problem.w(x), STEPS, x)
        return None if solved is None else np.concatenate([solved, y[problem.n :]])
