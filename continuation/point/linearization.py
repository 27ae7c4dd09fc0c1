"""A point of the path with its factored derivative: tangent, orientation, and every later solve come from here."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np
from attrs import evolve, field, frozen
from scipy.linalg.blas import dscal

from continuation.arrays import Array, dot, generic_vector, largest
from continuation.contraction import MONOTONE, RELIABLE, Contraction, Iteration
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import CountedSystem, Evaluator
from continuation.metric import norm

REFINED = 1e-14
"""The last increment of a tangent that is refined as far as it goes, relative to its size: 50 units of round-off."""

ROUND_OFF_LEFT = 1e3
"""Where round-off ends the contraction earlier, a last increment within this factor of the one wanted will do."""

TANGENT_LEAVES = 1e-6
"""What an exact solve may find left of a tangent that was refined by another: six digits, as a step's tangent has."""

SOLVED, NEARLY_SOLVED = 1e-13, 1e-9
"""The last increment of a refined solve, relative to its solution, and the one that will do where round-off ends the
contraction: a series of order 30 at half its range still has nine digits with it."""

NEAR_SINGULAR = 1e10
"""How much longer than usual a solution may be before the matrix counts as singular: six digits are left then."""

TANGENT_REFINEMENT = Contraction(iterations=20, ratio=RELIABLE, first=MONOTONE)
"""The first increment is of an error in general position, the second of what the factorisation leaves of it: that
ratio need only be below one."""

SOLVE_REFINEMENT = Contraction(iterations=8, ratio=RELIABLE)


@frozen(eq=False)
class Anchor:
    """A factorisation and where it was made: the point and the border, from which it can be made again."""

    u: Array
    border: Array
    system: CountedSystem


@frozen(eq=False)
class Linearization:
    """A point, its tangent, and a factorisation of [H_y, H_lam] made there or nearby.

    `u`, of shape (N + 1,): The point (y, lam). `weights`, of shape (N + 1,): The metric there. `anchor`: The
    factorisation. Where `exact` is false it was made at a point nearby: right for corrections, not for series.
    `tangent`, of shape (N + 1,): Of unit length in the metric, H' tangent = 0, oriented. `orientation`: Sign of det
    [[H'], [(W tangent)']]; 0 if the structure cannot tell.
    """

    u: Array
    weights: Array
    anchor: Anchor
    tangent: Array
    orientation: int
    border: Array = field(init=False)
    """The tangent in the dual metric, W tangent: border . tangent = 1."""

    @border.default
    def _border(self) -> Array:
        border: Array = self.weights * self.tangent
        return border

    @property
    def exact(self) -> bool:
        """Whether the factorisation was made at the point itself."""
        return np.array_equal(self.anchor.u, self.u)

    @property
    def y(self) -> Array:
        """The unknowns, shape (N,)."""
        return self.u[:-1]

    @property
    def lam(self) -> float:
        """The parameter."""
        return float(self.u[-1])

    def solve(self, r: Array, rho: float = 0.0, border: Array | None = None) -> Array:
        """Solve ``H' z = r, border . z = rho`` with the factorisation at hand, whatever the border.

        All solutions of H' z = r differ by multiples of the tangent, so another border costs one inner product and
        no factorisation. The default border is W tangent: then z is the shortest solution when rho = 0, that is, the
        Moore-Penrose inverse applied to r.
        """
        return self._completed(self.anchor.system.solve(r, 0.0), rho, border)

    def approximate(self, r: Array, rho: float = 0.0, border: Array | None = None) -> Array:
        """The same for estimates, and for iterations that measure their own residual: see `CountedSystem`."""
        return self._completed(self.anchor.system.approximate(r, 0.0), rho, border)

    def blur(self, noise: Array) -> float:
        """The length of what noise of the equations, shape (N,), makes of a correction, in two samples of its signs."""
        samples = (self.approximate(signs * noise) for signs in (1.0, np.sign(generic_vector(noise.size))))
        return max(norm(self.weights, sample) for sample in samples)

    def _completed(self, z: Array, rho: float, border: Array | None) -> Array:
        row = self.border if border is None else border
        along = dot(row, self.tangent)
        if along == 0.0:
            raise EvaluationError("the border is orthogonal to the tangent")
        corrected: Array = dscal((rho - dot(row, z)) / along, self.tangent.copy())
        corrected += z
        return corrected

    def with_weights(self, weights: Array) -> Linearization:
        """The same point measured in another metric: the tangent keeps its direction, the factorisation stays."""
        tangent = self.tangent / norm(weights, self.tangent)
        return Linearization(self.u, weights, self.anchor, tangent, self.orientation)


def linearize(evaluator: Evaluator, u: Array, weights: Array, reference: Array) -> Linearization:
    """Factor at u with the border `reference`; the tangent makes an acute angle with it.

    With M = [[H'], [reference']] and M v = e_{N+1}: det [[H'], [v']] = det(M) |v|^2, so the sign of the one
    factorisation is the tangent's orientation (Allgower and Georg, Section 2.1).
    """
    system = evaluator.factor(u, reference)
    raw = system.solve(np.zeros(u.size - 1), 1.0)
    return _oriented(Anchor(u, reference, system), u, weights, raw, system.sign)


def relinearize(
    evaluator: Evaluator,
    u: Array,
    weights: Array,
    anchor: Anchor,
    along: Array,
    signed: bool = False,
    accuracy: float = REFINED,
    guess: Array | None = None,
) -> Linearization:
    """Linearize at u with a factorisation from nearby: the tangent is refined to `accuracy`, and makes along . v > 0.

    It begins with that of the factorisation, or with a multiple of `guess`, where somebody knows it better.

    Iterative refinement of M v = e_{N+1} with the factors of M~ multiplies the error by I - M~^{-1} M. It is believed
    only if it contracts reliably, else u gets factors of its own. Where the determinant's sign counts
    (`signed`), the refinement begins with an error in general position, of the metric's size in each component: if
    M~^{-1} M had a negative eigenvalue, that part of the error would not shrink, so det M~ and det M have one sign.
    """
    apply = evaluator.differential(u)
    tangent = None
    if apply is not None:
        length = 0.0 if guess is None else dot(anchor.border, guess)
        if signed:
            begin = generic_vector(u.size) / np.sqrt(weights)
        elif guess is not None and length != 0.0:
            begin = guess / length
        else:
            begin = anchor.system.solve(np.zeros(u.size - 1), 1.0)
        tangent = _refined(apply, anchor, begin, weights, accuracy)
    if tangent is None:
        return linearize(evaluator, u, weights, along)
    # The refined tangent makes an acute angle with the anchor's own border, which need not be the one asked for.
    flip = dot(along, tangent) < 0.0
    sign = anchor.system.sign
    return _oriented(anchor, u, weights, -tangent if flip else tangent, -sign if flip else sign)


def _refined(
    apply: Callable[[Array], Array], anchor: Anchor, guess: Array, weights: Array, accuracy: float
) -> Array | None:
    """The solution v of M v = e_{N+1} at the point of `apply`, to `accuracy`; None where refinement fails.

    Measured in the metric: the largest component is that of the smallest unit, and knows nothing of the others.
    """
    refinement = Iteration(guess, TANGENT_REFINEMENT)
    solve, border = anchor.system.approximate, anchor.border
    v, longest = guess, norm(weights, guess)
    while True:
        step = solve(-apply(v), 1.0 - dot(border, v))
        size = sqrt(dot(weights * step, step))
        if not refinement.add(step, size):
            if refinement.size <= ROUND_OFF_LEFT * accuracy * norm(weights, v):
                break
            return None
        v = refinement.x
        # The sum of lengths is a bound: the vector itself is measured only where that is met.
        longest += size
        if size <= accuracy * longest and size <= accuracy * norm(weights, v):
            break
        if refinement.count == TANGENT_REFINEMENT.iterations:
            return None
    if anchor.system.approximates:
        # Increments of a solver that is not exact may be small because it does not see what is left.
        left = anchor.system.solve(-apply(v), 1.0 - dot(border, v))
        if norm(weights, left) > TANGENT_LEAVES * norm(weights, v):
            return None
    return v


@frozen(eq=False)
class RefinedSystem:
    """A factorisation from nearby, made to solve with the matrix of the point itself by iterative refinement."""

    near: CountedSystem
    apply: Callable[[Array], Array]
    border: Array

    @property
    def sign(self) -> int:
        """As that of the factorisation: refinement converges only if the signs agree."""
        return self.near.sign

    def solve(self, r: Array, rho: float) -> Array:
        """The bordered solve, to round-off; EvaluationError where refinement does not contract."""
        refinement = Iteration(self.near.solve(r, rho), SOLVE_REFINEMENT)

        def increment() -> Array:
            z = refinement.x
            return self.near.solve(r - self.apply(z), rho - dot(self.border, z))

        done = refinement.run(increment, largest, lambda size: size <= SOLVED * largest(refinement.x))
        if done or refinement.size <= NEARLY_SOLVED * largest(refinement.x):
            return refinement.x
        raise EvaluationError("a factorisation from nearby could not be refined")


def with_exact_solves(evaluator: Evaluator, point: Linearization) -> Linearization:
    """The same point with a system that solves for its own matrix: refined where a factorisation from nearby allows it.

    What a series needs, since the error of each coefficient enters all the later ones.
    """
    if point.exact:
        return point
    apply = evaluator.differential(point.u)
    if apply is not None:
        near = point.anchor
        trial = RefinedSystem(near.system, apply, near.border)
        try:
            trial.solve(np.zeros(point.u.size - 1), 1.0)
        except EvaluationError:
            pass
        else:
            # Its solves are counted by the factorisation nearby.
            return evolve(point, anchor=Anchor(point.u, near.border, CountedSystem(trial, Counts())))
    return factored(evaluator, point)


def factored(evaluator: Evaluator, point: Linearization) -> Linearization:
    """The same point, tangent and orientation with a factorisation of its own."""
    return evolve(point, anchor=linearize(evaluator, point.u, point.weights, point.border).anchor)


def _oriented(anchor: Anchor, u: Array, weights: Array, raw: Array, orientation: int) -> Linearization:
    length = norm(weights, raw)
    if not length > 0.0:
        raise EvaluationError("the tangent vanishes")
    return Linearization(u, weights, anchor, raw / length, orientation)
