"""Simple branch points and their directions, by Newton's method on a minimally augmented system.

Columns are multiplied by extents, rows divided by their sizes.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, Matrix, generic_vector
from continuation.contraction import HALVING, Contraction, Iteration
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.products import USUAL_STEP
from continuation.linear import Banded
from continuation.linear.entries import extended
from continuation.linear.nullspace import RANK, Bordered, kernels
from continuation.linear.refine import BACKWARD_ERROR
from continuation.metric import inner, norm

POLISHING = Contraction(ratio=np.inf)
"""First increments may grow; the result is checked."""

SECOND = USUAL_STEP
"""Step, in extents, of central differences of H': ten digits."""


@frozen(eq=False)
class SimpleBranchPoint:
    """A zero of H where H' has rank N - 1; `directions`: of two branches, with unit length in the metric."""

    u: Array
    directions: tuple[Array, Array]

    def rays(self, heading: Array, weights: Array) -> Array:
        """Rays back and onward along `heading`, and those of the other branch, shape (4, N + 1)."""
        along = [inner(weights, heading, d) for d in self.directions]
        k = int(np.argmax(np.abs(along)))
        onward, other = self.directions[k] * np.sign(along[k]), self.directions[1 - k]
        return np.array([-onward, onward, other, -other])


@frozen(eq=False)
class ScaledDerivative:
    """H' in units of a path: columns times `extent`, rows divided by `rows`."""

    evaluator: Evaluator
    extent: Array
    rows: Array

    def at(self, u: Array) -> Matrix:
        """H', shape (N, N + 1), dense or sparse."""
        full = full_derivative(self.evaluator, u)
        if sp.issparse(full):
            full.data *= np.repeat(self.extent, np.diff(full.indptr)) / self.rows[full.indices]
            return full
        return full * self.extent / self.rows[:, None]

    def second(self, u: Array, phi: Array, w: Array) -> Array:
        """The row phi' H''[w, .], by a central difference."""
        eps = SECOND / float(np.linalg.norm(w))
        move = eps * w * self.extent
        row: Array = (self.at(u + move).T @ phi - self.at(u - move).T @ phi) / (2.0 * eps)
        return row


def full_derivative(evaluator: Evaluator, u: Array) -> Matrix:
    """H' = [H_y, H_lam], shape (N, N + 1), dense or sparse."""
    H_y, H_lam = evaluator.derivative(u[:-1], float(u[-1]))
    evaluator.counts.jacobians += 1
    column = np.asarray(H_lam, dtype=float)
    if isinstance(H_y, Banded):
        H_y = H_y.tosparse()
    if not (sp.issparse(H_y) or isinstance(H_y, np.ndarray)):
        raise EvaluationError("a matrix is needed here, and the Jacobian is an operator")
    return extended(H_y, column[:, None], np.empty((0, column.size + 1)))


def scales(evaluator: Evaluator, extent: Array, points: tuple[Array, ...]) -> tuple[Array, Array]:
    """Extents, larger where an unknown's column of H' is small, and sizes of rows: largest entries at some points.

    An unknown that stands still has no extent of its own; in too small a unit its column looks like a lost rank. The
    parameter keeps its extent: its column vanishes where all unknowns stand still.
    """
    entries = abs(full_derivative(evaluator, points[0]))
    for u in points[1:]:
        other = abs(full_derivative(evaluator, u))
        entries = entries.maximum(other) if sp.issparse(other) else np.maximum(entries, other)
    rows = _largest(entries, extent, 1)
    rows = np.where(rows > 0.0, rows, 1.0)
    columns = extent * _largest(entries.T, 1.0 / rows, 1)
    columns[-1] = 1.0
    return extent / np.where(columns > 0.0, np.minimum(columns, 1.0), 1.0), rows


def _largest(entries: Matrix, factors: Array, axis: int) -> Array:
    found = (entries * factors[None]).max(axis=axis)
    return np.asarray(found.toarray().ravel() if sp.issparse(found) else found)


def branch_point_near(
    evaluator: Evaluator, guess: Array, heading: Array, weights: Array, units: tuple[Array, Array]
) -> SimpleBranchPoint | None:
    """Solve H(u) + beta b = 0, gamma(u) = 0 by Newton's method; None without a simple branch point.

    The system is regular at one, with beta = 0 (Govaerts, Section 8.1). `guess`, `heading`: approximate point and
    direction; |heading| bounds the correction. `units`: see `scales`.
    """
    (extent, rows), n = units, guess.size - 1
    scaled = ScaledDerivative(evaluator, extent, rows)
    generic = generic_vector(3 * n + 2)
    newton = Iteration(np.append(guess, 0.0), POLISHING)
    here: Bordered | None = None

    def at(u: Array) -> Bordered:
        evaluator.counts.factorizations += 1
        matrix = scaled.at(u)
        if here is None:
            return Bordered.of(matrix, generic[:n, None], generic[n:].reshape(2, n + 1))
        return here.refreshed(matrix)

    def increment() -> Array:
        nonlocal here
        u, beta = newton.x[:-1], float(newton.x[-1])
        here = at(u)
        (phi, gamma), (kernel, left_over) = here.left, here.right
        gradient = np.array([-scaled.second(u, phi[:, 0], w) for w in kernel.T])
        first = here.solve(np.concatenate([-(evaluator.residual(u) / rows + beta * here.columns[:, 0]), np.zeros(2)]))
        within = np.linalg.solve(gradient @ kernel, -gamma[:, 0] - gradient @ first[:-1])
        step = first + np.vstack([kernel, left_over]) @ within
        step[:-1] *= extent
        return step

    def measure(step: Array) -> float:
        return float(np.abs(step[:-1] / extent).max())

    def done(size: float) -> bool:
        # At a zero of H beta is of second order.
        lost = newton.count > 1 and abs(newton.x[-1]) > size
        lost = lost or norm(weights, newton.x[:-1] - guess) > norm(weights, heading)
        # Stalled increments are round-off; if they grow, several ranks are lost.
        near = size < SIX_DIGITS * max(newton.ratio, 1.0)
        return lost or size <= BACKWARD_ERROR or (near and newton.ratio >= HALVING)

    try:
        # Nearly singular matrices may give non-finite numbers.
        with np.errstate(all="ignore"):
            if not newton.run(increment, measure, done) or not newton.size <= SIX_DIGITS:
                return None
            u = newton.x[:-1]
            here = at(u)
            if not np.abs(here.left[1]).max() <= RANK or abs(float(newton.x[-1])) > ROOT_OF_ROUND_OFF:
                return None
            if here.weak and kernels(scaled.at(u))[0].shape[1] > 2:
                # Several ranks are lost: no border of one column and two rows makes H' regular.
                return None
            if newton.size > ROOT_OF_ROUND_OFF:
                # At a regular zero one more increment is round-off; else branches touch, or more than two cross.
                newton.run(increment, measure, lambda size: True)
                if newton.size > ROOT_OF_ROUND_OFF:
                    return None
                u = newton.x[:-1]
                here = at(u)
            found = directions(scaled, here, u, heading / extent)
    except (ArithmeticError, np.linalg.LinAlgError):
        return None
    if found is None:
        return None
    first, second = (extent * d for d in found)
    return SimpleBranchPoint(u, (first / norm(weights, first), second / norm(weights, second)))


def directions(scaled: ScaledDerivative, here: Bordered, u: Array, heading: Array) -> tuple[Array, Array] | None:
    """Directions of two branches, scaled; None unless they cross transversally.

    The roots of sum_ij alpha_i alpha_j phi' H''[w_i, w_j] = 0 (Keller 1977; Allgower and Georg, Section 8.1).
    """
    # The path's direction comes first to avoid cancellation.
    kernel = np.linalg.qr(here.right[0])[0]
    w = np.linalg.qr(kernel @ np.column_stack([kernel.T @ heading, generic_vector(2)]))[0]
    rows = [scaled.second(u, here.left[0][:, 0], w[:, i]) for i in range(2)]
    a, b, c = float(rows[0] @ w[:, 0]), float(rows[0] @ w[:, 1]), float(rows[1] @ w[:, 1])
    discriminant = b * b - a * c
    if not discriminant > SECOND * SECOND * (b * b + abs(a * c)):
        return None
    root = np.sqrt(discriminant)
    q = -(b + (root if b >= 0 else -root))
    return w @ np.array([q, a]), w @ np.array([c, q])
