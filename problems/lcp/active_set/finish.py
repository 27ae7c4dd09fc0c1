"""The exact end: guess which x_i are positive, solve on that face, verify."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from attrs import define, field

from continuation.arrays import Array, Matrix, least
from continuation.counts import Counts
from problems.lcp.active_set.augmented import Saddle, guesses
from problems.lcp.active_set.face import Face, Faces
from problems.lcp.active_set.iteration import AT_END, Ended, Policy, iterate
from problems.lcp.data.problem import LOWER, UPPER, MixedLCP, State
from problems.lcp.proof.certificate import ROUND_OFF, Certificate, certified, certify
from problems.lcp.proof.verdict import confirmed

PATIENCE = 5
"""Corrections in a row without a new low of changed indices, as when sets cycle, and changes of multipliers that do not
halve the residual. On 80 planted problems 2, 5, infinity take 5,210, 5,338, 5,989 factorisations, but on 24 monotone
ones 303, 278, 273."""


@define(eq=False)
class Finish:
    """Tries active sets of one problem, each once, for all its paths.

    `nearest`: the judged point of least residual that is no solution. `ended`, `following`: why the last iteration
    ended, and its next state. `solved_on`: the face of the solution.
    """

    faces: Faces
    tolerance: float
    counts: Counts = field(factory=Counts)
    tried: set[bytes] = field(factory=set)
    certificate: Certificate | None = field(default=None, init=False)
    nearest: Certificate | None = field(default=None, init=False)
    ended: Ended | None = field(default=None, init=False)
    following: State | None = field(default=None, init=False)
    solved_on: Face | None = field(default=None, init=False)

    @property
    def problem(self) -> MixedLCP:
        """The problem."""
        return self.faces.problem

    def settle(self, state: State, policy: Policy, near: Array | None = None) -> Array | None:
        """Certified solution on an active set or its corrections, or None."""
        found = iterate(self.faces, state, policy, near=near, judge=self.judged, tried=self.tried, counts=self.counts)
        self.ended, self.following = found.ended, found.state
        return found.x if found.ended is Ended.SOLVED else None

    def proximal(self, state: State, shift: float, rounds: int) -> Array | None:
        """The solution by the proximal method, or None; A + shift I is positive definite.

        Each round solves the LCP of A + shift I near the last point and tries its active set on A. If no active set
        settles, the shift doubles.

        References
        ----------
        Rockafellar, SIAM J. Control Optim. 14 (1976); Kaplan and Tichatschke, J. Global Optim. 13 (1998); Cottle, Pang
        and Stone, section 5.6.
        """
        x = self.problem.near_zero
        for _ in range(rounds):
            moved = iterate(self.faces, state, Policy(24, PATIENCE), near=x, shift=shift, counts=self.counts)
            if moved.ended is not Ended.SETTLED:
                shift *= 2.0
                continue
            state, x = moved.state, self.problem.clipped(moved.x)
            solved = self.settle(state, Policy(steps=1), x)
            if solved is not None:
                return solved
        return None

    def augmented(self, exhausted: Callable[[], object]) -> Array | None:
        """Solution of a convex program by `guesses`, or None."""
        saddle = Saddle.of(self.problem)
        if saddle is None:
            return None
        since, best = 0, np.inf
        for state, point in guesses(saddle, self.counts, self.faces.factoring):
            solved = self.settle(state, AT_END, point)
            if solved is not None:
                return solved
            now = self.problem.relative_residual(point)
            since, best = (0, now) if now < 0.5 * best else (since + 1, best)
            if since > PATIENCE or exhausted():
                break
        return None

    def take(self, x: Array) -> Array | None:
        """The point x if it solves the problem, else None."""
        found = certified(self.problem, self.problem.clipped(x)) if np.isfinite(x).all() else None
        return found.x if found is not None and self._kept(found) else None

    def _kept(self, found: Certificate) -> bool:
        if confirmed(self.problem, found, self.tolerance):
            self.certificate = found
            return True
        residual = self.problem.relative_residual
        if self.nearest is None or residual(found.x) < residual(self.nearest.x):
            self.nearest = found
        return False

    def judged(self, face: Face, x: Array, w: Array) -> tuple[Array, Array, bool]:
        """A solution (x, w, True) by clipping or correcting a face's point; else the last (x, w, False), unclipped."""
        if not self._plausible(face.state, x, w):
            return x, w, False
        best = certified(self.problem, self.problem.clipped(x))
        if best.relative_residual > ROUND_OFF:
            # The correction gains digits (Higham, section 12.1).
            better = face.refined(x, best.w if np.array_equal(best.x, x) else None)
            if np.isfinite(better).all():
                x, now = better, certified(self.problem, self.problem.clipped(better))
                best = min(best, now, key=lambda one: one.relative_residual)
        if not best.solves(self.tolerance):
            best = with_zeros(self.problem, best, self.tolerance)
        if self._kept(best):
            self.solved_on = face
            return best.x, best.w, True
        return x, self.problem.w(x), False

    def _plausible(self, state: State, x: Array, w: Array) -> bool:
        problem = self.problem
        inside = x if problem.standard else np.minimum(x - problem.lower, problem.upper - x)
        signed = w if problem.standard else np.where(state == UPPER, -w, np.where(state == LOWER, w, 0.0))
        if not problem.standard:
            signed = np.where(problem.fixed, 0.0, signed)
        low_x, low_w = least(inside), least(signed)
        if low_x >= 0.0 and low_w >= 0.0:
            return True
        size = float(np.abs(x).max())
        return low_x >= -self.tolerance * size and low_w >= -self.tolerance * problem.size_of_terms(x)


def with_zeros(problem: MixedLCP, end: Certificate, tolerance: float) -> Certificate:
    """The better certificate: of a point, or of the one with its entries near bounds moved there."""
    return min(end, certify(problem, end.x, tolerance), key=lambda one: one.relative_residual)


def below_zero(A: Matrix) -> float:
    """A bound on how far eigenvalues of a symmetric A lie below zero."""
    if sp.issparse(A):
        return float((abs(A).sum(axis=1) - A.diagonal()).max())
    return float(max(-np.linalg.eigvalsh(A)[0], np.finfo(float).tiny))
