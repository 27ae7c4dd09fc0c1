"""A point of the path with its factored derivative."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np
from attrs import Factory, evolve, field, frozen
from scipy.linalg.blas import dscal

from continuation.arrays import EPS, SIX_DIGITS, Array, dot, generic_vector, largest
from continuation.contraction import MONOTONE, RELIABLE, Contraction, Iteration, updated
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import CountedSystem, Evaluator
from continuation.metric import norm

REFINED = 1e-14
"""Relative last increment of a fully refined tangent: 50 ulps."""

ROUND_OFF_LEFT = 1e3
"""Factor of a last increment that is accepted where round-off ends the contraction: condition numbers of a thousand are
ordinary."""

SOLVED, NEARLY_SOLVED = 1e-13, 1e-9
"""Relative last increment of a refined solve, and an accepted one at round-off: a series of order 30 keeps nine digits
at half its range."""

NEAR_SINGULAR = SIX_DIGITS / EPS
"""Growth of a solution that shows a singular matrix: six digits are left."""

TANGENT_REFINEMENT = Contraction(ratio=RELIABLE, first=MONOTONE)
"""The first increment is a generic vector's error, the second what the factorisation leaves: their ratio need only be
below one."""

SOLVE_REFINEMENT = Contraction(ratio=RELIABLE)


@frozen(eq=False)
class Anchor:
    """A factorisation, with the point and border to repeat it."""

    u: Array
    border: Array
    system: CountedSystem


@frozen(eq=False)
class Linearization:
    """A point u = (y, lam), its tangent, and a factorisation of [H_y, H_lam] made there (`exact`) or nearby.

    `weights`: metric. `tangent`: unit, H' tangent = 0, oriented. `orientation`: sign of det [[H'], [(W tangent)']], 0
    if unknown. Series need `exact`.
    """

    u: Array
    weights: Array
    anchor: Anchor
    tangent: Array
    orientation: int
    border: Array = field(default=Factory(lambda point: point.weights * point.tangent, takes_self=True), init=False)
    """W tangent."""

    @property
    def exact(self) -> bool:
        """Whether the factorisation was made at the point."""
        return np.array_equal(self.anchor.u, self.u)

    @property
    def y(self) -> Array:
        """Unknowns, shape (N,)."""
        return self.u[:-1]

    @property
    def lam(self) -> float:
        """The parameter."""
        return float(self.u[-1])

    def solve(self, r: Array, rho: float = 0.0, border: Array | None = None) -> Array:
        """Solve ``H' z = r, border . z = rho`` for any border.

        By default z with rho = 0 is the shortest (Moore-Penrose).
        """
        return self._completed(self.anchor.system.solve(r, 0.0), rho, border)

    def approximate(self, r: Array, rho: float = 0.0, border: Array | None = None) -> Array:
        """`solve` for iterations that measure their residual (`CountedSystem`)."""
        return self._completed(self.anchor.system.approximate(r, 0.0), rho, border)

    def blur(self, noise: Array) -> float:
        """Length of a correction by noise of the equations, shape (N,), from two samples of signs."""
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
        """The point in another metric."""
        tangent = self.tangent / norm(weights, self.tangent)
        return Linearization(self.u, weights, self.anchor, tangent, self.orientation)


def linearize(evaluator: Evaluator, u: Array, weights: Array, reference: Array) -> Linearization:
    """Factor at u, with reference . tangent > 0.

    With M = [[H'], [reference']] and M v = e_{N+1}, det [[H'], [v']] = det(M) |v|^2: one factorisation gives the
    orientation (Allgower and Georg, Section 2.1).
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
    accuracy: float = REFINED,
    guess: Array | None = None,
) -> Linearization:
    """Linearize at u with a nearby factorisation; the tangent v is refined to `accuracy`, with along . v > 0.

    `guess`: about a multiple of the tangent, or `generic`.

    Refinement with factors of M~ multiplies errors by I - M~^{-1} M; without reliable contraction u is factored. The
    error of a generic guess shrinks only if det M~ and det M have one sign.
    """
    apply = evaluator.differential(u)
    tangent = None
    if apply is not None:
        length = 0.0 if guess is None else dot(anchor.border, guess)
        begin = anchor.system.solve(np.zeros(u.size - 1), 1.0) if guess is None or length == 0.0 else guess / length
        tangent = _refined(apply, anchor, begin, weights, accuracy)
    if tangent is None:
        return linearize(evaluator, u, weights, along)
    # The anchor's border may differ from `along`.
    flip = dot(along, tangent) < 0.0
    sign = anchor.system.sign
    return _oriented(anchor, u, weights, -tangent if flip else tangent, -sign if flip else sign)


def generic(weights: Array) -> Array:
    """A guess with a part along every eigenvector."""
    return generic_vector(weights.size) / np.sqrt(weights)


def _refined(
    apply: Callable[[Array], Array], anchor: Anchor, guess: Array, weights: Array, accuracy: float
) -> Array | None:
    """The solution of M v = e_{N+1}, or None; the metric makes this independent of units."""
    refinement = Iteration(guess, TANGENT_REFINEMENT)
    solve, border, increments = anchor.system.approximate, anchor.border, list[tuple[Array, Array]]()
    v, longest = guess, norm(weights, guess)
    while True:
        plain = solve(-apply(v), 1.0 - dot(border, v))
        size = sqrt(dot(weights * plain, plain))
        if not refinement.add(updated(increments, plain, weights), size):
            if refinement.size <= ROUND_OFF_LEFT * accuracy * norm(weights, v):
                break
            return None
        v = refinement.x
        longest += size
        size = refinement.error
        if size <= accuracy * longest and size <= accuracy * norm(weights, v):
            break
        if refinement.count == TANGENT_REFINEMENT.iterations:
            return None
    if anchor.system.approximates:
        # Small increments of an inexact solver may hide a defect.
        left = anchor.system.solve(-apply(v), 1.0 - dot(border, v))
        if norm(weights, left) > SIX_DIGITS * norm(weights, v):
            return None
    return v


@frozen(eq=False)
class RefinedSystem:
    """A nearby factorisation, refined for the point's own matrix."""

    near: CountedSystem
    apply: Callable[[Array], Array]
    border: Array

    @property
    def sign(self) -> int:
        """The factorisation's sign: refinement converges only if signs agree."""
        return self.near.sign

    def solve(self, r: Array, rho: float) -> Array:
        """Solve to round-off; EvaluationError without contraction."""
        refinement = Iteration(self.near.solve(r, rho), SOLVE_REFINEMENT)

        def increment() -> Array:
            z = refinement.x
            return self.near.solve(r - self.apply(z), rho - dot(self.border, z))

        done = refinement.run(increment, largest, lambda size: size <= SOLVED * largest(refinement.x))
        if done or refinement.size <= NEARLY_SOLVED * largest(refinement.x):
            return refinement.x
        raise EvaluationError("a factorisation from nearby could not be refined")


def with_exact_solves(evaluator: Evaluator, point: Linearization) -> Linearization:
    """The point with exact solves, for series, where an error in a coefficient enters later ones."""
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
            # The nearby factorisation counts them.
            return evolve(point, anchor=Anchor(point.u, near.border, CountedSystem(trial, Counts())))
    return factored(evaluator, point)


def factored(evaluator: Evaluator, point: Linearization) -> Linearization:
    """The point, newly factored."""
    return evolve(point, anchor=linearize(evaluator, point.u, point.weights, point.border).anchor)


def _oriented(anchor: Anchor, u: Array, weights: Array, raw: Array, orientation: int) -> Linearization:
    length = norm(weights, raw)
    if not length > 0.0:
        raise EvaluationError("the tangent vanishes")
    return Linearization(u, weights, anchor, raw / length, orientation)
