"""The exact end: guess which x_i are positive, solve on that face, verify; or correct the guess a few times.

A step from a guess is one of the primal-dual active-set method, which is Newton's method on min(x, A x + q) = 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from continuation.arrays import Array
from continuation.counts import Counts
from continuation.linear import BorderedSystem
from problems.lcp.active_set.face import Face, Faces
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.certificate import ROUND_OFF, Certificate, certify
from problems.lcp.proof.verdict import confirmed

Mask = NDArray[np.bool_]

LATEST_START = 0.5
"""The finish is first tried on a path when its parameter has fallen to this."""

CORRECTIONS = 2
"""Refinements of a point whose signs are nearly right."""

CAPABILITIES = (
    "target", "metric", "references", "start", "residual", "jacobian", "bordered", "differential", "taylor", "max_step",
    "observe",
)  # fmt: skip

LARGEST_PRODUCT = 1.0
"""nor before the products x z1 (or x y) have fallen to this, in the problem's natural units,"""

SPACING = 0.4
"""and then each time the parameter has fallen by this factor since."""

STEPS = 4
"""Corrections of the guess at each try on a path."""

PATIENCE = 3
"""So many corrections in a row that do not bring the number of changed indices to a new low are going in circles."""

SHIFTS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
"""Of the diagonal, in units of its mean, in the rounds of the proximal method."""

ROUND_STEPS = 25
"""Corrections in one of its rounds."""

ROUND_PATIENCE = 5
"""The patience in its rounds: what is solved there has one solution, and mostly a way to it."""


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
    certificate : Certificate or None
        Of the last solution found.
    """

    faces: Faces
    tolerance: float
    counts: Counts = field(factory=Counts)
    certificate: Certificate | None = field(default=None, init=False)
    _tried: set[bytes] = field(factory=set, init=False)
    _last: Mask | None = field(default=None, init=False)

    @property
    def problem(self) -> LCP:
        """The problem."""
        return self.faces.problem

    def settle(
        self, active: Mask, steps: int, near: Array | None = None, patience: int | None = None
    ) -> Array | None:
        """The solution on the face {x_i = 0 off `active`, w_i = 0 on it}, or on one of `steps` corrected faces.

        Parameters
        ----------
        active : Mask
            The guess.
        steps : int
        near : Array, optional
            Where a face holds many points, the one nearest to this is taken; zero by default.
        patience : int, optional
            Corrections in a row without a new low of the changes after which it is given up; see `PATIENCE`.
        """
        x = np.zeros(self.problem.n) if near is None else near
        changes: list[int] = []
        for _ in range(steps + 1):
            key = np.packbits(active).tobytes()
            if key in self._tried:
                return None
            self._tried.add(key)
            self._last = active
            self.counts.factorizations += 1
            face = self.faces.face(active)
            point = None if face is None else face.point(x)
            if face is None or point is None:
                return None
            x, w = point
            if self._plausible(x, w):
                x, solved = self._certified(face, x)
                if solved:
                    return x
                w = self.problem.w(x)
            following = np.where(active, x > 0.0, w < 0.0)
            changes.append(int(np.count_nonzero(following != active)))
            if patience is not None and _circling(changes, patience):
                return None
            active = following
        return None

    def proximal_active_set(self, active: Mask | None = None) -> Array | None:
        """The solution by the proximal method: for a positive semidefinite A, singular or nearly.

        Each round solves the LCP of A + shift I, whose point x is unique, near the point of the round before, and then
        tries the active set that comes out on A itself.

        Parameters
        ----------
        active : Mask, optional
            The guess. Default: the last that was tried.
        """
        active = self._last if active is None else active
        if active is None:
            return None
        x = np.zeros(self.problem.n)
        unit = float(np.mean(self.problem.A.diagonal()))
        for shift in SHIFTS:
            moved = self._moved(active, shift * unit, x)
            if moved is None:
                return None
            active, x = moved
            solved = self.settle(active, 1, x)
            if solved is not None:
                return solved
        return None

    def _moved(self, active: Mask, shift: float, centre: Array) -> tuple[Mask, Array] | None:
        """The solution of the LCP of A + shift I and q - shift centre, with its active set, or as near as it gets."""
        q = self.problem.q - shift * centre
        x = centre
        changes: list[int] = []
        for _ in range(ROUND_STEPS):
            self.counts.factorizations += 1
            face = self.faces.face(active, shift)
            if face is None:
                return None
            x = np.zeros_like(q)
            x[active] = face.inverse(-q[active])
            if not np.isfinite(x).all():
                return None
            with np.errstate(over="ignore", invalid="ignore"):
                following = np.where(active, x > 0.0, self.problem.A @ x + q < 0.0)
            changes.append(int(np.count_nonzero(following != active)))
            if changes[-1] == 0:
                break
            if _circling(changes, ROUND_PATIENCE):
                return None
            active = following
        return active, np.maximum(x, 0.0)

    def _plausible(self, x: Array, w: Array) -> bool:
        """Whether the signs are right to about the tolerance, so that a certificate is worth its cost."""
        size = float(np.abs(x).max())
        return bool(
            x.min() >= -self.tolerance * size and w.min() >= -self.tolerance * (self.problem.scale(x) - 1.0)
        )

    def _certified(self, face: Face, x: Array) -> tuple[Array, bool]:
        """The point, clipped to x >= 0 and certified, corrected in twice the precision until that is round-off."""
        best: Certificate | None = None
        for left in reversed(range(CORRECTIONS + 1)):
            certificate = certify(self.problem, np.maximum(x, 0.0))
            if best is None or certificate.relative_residual < best.relative_residual:
                best = certificate
            if best.relative_residual <= ROUND_OFF or not left:
                break
            better = face.refined(x)
            if not np.isfinite(better).all():
                break
            x = better
        if best is not None and confirmed(self.problem, best, self.tolerance):
            self.certificate = best
            return best.x, True
        return x, False


def _circling(changes: list[int], patience: int) -> bool:
    """Whether the last `patience` numbers are no lower than the lowest before them."""
    return len(changes) > patience and min(changes[-patience:]) >= min(changes[:-patience])


def smallest_parameter(homotopy: Any, product: float) -> float:
    """The parameter at which the products x z1 (or x y) have fallen to `product` natural units, in the median."""
    n = homotopy.problem.n
    y0, lam0 = homotopy.start()
    x, w = natural_units(homotopy.problem)
    return float(lam0 * product * x * w / np.median(y0[:n] * y0[n : 2 * n]))


@define(eq=False, slots=False)
class Finishing:
    """A homotopy of this package with the finish as its own way to end; everything else is the homotopy's own.

    Attributes
    ----------
    homotopy : KKTHomotopy or TwoVectorHomotopy
        Its first n unknowns are x.
    attempt : Finish or None
        None in a homotopy read from an archive, which is traced without a finish.
    rough : bool
        Whether solves stay unrefined, which takes a third off the time of a path: enough for a loose tolerance.
    next_lam : float
        The finish is tried when the parameter has fallen to this.
    """

    homotopy: Any
    attempt: Finish | None = None
    rough: bool = False
    next_lam: float = field(default=LATEST_START, init=False)

    def __attrs_post_init__(self) -> None:
        self.next_lam = min(LATEST_START, smallest_parameter(self.homotopy, LARGEST_PRODUCT))
        # As attributes of the object itself: a call costs nothing more, and a capability is found by its presence.
        for name in CAPABILITIES:
            setattr(self, name, getattr(self.homotopy, name))
        if self.rough:
            self.bordered = self._roughly_bordered

    def _roughly_bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """The quick core of the homotopy's own system, where there is one."""
        system = self.homotopy.bordered(y, lam, border)
        core: BorderedSystem | None = system.quick
        return system if core is None else core

    def archive_data(self) -> dict[str, Any]:
        """The homotopy alone: what was tried is no part of the problem."""
        return {"homotopy": self.homotopy}

    @classmethod
    def from_archive(cls, data: Mapping[str, Any]) -> Finishing:
        """The homotopy again, without a finish."""
        return cls(data["homotopy"])

    def finish(self, y: Array, lam: float) -> Array | None:
        """The certified end, its x in place of the first n unknowns; None to go on."""
        if self.attempt is None or lam > self.next_lam:
            return None
        self.next_lam = SPACING * lam
        problem = self.attempt.problem
        x = y[: problem.n]
        solved = self.attempt.settle(x > problem.w(x), STEPS, x)
        return None if solved is None else np.concatenate([solved, y[problem.n :]])
