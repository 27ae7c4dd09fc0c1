"""What may be said of a point: whether it is a solution, and whether it is stationary."""

from __future__ import annotations

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, largest, least
from problems.lcp.data.problem import MixedLCP
from problems.lcp.homotopies.rows import Rows
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.certificate import ROUND_OFF, Certificate, certify_exactly
from problems.lcp.proof.compensated import LARGEST_TERMS, accurate_w, error_bound
from problems.lcp.proof.pieces import identity, inverses

EPS = float(np.finfo(float).eps)

UNDERFLOW = float(np.finfo(float).tiny) / EPS
"""Below this products may have lost digits to underflow."""

LARGEST_DECIDED = 12
"""Up to this order all faces are tried in exact arithmetic, within about a second, before the first restart; and what
solves a problem to the tolerance but not to round-off is called a solution only if exact arithmetic agrees."""

ENTRY_ROUNDING = 2 * float(np.finfo(float).eps)
"""A relative residual below this is within rounding: half an eps for x, and half for each factor that gave the entries
their units, of a row and of a column; the last half is for their products."""

STATIONARY = 1e-6
"""Relative to their terms: how well the optimality conditions hold at what is called stationary.

A degenerate end is a series in the root of lambda, so that half of the digits of a good end can be asked of it.
"""

NEARLY = 1e-5
"""An end that solves the problem to this but not to the tolerance is an inaccurate solution, not a stationary point."""


def confirmed(problem: MixedLCP, certificate: Certificate, tolerance: float) -> bool:
    """Whether the point may be called a solution.

    One that passes `Certificate.solves`; but of a small problem, where that is cheap, exact arithmetic has to agree
    unless its rows are off by no more than the rounding of the entries.

    `certificate`: Of the point. `tolerance`: Of its relative residual.
    """
    if not certificate.solves(tolerance):
        return False
    if certificate.relative_residual <= ENTRY_ROUNDING or problem.n > LARGEST_DECIDED:
        return True
    return exact_nearby(problem, certificate.x, certificate.w)


def to_precision(problem: MixedLCP, certificate: Certificate) -> bool:
    """Whether x solves the conditions of a program whose data differ by round-off, relative to the largest of them.

    `confirmed` asks that of each row relative to its own terms, which no x can do where the files of a program have
    sides of rows of 1e-16 in place of zeros. A point that runs off to infinity, where the objective falls for ever, is
    told by q, which drowns there.

    `problem`: In balanced units. `certificate`: Of the point.
    """
    if problem.primal == 0 or certificate.drowned > 0.0:
        return False
    return problem.relative_residual(certificate.x) <= ROUND_OFF


def exact_nearby(problem: MixedLCP, x: Array, w: Array | None = None) -> bool:
    """Whether the problem has a solution, exactly, on the face of x or on one that x touches.

    Where rounding cannot matter floats prove it; in doubt the equations are solved in rationals.

    Parameters
    ----------
    problem : MixedLCP
        Small: dense matrices are made.
    x : ndarray, shape (n,)
        A point that is `confirmed`.
    w : ndarray, shape (n,), optional
        That of its certificate.

    References
    ----------
    Rump, "Verification methods: rigorous results using floating-point arithmetic", Acta Numerica 19, 2010, section 10.
    """
    # Asked by the finish, by the search and for the outcome, of the same point.
    point, answer = problem.known.get("exact", (None, False))
    if point is None or not (point is x or np.array_equal(point, x)):
        answer = (problem.standard and _clearly_exact(problem, x, w)) or certify_exactly(problem, x).solves
        problem.known["exact"] = x, answer
    return bool(answer)


def _clearly_exact(problem: MixedLCP, x: Array, w: Array | None = None) -> bool:
    """Whether floats prove it, as `Faced` does of many points; w is in twice the working precision."""
    if not x.any():
        return least(problem.q) >= 0.0
    if least(x) < 0.0:
        return False
    A: Array = problem.A.toarray() if problem.sparse else problem.A
    size = np.abs(A).dot(x) + np.abs(problem.q)
    # Beyond this w is summed over powers of two, and what it lost is not known here.
    if not (least(size) >= 1.0 / LARGEST_TERMS and largest(size) <= LARGEST_TERMS):
        return False
    w = accurate_w(problem, x)[0] if w is None else w
    return bool(Faced.of(A, x).exact(w, error_bound(w, size, problem.n + 1)))


@frozen(eq=False)
class Faced:
    """The equations of the faces of points of a stack of LCPs, in units of x, with approximate inverses.

    Where the others are off a face its block B has rows of the identity. With an approximate inverse R and
    |I - R B| <= d < 1, B is not singular, and B u = r has |u| <= |R| |r| / (1 - d) in the largest norm.

    `on`, of shape (..., n): Where x > 0. `total`, `top`, of shape (..., n): Sum and largest of the terms of each
    row of A x, the largest 1 off the face. `size`, of shape (..., n, n): |R|. `defect`, of shape (...): d, NaN or
    infinite where nothing is proved.
    """

    on: NDArray[np.bool_]
    total: Array
    top: Array
    size: Array
    defect: Array

    @classmethod
    def of(cls, A: Array, x: Array) -> Faced:
        """For points x >= 0.

        `A` of shape (..., n, n). `x` of shape (..., n).
        """
        on, n = x > 0.0, x.shape[-1]
        terms = A * x[..., None, :]
        sizes = np.abs(terms)
        # Reductions of ufuncs: for the small problems that come here methods of arrays take half as long again.
        total = np.add.reduce(sizes, axis=-1)
        top = np.where(on, np.maximum(np.maximum.reduce(sizes, axis=-1), UNDERFLOW), 1.0)
        fine = np.minimum.reduce(top, axis=-1) > UNDERFLOW
        one = identity(n)
        block = np.where(on[..., None], terms, one)
        block /= top[..., None]
        inverse = inverses(block)
        # What rounding of the block and of the product may hide (Higham, section 3.5), twice; no row of |B| sums to
        # more than n.
        size, rounding = np.abs(inverse), 2.0 * (n + 4) * EPS
        off = np.abs(inverse @ block - one)
        off += n * rounding * size
        defect = np.maximum.reduce(np.add.reduce(off, axis=-1), axis=-1)
        return cls(on, total, top, size, np.where(fine, defect, np.inf))

    def exact(self, w: Array, bound: Array) -> NDArray[np.bool_]:
        """Whether the equations have a solution near x with w > 0 elsewhere.

        `w`, `bound`, of shape (..., n): w, and how far it may be off.
        """
        right = np.where(self.on, (np.abs(w) + bound) / self.top, 0.0)
        moved = np.maximum.reduce((self.size @ right[..., None])[..., 0], axis=-1)
        moved = moved * (1.0 + ROUND_OFF) / (1.0 - self.defect)
        clear = self.on | (w - bound > 2.0 * moved[..., None] * self.total)
        exact: NDArray[np.bool_] = (self.defect < 0.5) & (moved < 0.5) & np.logical_and.reduce(clear, axis=-1)
        return exact


def stationary(problem: MixedLCP, y: Array) -> bool:
    """Whether y = (x, z1, z2) satisfies the optimality conditions of min x'(A x + q) over x >= 0, A x + q >= 0.

    That is (A + A') x + q = z1 + A' z2, x, w, z1, z2 >= 0, x_i z1_i = 0 and w_i z2_i = 0: relative to the sizes of x,
    w, z1 and z2, so that a common factor of A and q, and one of q alone, makes no difference. With bounds those of the
    gap, as `KKTHomotopy` has them.
    """
    rows = Rows(problem)
    if y.size != rows.size:
        return False
    x, z1, z2, t = rows.split(y)
    w, gaps, moved = problem.w(x), rows.sides.gaps(x), x - rows.end
    raised = rows.raised(w, t)
    unit_x, unit_w = natural_units(problem)
    size_x = unit_x + max(float(np.abs(moved).max()), float(np.abs(z2).max()))
    largest_w = max(float(np.abs(part).max(initial=0.0)) for part in (w, z1, t))
    size_w = unit_w + max(largest_w, unit_w / unit_x * size_x)
    gradient = w + problem.A.T @ moved - rows.sides.force(z1) - problem.A.T @ z2
    bounded, room = ~rows.free, rows.width - z2[rows.boxed]
    of_x = np.concatenate([gaps, (rows.signs * z2)[bounded], room])
    of_w = np.concatenate([(rows.signs * raised)[bounded], z1, t])
    lowest = min(float(of_x.min(initial=0.0)) / size_x, float(of_w.min(initial=0.0)) / size_w)
    products = np.abs(np.concatenate([gaps * z1, (raised * z2)[bounded], room * t])).max(initial=0.0)
    off = max(float(np.abs(gradient).max()), float(np.abs(w[rows.free]).max(initial=0.0))) / size_w
    return max(off, float(products) / (size_x * size_w), -lowest) <= STATIONARY
