"""Simple branch points as regular zeros: Newton's method on a minimally augmented system, and the two directions there.

All of it is done in the units of the path: columns are multiplied by the extents of the metric, rows divided by what
they are made of, so that neither units nor the place of zero count.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array, Matrix, generic_vector
from continuation.contraction import HALVING, Contraction, Iteration
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.events.kernels import RANK, Bordered, kernels
from continuation.linear import Banded, Symmetric
from continuation.linear.entries import extended
from continuation.metric import inner, norm

POLISHING = Contraction(iterations=15, ratio=np.inf)
"""Newton's method from a guess: its first increments may grow, and where it goes is checked afterwards."""

POLISHED, POLISHED_NEARLY = 1e-14, 1e-6
"""The last increment, in extents; and the size below which increments that no longer halve are round-off."""

SECOND = 1e-5
"""Of an extent: the step of second derivatives, a central difference of first ones; ten digits of the path."""

DISTINCT_DIRECTIONS = 1e-9
"""The least discriminant, relative to its terms, of directions that are not one: the digits of SECOND."""

HALTED = 1e-9, 100.0
"""A simple branch point is a regular zero of the system: increments no longer halve at round-off, below the first even
where zero is a million extents away. Where they halve, and no more, several ranks are lost: the next singular value was
two to four times the last increment (Bratu's problem on a square, in any units)."""

IMPERFECT = 1e-8
"""What the augmented system may add to H, relative to its terms: more, and H has no zero where H' loses its rank."""


@frozen(eq=False)
class SimpleBranchPoint:
    """A point where H vanishes and H' has rank N - 1.

    Attributes
    ----------
    u : ndarray, shape (N + 1,)
    directions : tuple of two ndarrays, shape (N + 1,)
        Of the two branches, of unit length in the metric.
    """

    u: Array
    directions: tuple[Array, Array]

    def rays(self, heading: Array, weights: Array) -> Array:
        """Back, onward and both ways of the other branch, shape (4, N + 1), for a path that comes along `heading`."""
        along = [inner(weights, heading, d) for d in self.directions]
        k = int(np.argmax(np.abs(along)))
        onward, other = self.directions[k] * np.sign(along[k]), self.directions[1 - k]
        return np.array([-onward, onward, other, -other])


@frozen(eq=False)
class ScaledDerivative:
    """H' in the units of a path.

    Attributes
    ----------
    evaluator : Evaluator
    extent : ndarray, shape (N + 1,)
        By which columns are multiplied.
    rows : ndarray, shape (N,)
        By which rows are divided.
    """

    evaluator: Evaluator
    extent: Array
    rows: Array

    def at(self, u: Array) -> Matrix:
        """H' at u, shape (N, N + 1), dense or sparse."""
        full = full_derivative(self.evaluator, u)
        if sp.issparse(full):
            full.data *= np.repeat(self.extent, np.diff(full.indptr)) / self.rows[full.indices]
            return full
        return full * self.extent / self.rows[:, None]

    def second(self, u: Array, phi: Array, w: Array) -> Array:
        """The row phi' H''[w, .], shape (N + 1,), by a central difference of H' along w."""
        eps = SECOND / float(np.linalg.norm(w))
        move = eps * w * self.extent
        row: Array = (self.at(u + move).T @ phi - self.at(u - move).T @ phi) / (2.0 * eps)
        return row


def full_derivative(evaluator: Evaluator, u: Array) -> Matrix:
    """H' = [H_y, H_lam], shape (N, N + 1), dense or sparse, an array of its own."""
    H_y, H_lam = evaluator.derivative(u[:-1], float(u[-1]))
    evaluator.counts.jacobians += 1
    column = np.asarray(H_lam, dtype=float)
    if isinstance(H_y, Symmetric):
        H_y = H_y.matrix
    if isinstance(H_y, Banded):
        H_y = H_y.tosparse()
    if not (sp.issparse(H_y) or isinstance(H_y, np.ndarray)):
        raise EvaluationError("a matrix is needed here, and the Jacobian is an operator")
    return extended(H_y, column[:, None], np.empty((0, column.size + 1)))


def row_sizes(evaluator: Evaluator, extent: Array, points: tuple[Array, ...]) -> Array:
    """The largest entry of each row of H' at some points, its columns in units of the path; 1 where there is none."""
    sizes = np.zeros(extent.size - 1)
    for u in points:
        full = abs(full_derivative(evaluator, u))
        if sp.issparse(full):
            np.maximum.at(sizes, full.indices, full.data * np.repeat(extent, np.diff(full.indptr)))
        else:
            sizes = np.maximum(sizes, (full * extent).max(axis=1))
    return np.where(sizes > 0.0, sizes, 1.0)


def branch_point_near(
    evaluator: Evaluator, guess: Array, heading: Array, weights: Array, rows: Array
) -> SimpleBranchPoint | None:
    """Newton's method on H(u) + beta b = 0, gamma(u) = 0; None where that fails or finds no simple branch point.

    The system is regular at a simple branch point, where beta = 0 (Govaerts, Section 8.1, with the imperfection as an
    unknown). One factorisation and five evaluations of H' for each increment.

    Parameters
    ----------
    evaluator : Evaluator
    guess, heading : ndarray, shape (N + 1,)
        About where; and about where a branch leads, as long as the point may be off the guess.
    weights : ndarray, shape (N + 1,)
        Of the metric of the path.
    rows : ndarray, shape (N,)
        What the rows of H' are made of; see `row_sizes`.
    """
    extent, n = 1.0 / np.sqrt(weights), guess.size - 1
    scaled = ScaledDerivative(evaluator, extent, rows)
    generic = generic_vector(3 * n + 2)
    newton = Iteration(np.append(guess, 0.0), POLISHING)
    here: Bordered | None = None

    def at(u: Array) -> Bordered:
        evaluator.counts.factorizations += 1
        matrix = scaled.at(u)
        if here is None:
            return Bordered(matrix, generic[:n, None], generic[n:].reshape(2, n + 1))
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
        lost = norm(weights, newton.x[:-1] - guess) > norm(weights, heading)
        # So near to a regular zero increments that no longer halve are round-off; if they grow, several ranks are lost.
        near = size < POLISHED_NEARLY * max(newton.ratio, 1.0)
        return lost or size <= POLISHED or (near and newton.ratio >= HALVING)

    try:
        # A matrix that is nearly singular may give what is not finite: no number of it is believed unchecked.
        with np.errstate(all="ignore"):
            if not newton.run(increment, measure, done) or not newton.size <= POLISHED_NEARLY:
                return None
            u = newton.x[:-1]
            here = at(u)
            if not np.abs(here.left[1]).max() <= RANK or abs(float(newton.x[-1])) > IMPERFECT:
                return None
            # Where Newton's method came to a halt early the point is known to its last increment only, and so is H'.
            if kernels(here.matrix, max(RANK, HALTED[1] * newton.size))[0].shape[1] > 2:
                # Several ranks are lost: no border of one column and two rows makes that regular.
                return None
            if newton.size > HALTED[0]:
                # From near a regular zero the first increments may not halve; the next one is round-off. Where it is
                # not, the zero is a multiple one: branches touch there, or more than two cross.
                newton.run(increment, measure, lambda size: True)
                if newton.size > HALTED[0]:
                    return None
                u = newton.x[:-1]
                here = at(u)
            found = directions(scaled, here, u, heading / extent)
    except (ArithmeticError, np.linalg.LinAlgError, RuntimeError):
        return None
    if found is None:
        return None
    first, second = (extent * d for d in found)
    return SimpleBranchPoint(u, (first / norm(weights, first), second / norm(weights, second)))


def directions(scaled: ScaledDerivative, here: Bordered, u: Array, heading: Array) -> tuple[Array, Array] | None:
    """The directions of the two branches, in units of the path; None where no two branches cross transversally.

    The roots of the algebraic bifurcation equation sum_ij alpha_i alpha_j phi' H''[w_i, w_j] = 0 on the kernel
    (Keller 1977; Allgower and Georg, Section 8.1).
    """
    # The path's own direction first: it nearly is a root, and so no large term has to cancel where nothing is known of
    # the size of an unknown that stands still.
    kernel = np.linalg.qr(here.right[0])[0]
    w = np.linalg.qr(kernel @ np.column_stack([kernel.T @ heading, generic_vector(2)]))[0]
    rows = [scaled.second(u, here.left[0][:, 0], w[:, i]) for i in range(2)]
    a, b, c = float(rows[0] @ w[:, 0]), float(rows[0] @ w[:, 1]), float(rows[1] @ w[:, 1])
    discriminant = b * b - a * c
    if not discriminant > DISTINCT_DIRECTIONS * (b * b + abs(a * c)):
        return None
    # The two roots of a alpha^2 + 2 b alpha beta + c beta^2, in homogeneous coordinates, without cancellation.
    root = np.sqrt(discriminant)
    q = -(b + (root if b >= 0 else -root))
    return w @ np.array([q, a]), w @ np.array([c, q])
