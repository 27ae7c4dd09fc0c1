"""One complementary face: x_i at a bound off a set, w_i = 0 on it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from attrs import evolve, field, frozen
from scipy.linalg.lapack import dgecon
from scipy.sparse.csgraph import structural_rank

from continuation.arrays import EPS, Array, Mask, Matrix, finite, largest
from continuation.linear.banded import factor_band
from continuation.linear.dense import factor_lu
from continuation.linear.factoring import Factoring
from continuation.linear.refine import Factored
from continuation.linear.silence import without_warnings
from continuation.linear.symmetric import factor_cholesky
from problems.lcp.data.matrix_structure import Structure, scaled_band
from problems.lcp.data.problem import BETWEEN, MixedLCP, State
from problems.lcp.proof.compensated import row_terms

SINGULAR_CONDITION = 1e-14
"""Reciprocal condition of a singular face: its solution has hardly a digit left."""

SINGULAR_SHIFT = 1e-8
"""Relative diagonal shift of singular faces: smaller ones lose digits, larger ones converge slowly."""


@frozen(eq=False)
class Face:
    """One face and its factored equations ``A x + shift x + q = 0``.

    `inverse` solves these, or shifted ones; if `exact`, one solve gives the point. `shift` is zero on the problem's own
    face.
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
        x = self._corrected(x, self.q if self.exact and standard else self.w(x))
        if not self.exact:
            # The first correction leaves the ratio of shift to least singular value.
            x = self._corrected(x, self.w(x))
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


def exchanging(method: str = "auto") -> Factoring:
    """Factorisations of faces; the last resort is SuperLU with row exchanges."""
    return Factoring(method, weak_pivots=False)


@frozen(eq=False)
class Faces:
    """The faces of one problem; `kept` is one of a problem with the same A."""

    structure: Structure
    factoring: Factoring = field(factory=exchanging)
    kept: Face | None = None

    @property
    def problem(self) -> MixedLCP:
        """The problem."""
        return self.structure.problem

    def face(
        self,
        state: State,
        shift: float = 0.0,
        centre: Array | None = None,
        regular: bool = False,
    ) -> Face | None:
        """The factored face of a state; None without factors, or if `regular` and singular.

        With a `centre` the face is that of the proximal problem, A + shift I and q - shift centre.
        """
        problem, kept = self.problem, self.kept
        if kept is not None and not shift and centre is None and np.array_equal(state, kept.state):
            return evolve(kept, problem=problem, q=problem.q)
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
            inverse = None if factor is None else factor.solve
        return None if inverse is None else Face(problem, state, active, inverse, exact or centre is not None, shift, q)

    def _dense(self, block: Array, shift: float, regular: bool) -> tuple[Factored | None, bool]:
        block = np.array(block, order="F") if block is self.problem.A else np.asfortranarray(block)
        if shift:
            block[np.diag_indices(len(block))] += shift
        symmetric = len(block) > 1 and self.structure.symmetric
        if symmetric and (factor := _cholesky(block)) is not None:
            return factor, True
        # Asking costs a factorisation.
        definite = symmetric and not regular and self.structure.semidefinite
        if not definite and (factor := _lu(block)) is not None:
            return factor, True
        if regular or not (norm := _norm(block)):
            return None, False
        block[np.diag_indices(len(block))] += SINGULAR_SHIFT * norm
        return (_cholesky if definite else _lu)(block), False

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
    """The Cholesky factor; None if a pivot may be zero."""
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
    # An estimate costs half a factorisation; the ratio of pivots loses at most half the digits of the condition.
    doubtful = pivots.min() < np.sqrt(SINGULAR_CONDITION) * pivots.max()
    return None if doubtful and dgecon(factor.lu, _norm(block))[0] < SINGULAR_CONDITION else factor
