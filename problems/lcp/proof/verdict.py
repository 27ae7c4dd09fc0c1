"""Decides whether points are solutions, or stationary."""

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
"""Smaller products may have lost digits."""

LARGEST_DECIDED = 12
"""Largest order for exact trial of all faces (about 1 s) and exact confirmation."""

ENTRY_ROUNDING = 2 * float(np.finfo(float).eps)
"""Smaller residuals are rounding: half an eps each for x, units and products."""

STATIONARY = 1e-6
"""Relative tolerance of optimality conditions: degenerate ends have half the digits."""

NEARLY = 1e-5
"""Ends with smaller residuals are inaccurate solutions."""


def confirmed(problem: MixedLCP, certificate: Certificate, tolerance: float) -> bool:
    """Whether the point is a solution; for small problems exact arithmetic must agree."""
    if not certificate.solves(tolerance):
        return False
    if certificate.relative_residual <= ENTRY_ROUNDING or problem.n > LARGEST_DECIDED:
        return True
    return exact_nearby(problem, certificate.x, certificate.w)


def to_precision(problem: MixedLCP, certificate: Certificate) -> bool:
    """Whether x solves a program's conditions up to round-off of its largest data, in balanced units.

    `confirmed` rejects every x where a file has 1e-16 instead of zero.
    """
    if problem.primal == 0 or certificate.drowned > 0.0:
        return False
    return problem.relative_residual(certificate.x) <= ROUND_OFF


def exact_nearby(problem: MixedLCP, x: Array, w: Array | None = None) -> bool:
    """Whether an exact solution exists on the face of x or an adjacent one.

    Parameters
    ----------
    problem : MixedLCP
        It becomes dense.
    x : ndarray, shape (n,)
    w : ndarray, shape (n,), optional

    References
    ----------
    Rump, Acta Numerica 19, 2010, section 10.
    """
    point, answer = problem.known.get("exact", (None, False))
    if point is None or not (point is x or np.array_equal(point, x)):
        answer = (problem.standard and _clearly_exact(problem, x, w)) or certify_exactly(problem, x).solves
        problem.known["exact"] = x, answer
    return bool(answer)


def _clearly_exact(problem: MixedLCP, x: Array, w: Array | None = None) -> bool:
    if not x.any():
        return least(problem.q) >= 0.0
    if least(x) < 0.0:
        return False
    A: Array = problem.A.toarray() if problem.sparse else problem.A
    size = np.abs(A).dot(x) + np.abs(problem.q)
    # Elsewhere the error of w is unknown.
    if not (least(size) >= 1.0 / LARGEST_TERMS and largest(size) <= LARGEST_TERMS):
        return False
    w = accurate_w(problem, x)[0] if w is None else w
    return bool(Faced.of(A, x).exact(w, error_bound(w, size, problem.n + 1)))


@frozen(eq=False)
class Faced:
    """Face equations of points of a stack of LCPs, with approximate inverses R.

    If |I - R B| <= d < 1, B is nonsingular and B u = r has |u| <= |R| |r| / (1 - d) (maximum norm); off the face B has
    rows of the identity.

    `on` says where x > 0; `total` and `top` are the sum and maximum of a row's terms, `size` is |R|, `defect` d.
    """

    on: NDArray[np.bool_]
    total: Array
    top: Array
    size: Array
    defect: Array

    @classmethod
    def of(cls, A: Array, x: Array) -> Faced:
        """For points x >= 0, of shape (..., n)."""
        on, n = x > 0.0, x.shape[-1]
        terms = A * x[..., None, :]
        sizes = np.abs(terms)
        # Array methods take 1.5 times as long.
        total = np.add.reduce(sizes, axis=-1)
        top = np.where(on, np.maximum(np.maximum.reduce(sizes, axis=-1), UNDERFLOW), 1.0)
        fine = np.minimum.reduce(top, axis=-1) > UNDERFLOW
        one = identity(n)
        block = np.where(on[..., None], terms, one)
        block /= top[..., None]
        inverse = inverses(block)
        # Twice the rounding of block and product (Higham, section 3.5).
        size, rounding = np.abs(inverse), 2.0 * (n + 4) * EPS
        off = np.abs(inverse @ block - one)
        off += n * rounding * size
        defect = np.maximum.reduce(np.add.reduce(off, axis=-1), axis=-1)
        return cls(on, total, top, size, np.where(fine, defect, np.inf))

    def exact(self, w: Array, bound: Array) -> NDArray[np.bool_]:
        """Whether the equations have a solution near x with w > 0 elsewhere."""
        right = np.where(self.on, (np.abs(w) + bound) / self.top, 0.0)
        moved = np.maximum.reduce((self.size @ right[..., None])[..., 0], axis=-1)
        moved = moved * (1.0 + ROUND_OFF) / (1.0 - self.defect)
        clear = self.on | (w - bound > 2.0 * moved[..., None] * self.total)
        exact: NDArray[np.bool_] = (self.defect < 0.5) & (moved < 0.5) & np.logical_and.reduce(clear, axis=-1)
        return exact


def stationary(problem: MixedLCP, y: Array) -> bool:
    """Whether y = (x, z1, z2) satisfies the optimality conditions of min x'(A x + q) over x >= 0, A x + q >= 0.

    That is, (A + A') x + q = z1 + A' z2, x, w, z1, z2 >= 0, x_i z1_i = w_i z2_i = 0. For bounds see `KKTHomotopy`.
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
