"""Bordered systems of the normal map, reduced to free unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.linear import Banded, BorderedSystem, SingularError, factor_bordered


@frozen(eq=False)
class NormalSystem:
    """[[F_aa, 0, F_a,lam], [F_ba, I, F_b,lam], [border]] without the rows of b.

    A symmetric permutation keeps the determinant's sign.
    """

    inner: BorderedSystem | None
    corner: float
    F_x: Matrix
    F_lam: Array
    free: Any
    on_bounds: Array

    @classmethod
    def of(cls, F_x: Matrix, F_lam: Array, free: Any, border: Array) -> NormalSystem:
        """Factor, or raise SingularError."""
        on_bounds = np.where(free, 0.0, border[:-1])
        row = border[:-1] - (F_x.tosparse() if isinstance(F_x, Banded) else F_x).T @ on_bounds
        corner = float(border[-1] - on_bounds @ F_lam)
        if not np.isfinite(F_lam).all():
            raise SingularError("the derivative is not finite")
        alpha = np.flatnonzero(free)
        if not alpha.size:
            if not abs(corner) > 0.0:
                raise SingularError("the bordered matrix is singular")
            return cls(None, corner, F_x, F_lam, free, on_bounds)
        inner = factor_bordered(_principal(F_x, alpha), F_lam[alpha], np.append(row[alpha], corner))
        return cls(inner, corner, F_x, F_lam, free, on_bounds)

    @property
    def sign(self) -> int:
        """The determinant's sign."""
        return self.inner.sign if self.inner is not None else int(np.sign(self.corner))

    def solve(self, r: Array, rho: float) -> Array:
        """Solve for free unknowns and parameter, then the rest."""
        rest = rho - float(self.on_bounds @ r)
        z = np.zeros(r.size + 1)
        if self.inner is None:
            z[-1] = rest / self.corner
        else:
            found = self.inner.solve(r[self.free], rest)
            z[:-1][self.free], z[-1] = found[:-1], found[-1]
        others = r - self.F_x @ z[:-1] - self.F_lam * z[-1]
        z[:-1][~self.free] = others[~self.free]
        return z


def _principal(F_x: Matrix, alpha: Any) -> Matrix:
    if alpha.size == F_x.shape[0]:
        return F_x
    if isinstance(F_x, np.ndarray):
        return F_x[np.ix_(alpha, alpha)]
    if not isinstance(F_x, Banded):
        return sp.csc_array(sp.csr_array(F_x)[alpha][:, alpha])
    # This does not widen the band.
    kept = sp.coo_array(F_x.tosparse().tocsr()[alpha][:, alpha])
    rows, columns = kept.coords
    ab = np.zeros((F_x.lower + F_x.upper + 1, alpha.size))
    ab[F_x.upper + rows - columns, columns] = kept.data
    return Banded(ab, F_x.lower, F_x.upper)
