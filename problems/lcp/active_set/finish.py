"""The exact end: guess which x_i are positive, solve on that face, verify or correct."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from attrs import define, field

from continuation.arrays import Array, Matrix, least
from continuation.counts import Counts
from problems.lcp.active_set.augmented import Saddle, guesses
from problems.lcp.active_set.face import Face, Faces
from problems.lcp.active_set.iteration import AT_END, Ended, Policy, Tried, iterate
from problems.lcp.data.problem import LOWER, UPPER, MixedLCP, State
from problems.lcp.proof.certificate import ROUND_OFF, Certificate, certified, certify
from problems.lcp.proof.verdict import confirmed

PATIENCE = 5
"""Corrections in a row without a new low of changed indices that count as cycling. With 2, 3, 5, 10, infinity: 5,210,
5,259, 5,338, 5,529, 5,989 factorisations on 80 planted problems of five kinds (n = 20, 40); 303, 291, 278, 273, 273 on
24 monotone ones (n = 100, 200)."""

MORE_MULTIPLIERS = 5
"""Changes of the multipliers that may fail to halve the residual."""


@define(eq=False)
class Finish:
    """Tries active sets of one problem, each once, for all its paths.

    Attributes
    ----------
    faces : Faces
    tolerance : float
        For `Certificate.solves`.
    counts : Counts
        Adds up factorisations.
    tried : Tried
    certificate : Certificate or None
        Of the last solution.
    nearest : Certificate or None
        Of the judged point with least normwise residual that solves nothing.
    ended : Ended or None
        Why the last iteration ended.
    following : State or None
        Its next state.
    """

    faces: Faces
    tolerance: float
    counts: Counts = field(factory=Counts)
    tried: Tried = field(factory=Tried)
    certificate: Certificate | None = field(default=None, init=False)
    nearest: Certificate | None = field(default=None, init=False)
    ended: Ended | None = field(default=None, init=False)
    following: State | None = field(default=None, init=False)

    @property
    def problem(self) -> MixedLCP:
        """The problem."""
        return self.faces.problem

    def settle(self, state: State, policy: Policy, near: Array | None = None) -> Array | None:
        """The certified solution on an active set or its corrections, or None.

        Parameters
        ----------
        state : State
            The guess.
        policy : Policy
        near : Array, optional
            Selects the nearest of a face's many points; default zero.
        """
        found = iterate(self.faces, state, policy, near=near, judge=self.judged, tried=self.tried, counts=self.counts)
        self.ended, self.following = found.ended, found.state
        return found.x if found.ended is Ended.SOLVED else None

    def proximal(self, state: State, shift: float, rounds: int) -> Array | None:
        """The solution by the proximal method, with A + shift I positive definite, or None.

        Each round solves the LCP of A + shift I, whose point is unique, near the last point, and tries its active set
        on A. For symmetric A the quadratic function falls. If the active sets do not settle (A nearly singular or
        indefinite), the shift doubles.

        Parameters
        ----------
        state : State
            The guess.
        shift : float
        rounds : int

        References
        ----------
        Rockafellar, "Monotone Operators and the Proximal Point Algorithm", SIAM J. Control Optim. 14 (1976); Kaplan and
        Tichatschke, "Proximal Point Methods and Nonconvex Optimization", J. Global Optim. 13 (1998); Cottle, Pang and
        Stone, section 5.6 (regularization).
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

    def augmented(self, below: float) -> Array | None:
        """A KKT point of a program by its augmented Lagrangian, or None; `nearest` is the best.

        Parameters
        ----------
        below : float
            As for `guesses`.
        """
        saddle = Saddle.of(self.problem)
        if saddle is None:
            return None
        since, best = 0, np.inf
        x, factoring = self.problem.near_zero[: self.problem.primal], self.faces.factoring
        for state, point in guesses(saddle, below, x, self.counts, factoring):
            solved = self.settle(state, AT_END, point)
            if solved is not None:
                return solved
            now = self.problem.relative_residual(point)
            since, best = (0, now) if now < 0.5 * best else (since + 1, best)
            if since > MORE_MULTIPLIERS:
                break
        return None

    def take(self, x: Array) -> Array | None:
        """The point x if it is a solution, else None; it may become `nearest`.

        Parameters
        ----------
        x : Array of shape (n,)
        """
        found = certified(self.problem, self.problem.clipped(x)) if np.isfinite(x).all() else None
        return found.x if found is not None and self._kept(found) else None

    def _kept(self, found: Certificate) -> bool:
        """Whether a solution is certified; else keep the nearest point."""
        if confirmed(self.problem, found, self.tolerance):
            self.certificate = found
            return True
        residual = self.problem.relative_residual
        if self.nearest is None or residual(found.x) < residual(self.nearest.x):
            self.nearest = found
        return False

    def judged(self, face: Face, x: Array, w: Array) -> tuple[Array, Array, bool]:
        """The point, clipped, certified, perhaps corrected once in twice the precision; whether it is a solution.

        Parameters
        ----------
        face : Face
        x, w : Array of shape (n,)
            Its point.
        """
        # Only plausible signs are worth a certificate.
        if not self._plausible(face.state, x, w):
            return x, w, False
        best = certified(self.problem, self.problem.clipped(x))
        if best.relative_residual > ROUND_OFF:
            # A correction gains the digits that the condition leaves (Higham, section 12.1).
            better = face.refined(x, best.w if np.array_equal(best.x, x) else None)
            if np.isfinite(better).all():
                x, now = better, certified(self.problem, self.problem.clipped(better))
                best = min(best, now, key=lambda one: one.relative_residual)
        if not best.solves(self.tolerance):
            # True zeros, as without contact, may dominate a row's terms by rounding.
            if not self.problem.standard:
                best = with_zeros(self.problem, best, self.tolerance)
            elif (best.x > (zeros := np.where(x > ROUND_OFF * float(x.max(initial=0.0)), x, 0.0))).any():
                best = certified(self.problem, zeros)
        if self._kept(best):
            return best.x, best.w, True
        return x, self.problem.w(x), False

    def _plausible(self, state: State, x: Array, w: Array) -> bool:
        """Whether signs are right to about the tolerance, x relative to its size, w to its terms."""
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
    """The best certificate of a point and of x moved to the bounds that its signs ask for.

    Near a bound only the sign of w_i tells; in a row of zeros such an x_i is large.
    """
    settled = problem.settled(end.x, end.w)
    exact = (certify(problem, settled, zero) for zero in (0.0, tolerance))
    return min(end, *exact, key=lambda one: one.relative_residual)


def below_zero(A: Matrix) -> float:
    """A bound on how far an eigenvalue of a symmetric matrix lies below zero: exact, or by rows if sparse."""
    if sp.issparse(A):
        return float((abs(A).sum(axis=1) - A.diagonal()).max())
    return float(max(-np.linalg.eigvalsh(A)[0], np.finfo(float).tiny))
