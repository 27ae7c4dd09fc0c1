"""Simple branch points: recognised by the determinant's sign, polished, and left on the other branch."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from attrs import evolve, field, frozen
from scipy.sparse.linalg import splu

from continuation.arrays import Array, Matrix, generic_vector, largest
from continuation.checks import integer
from continuation.contraction import HALVING, Contraction, Iteration, magnitude
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.linear import Banded, Symmetric
from continuation.metric import inner
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.point.segment import Segment, hermite
from continuation.status import Kind

POLISHING = Contraction(iterations=12, ratio=np.inf)
"""Newton's method from a bracket: its first increments may grow, and where it goes is checked afterwards."""

POLISHED, POLISHED_NEARLY = 1e-13, 1e-9
"""The last increment, relative to 1 + |u|; and the size below which increments that no longer halve are round-off."""

NARROW = 1e-5
"""Of the bracket, relative to the first: Newton's method does the rest, and a bracket of 1e-7 is one of round-off."""

BISECTIONS = 40
MARGIN = 0.02
"""A guess is kept so far from the ends of the bracket, in its widths: its test function has a pole beside its zero."""

BESIDE = 0.97, 0.015
"""t, with this factor and summand, is a place beside t, in (0, 1) whatever t is, that no symmetry of the arc
aligns with it; one and a half hundredths of a bracket is nearer than its next halving."""

STRAIGHT = 0.99
"""The cosine between the tangents on both sides of a branch point; they agree but for the bracket times a curvature."""

BESIDE_PATH = 1e-4
"""A point so far off, in extents of the path, is no point of it. The middle of a bracket is off by 1e-10."""

SAME_PLACE = 1e-2
"""How far polishing may move the point, in chords of the arc: a thousand brackets."""


@frozen
class BranchPoint:
    """Where the determinant changes sign although the tangent does not turn: two branches cross.

    The tracer always watches for it, since it must flip its orientation there; name it among the events to stop at it.
    """

    terminal: int = field(default=1, validator=integer(0))
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.BRANCH_POINT, init=False)
    name: str = field(default="branch point", init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """A constant: the determinant's sign is no function of point and tangent, the tracer compares it itself."""
        return 1.0


def locate_branch_point(solver: PathSolver, a: Linearization, b: Linearization) -> Linearization | None:
    """The branch point between a and b, whose determinant signs differ; None if the path merely turned there.

    A missed hairpin flips the sign too, but there the tangent turns through a right angle somewhere in between. So the
    interval is narrowed on the sign, with the help of the smooth test function 1 / (d' M^{-1} b), which vanishes with
    det M, and what is left is a branch point if the tangent does not turn across it.
    """
    generator = np.random.default_rng(2)
    n = a.u.size - 1
    right, left = generator.standard_normal(n), generator.standard_normal(n + 1)

    def test(point: Linearization) -> float:
        value = float(np.dot(left, point.solve(right, 0.0, a.border)))
        return point.orientation / max(abs(value), 1e-300)

    try:
        low, high = a, b
        g_low, g_high = test(low), test(high)
        width = first = float(np.dot(a.border, b.u - a.u))
        halve = False
        for _ in range(BISECTIONS):
            segment = hermite(low.u, low.tangent, high.u, high.tangent, a.border)
            t = 0.5 if halve else min(max(g_low / (g_low - g_high), MARGIN), 1.0 - MARGIN)
            point = _factored(solver, low if t < 0.5 else high, segment, t, a.border)
            if point.orientation == low.orientation:
                low, g_low = point, test(point)
            else:
                high, g_high = point, test(point)
            narrowed = float(np.dot(a.border, high.u - low.u))
            halve, width = narrowed > HALVING * width, narrowed
            if width <= NARROW * first:
                break
    except EvaluationError:
        return None
    if inner(a.weights, low.tangent, high.tangent) < STRAIGHT or inner(a.weights, a.tangent, low.tangent) < 0.0:
        return None
    u = polish(solver.evaluator, 0.5 * (low.u + high.u))
    if u is None or float(np.linalg.norm(u - low.u)) > SAME_PLACE * float(np.linalg.norm(b.u - a.u)):
        u = 0.5 * (low.u + high.u)
    # Between points of two paths lies no point of either: the determinant's sign differs, and nothing crosses.
    return evolve(low, u=u) if _near_path(solver.evaluator, low.weights, u) else None


def _near_path(evaluator: Evaluator, weights: Array, u: Array) -> bool:
    """Whether the equations are off by less than a move of BESIDE_PATH, in the metric, makes of them."""
    r, extent, generic = evaluator.residual(u), 1.0 / np.sqrt(weights * u.size), generic_vector(u.size)
    moves = (BESIDE_PATH * extent * part for part in (generic, generic[::-1]))
    changes = [np.abs(evaluator.residual(u + move) - r) for move in moves]
    return bool((np.abs(r) <= np.maximum(*changes)).all())


def _factored(solver: PathSolver, near: Linearization, segment: Segment, t: float, border: Array) -> Linearization:
    """The path's point near t with factors of its own: those from the other side of a branch point have another sign.

    In the branch point itself there is no factorisation; a point beside it serves as well.
    """
    for beside in (t, BESIDE[0] * t + BESIDE[1]):
        u, _ = solver.project(near, segment.at(beside), border)
        try:
            return linearize(solver.evaluator, u, near.weights, border)
        except EvaluationError:
            continue
    raise EvaluationError("no factorisation in or beside a supposed branch point")


def _full(evaluator: Evaluator, u: Array) -> Matrix:
    """H' = [H_y, H_lam], shape (N, N + 1), dense or sparse."""
    H_y, H_lam = evaluator.derivative(u[:-1], float(u[-1]))
    evaluator.counts.jacobians += 1
    column = np.asarray(H_lam, dtype=float).reshape(-1, 1)
    if isinstance(H_y, Symmetric):
        H_y = H_y.matrix
    if isinstance(H_y, Banded):
        H_y = H_y.tosparse()
    if sp.issparse(H_y):
        return sp.csc_array(sp.hstack([H_y, sp.csc_array(column)]))
    if not isinstance(H_y, np.ndarray):
        raise EvaluationError("a matrix is needed at a branch point, and the Jacobian is an operator")
    return np.hstack([H_y, column])


@frozen(eq=False)
class Singularity:
    """The null spaces of H' at a simple branch point, from one doubly bordered matrix.

    `phi` spans the left null space, the columns of `kernel` the right one; `gamma` (two numbers) is how far H' is from
    losing rank.
    """

    phi: Array
    kernel: Array
    gamma: Array


def _singularity(H: Matrix, column: Array, rows: Array) -> Singularity:
    """Solve with [[H', b], [C, 0]] and its transpose (Govaerts, Numerical Methods for Bifurcations, Section 3.3)."""
    n = H.shape[0]
    unit = np.zeros(n + 2)
    unit[-1] = 1.0
    rights = np.zeros((n + 2, 2))
    rights[n, 0] = rights[n + 1, 1] = 1.0
    if sp.issparse(H):
        bordered = sp.csc_array(sp.block_array([[H, sp.csc_array(column[:, None])], [sp.csc_array(rows), None]]))
        factor = splu(bordered)
        left: Array = factor.solve(unit, trans="T")
        kernel: Array = factor.solve(rights)
    else:
        full = np.block([[H, column[:, None]], [rows, np.zeros((2, 1))]])
        left, kernel = np.linalg.solve(full.T, unit), np.linalg.solve(full, rights)
    return Singularity(left[:n], kernel[: n + 1], left[n:])


def _second(evaluator: Evaluator, u: Array, phi: Array, w: Array) -> Array:
    """The row phi' H''[w, .], shape (N + 1,), by a central difference of H' along w."""
    size = float(np.linalg.norm(w))
    eps = 1e-5 * (1.0 + float(np.abs(u).max())) / size
    ahead, behind = _full(evaluator, u + eps * w), _full(evaluator, u - eps * w)
    row: Array = (ahead.T @ phi - behind.T @ phi) / (2.0 * eps)
    return row


def _borders(size: int) -> tuple[Array, Array]:
    generator = np.random.default_rng(3)
    return generator.standard_normal(size - 1), generator.standard_normal((2, size))


def polish(evaluator: Evaluator, u: Array) -> Array | None:
    """Newton on the minimally augmented system H(u) + beta b = 0, gamma(u) = 0; None if it fails."""
    column, rows = _borders(u.size)
    newton = Iteration(np.append(u, 0.0), POLISHING)

    def increment() -> Array:
        u, beta = newton.x[:-1], float(newton.x[-1])
        H = _full(evaluator, u)
        here = _singularity(H, column, rows)
        gradient = [-_second(evaluator, u, here.phi, here.kernel[:, i]) for i in range(2)]
        r = np.concatenate([evaluator.residual(u) + beta * column, here.gamma])
        return _solve_augmented(H, column, np.array(gradient), -r)

    def done(size: float) -> bool:
        if size < POLISHED_NEARLY and newton.ratio >= HALVING:
            return True
        return size <= POLISHED * (1.0 + largest(newton.x[:-1]))

    try:
        return newton.x[:-1] if newton.run(increment, magnitude, done) else None
    except (ArithmeticError, np.linalg.LinAlgError, RuntimeError):
        return None


def _solve_augmented(H: Matrix, column: Array, gradient: Array, r: Array) -> Array:
    if sp.issparse(H):
        matrix = sp.csc_array(sp.block_array([[H, sp.csc_array(column[:, None])], [sp.csc_array(gradient), None]]))
        z: Array = splu(matrix).solve(r)
        return z
    full: Array = np.linalg.solve(np.block([[H, column[:, None]], [gradient, np.zeros((2, 1))]]), r)
    return full
