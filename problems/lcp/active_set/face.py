"""One complementary face: x_i at a bound off a set, w_i = 0 on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import evolve, field, frozen
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular
from scipy.linalg.lapack import dgecon
from scipy.sparse.csgraph import structural_rank

from continuation.arrays import Array, Matrix, finite, largest
from continuation.linear.banded import factor_band
from continuation.linear.dense import factor_lu
from continuation.linear.factoring import Factoring
from continuation.linear.refine import Factored
from continuation.linear.silence import without_warnings
from continuation.linear.superlu import SuperLUMethod
from continuation.linear.symmetric import factor_cholesky
from problems.lcp.data.matrix_structure import Structure, scaled_band
from problems.lcp.data.problem import BETWEEN, MixedLCP, State
from problems.lcp.proof.compensated import row_terms

Mask = NDArray[np.bool_]

EPS = float(np.finfo(float).eps)

SINGULAR_CONDITION = 1e-14
"""Reciprocal condition of a singular face, whose solution has hardly a digit left."""

DOUBTFUL_PIVOTS = 1e-6
"""Ratio of extreme pivots below which the condition is estimated."""

SINGULAR_SHIFT = 1e-8
"""Relative diagonal shift of singular faces: smaller ones lose digits, larger ones converge more slowly."""

FACES_KEPT = 8
"""Faces kept for the next q: a motion to and fro visits few."""

SHIFTED_CORRECTIONS = 4
"""Corrections with a shifted matrix: each gains the ratio of the shift to the least singular value."""


@frozen(eq=False)
class Face:
    """One face and its factored equations ``A x + shift x + q = 0``.

    `inverse` solves the equations, or shifted ones. If `exact`, one solve gives the point. `shift` is zero on the
    problem's own face.
    """

    problem: MixedLCP
    state: State
    active: Mask
    inverse: Callable[[Array], Array]
    exact: bool
    shift: float
    q: Array

    @without_warnings(over="ignore", invalid="ignore")
    def point(self, near: Array) -> tuple[Array, Array] | None:
        """(x, w) on the face, near `near` if there are many; None if not finite."""
        standard = self.problem.standard
        x = np.zeros(near.size) if standard else self.problem.at(self.state)
        if not self.exact:
            x = np.where(self.active, near, x)
        for _ in range(1 if self.exact else SHIFTED_CORRECTIONS):
            x = self._corrected(x, self.q if self.exact and standard else self.w(x))
        w = self.w(x)
        if not (finite(x) and finite(w)):
            return None
        if self.exact:
            w[self.active] = 0.0
        return x, w

    def w(self, x: Array) -> Array:
        """``A x + shift x + q``, shape (n,)."""
        w: Array = self.problem.A.dot(x) + self.q
        return w + self.shift * x if self.shift else w

    @without_warnings(over="ignore", invalid="ignore")
    def refined(self, x: Array, w: Array | None = None) -> Array:
        """Correct x once, with accurate w."""
        return self._corrected(x, row_terms(self.problem, x).whole if w is None else w)

    def _corrected(self, x: Array, w: Array) -> Array:
        corrected = x.copy()
        corrected[self.active] -= self.inverse(w[self.active])
        return corrected


@frozen(eq=False)
class LeastNorm:
    """The shortest of the x nearest to A x = rhs, for a dense A of any rank (Golub and Van Loan, section 5.5.5).

    ``rows A columns = left triangle' right'``, where `left` and `right` have orthonormal columns.
    """

    left: Array
    triangle: Array
    right: Array
    rows: Array
    columns: Array
    sign: ClassVar[int] = 1

    @classmethod
    def of(cls, matrix: Array, near: Array) -> LeastNorm | None:
        """Factor by pivoted QR, cut at the rank, and QR of the transpose; None for rank zero.

        Lengths are relative to a positive `near`, so that a small x_i moves less than a large one (Mehrotra and Ye,
        Math. Programming 62, 1993).
        """
        sizes, positive = np.abs(matrix), bool((near > 0.0).all())
        rows = _inverse_powers((sizes * near if positive else sizes).max(axis=1))
        columns = near if positive else _inverse_powers((rows[:, None] * sizes).max(axis=0))
        left, r, order = qr(rows[:, None] * matrix * columns, mode="economic", pivoting=True, check_finite=False)
        pivots = np.abs(r.diagonal())
        rank = int(np.count_nonzero(pivots > EPS * len(matrix) * pivots[0]))
        if not rank:
            return None
        right = np.empty((len(matrix), rank))
        right[order], triangle = qr(r[:rank].T, mode="economic", check_finite=False)
        return cls(left[:, :rank], triangle, right, rows, columns)

    def solve(self, rhs: Array) -> Array:
        """The x for one right-hand side."""
        along = solve_triangular(self.triangle, self.left.T @ (self.rows * rhs), trans=1, check_finite=False)
        x: Array = self.columns * (self.right @ along)
        return x


def _inverse_powers(sizes: Array) -> Array:
    """Powers of two next to the inverses; ones for zeros."""
    return np.ldexp(1.0, -np.frexp(np.where(sizes > 0.0, sizes, 1.0))[1])


def exchanging(method: str = "auto") -> Factoring:
    """Factorisations of faces, at last by SuperLU with row exchanges."""
    return Factoring(method, SuperLUMethod(weak_pivots=False))


@frozen(eq=False)
class Faces:
    """The faces of one problem.

    `current` is the problem if its q is not the structure's.
    """

    structure: Structure
    current: MixedLCP | None = None
    kept: dict[bytes, Face] | None = None
    factoring: Factoring = field(factory=exchanging)

    @property
    def problem(self) -> MixedLCP:
        """The problem."""
        return self.structure.problem if self.current is None else self.current

    def face(
        self,
        state: State,
        shift: float = 0.0,
        centre: Array | None = None,
        regular: bool = False,
        near: Array | None = None,
    ) -> Face | None:
        """The factored face of a state; None if its equations have no factors, or if `regular` and they are singular.

        With a `centre` the face is that of the proximal problem, A + shift I and q - shift centre.
        """
        if self.kept is None or shift or centre is not None:
            return self._made(state, shift, centre, regular, near)
        key = state.tobytes()
        face = self.kept.pop(key, None) or self._made(state, shift, centre, regular, near)
        if face is None:
            return None
        self.kept[key] = face
        if len(self.kept) > FACES_KEPT:
            self.kept.pop(next(iter(self.kept)))
        same = face.problem is self.problem
        return face if same else evolve(face, problem=self.problem, q=self.problem.q)

    def _made(self, state: State, shift: float, centre: Array | None, regular: bool, near: Array | None) -> Face | None:
        problem = self.problem
        active = state == BETWEEN
        inside = active.nonzero()[0]
        q = problem.q if centre is None else problem.q - shift * centre
        inverse: Callable[[Array], Array] | None
        if inside.size == 0:
            inverse, exact = _same, True
        elif problem.sparse and self.structure.band is not None:
            inverse, exact = self._banded(active, shift), True
        else:
            block = problem.A if inside.size == problem.n else problem.A[inside][:, inside]
            factor, exact = self._sparse(block, shift) if problem.sparse else self._dense(block, shift, regular)
            if problem.standard and not (exact or regular or shift or problem.sparse):
                factor = self._nearest(inside, near) or factor
            inverse = None if factor is None else factor.solve
        return None if inverse is None else Face(problem, state, active, inverse, exact or centre is not None, shift, q)

    def _dense(self, block: Array, shift: float, regular: bool) -> tuple[Factored | None, bool]:
        block = np.array(block, order="F") if block is self.problem.A else np.asfortranarray(block)
        if shift:
            block[np.diag_indices(len(block))] += shift
        symmetric = len(block) > 1 and self.structure.symmetric
        if symmetric and (factor := _cholesky(block)) is not None:
            return factor, True
        # The test costs a factorisation.
        definite = symmetric and not regular and self.structure.semidefinite
        if not definite and (factor := _lu(block)) is not None:
            return factor, True
        if regular or not (norm := _norm(block)):
            return None, False
        block[np.diag_indices(len(block))] += SINGULAR_SHIFT * norm
        return (_cholesky if definite else _lu)(block), False

    def _nearest(self, inside: NDArray[np.intp], near: Array | None) -> Factored | None:
        """An LCP's shortest corrections from a point, if they solve the equations of the singular face.

        Otherwise the shifted solution grows along a null vector, whose signs tell which x_i leave.
        """
        problem = self.problem
        if self.structure.symmetric and self.structure.semidefinite:
            return None
        x = np.zeros(problem.n)
        if near is not None:
            x[inside] = near[inside]
        rows = problem.A[inside]
        block = rows[:, inside]
        factor = LeastNorm.of(block, x[inside])
        if factor is None:
            return None
        off = rows @ x + problem.q[inside]
        terms = np.abs(rows) @ np.abs(x) + np.abs(problem.q[inside])
        consistent = np.abs(block @ factor.solve(off) - off) <= SINGULAR_SHIFT * terms
        return factor if consistent.all() else None

    def _sparse(self, block: Matrix, shift: float) -> tuple[Factored | None, bool]:
        eye = sp.eye_array(block.shape[0])
        block = sp.csc_array(block + shift * eye if shift else block)
        # SuperLU prints messages on structurally singular matrices.
        full = bool(block.diagonal().all()) or structural_rank(block) == block.shape[0]
        factor = self.factoring.factor(block) if full else None
        if factor is not None:
            return factor, True
        norm = _norm(block)
        return self.factoring.factor(sp.csc_array(block + SINGULAR_SHIFT * norm * eye)) if norm else None, False

    def _banded(self, active: Mask, shift: float) -> Callable[[Array], Array] | None:
        """Solve in the whole band, with unit rows off the face."""
        assert self.structure.band is not None
        kept = active.astype(float)
        factor = factor_band(scaled_band(self.structure.band, kept, kept, np.where(active, shift, 1.0)))
        if factor is None:
            return None

        def inverse(right: Array) -> Array:
            whole = np.zeros(active.size)
            whole[active] = right
            return factor.solve(whole)[active]

        return inverse


def _same(right: Array) -> Array:
    return right


def _norm(block: Matrix) -> float:
    return float(abs(block).sum(axis=0).max())


def _cholesky(block: Array) -> Factored | None:
    """The factor; None if a pivot may be zero."""
    factor = factor_cholesky(block)
    if factor is None:
        return None
    rounding = EPS * len(block) * largest(block.diagonal())
    return factor if factor.least_pivot >= rounding else None


def _lu(block: Array) -> Factored | None:
    factor = factor_lu(block)
    if factor is None:
        return None
    pivots = np.abs(factor.lu.diagonal())
    # An estimate costs half a factorisation.
    doubtful = pivots.min() < DOUBTFUL_PIVOTS * pivots.max()
    return None if doubtful and dgecon(factor.lu, _norm(block))[0] < SINGULAR_CONDITION else factor
