"""Defects of rows: shares of x in their terms, and q drowned in rounding."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.scaling import units
from problems.lcp.data.spread import alike
from problems.lcp.proof.compensated import Terms

DROWNED = 1e-6
"""Largest allowed defect relative to max |q_i| in balanced units."""

FAR_BELOW_Q = 1e-10
"""Smaller values count as zero: Maros-Meszaros solutions are below 1e-12."""

CLEAR_OF_ZERO = 1e-13
"""Smaller defects, relative to the least nonzero |q_i|, are zero if entries are `alike`: units would cost 0.45 of
1.2 ms."""


def shares_in_rows(terms: Terms, x: Array, distance: Array, asked: NDArray[np.bool_]) -> Array:
    """Signed distances from a bound as largest shares in a row's terms; infinite where not asked."""
    there = distance == 0.0
    shares = np.where(there, 0.0, np.inf)
    indices = (asked & ~there).nonzero()[0]
    indices = indices[np.isfinite(distance[indices])]
    if indices.size:
        inverse = 1.0 / np.where(terms.size > 0.0, terms.size, 1.0)
        sizes = np.abs(distance[indices])
        if terms.scaled:
            # In the units of terms.x, the mantissas of x.
            sizes = np.minimum(np.ldexp(sizes, -np.frexp(x[indices])[1]), np.finfo(float).max)
        with np.errstate(under="ignore"):
            if sp.issparse(terms.A):
                columns = abs(sp.csr_array(terms.A)[:, indices])
                present = (columns != 0.0).sum(axis=0) > 0
                most = (sp.diags_array(inverse) @ (columns @ sp.diags_array(sizes))).max(axis=0).toarray().ravel()
            else:
                columns = np.abs(terms.A[:, indices])
                present = (columns > 0.0).any(axis=0)
                most = (columns * sizes * inverse[:, None]).max(axis=0)
        shares[indices] = np.sign(distance[indices]) * np.where(present, most, 1.0)
    return shares


def drowned_part(problem: MixedLCP, terms: Terms, off: Array) -> float:
    """See `Certificate.drowned`. `off` are defects relative to the terms."""
    q = np.ldexp(problem.q, -terms.exponents) if terms.scaled else problem.q
    asked = off * terms.size > DROWNED * np.abs(q)
    if not np.count_nonzero(asked):
        return 0.0
    if not terms.scaled:
        constants = np.abs(q)
        clear = float((off * terms.size)[asked].max()) <= CLEAR_OF_ZERO * float(
            constants[constants > 0.0].min(initial=np.inf)
        )
        if clear and q.any() and alike(problem):
            return 0.0
    rows, _ = units(problem)
    size = float(np.ldexp(np.abs(problem.q), rows).max())
    worst = float(np.ldexp((off * terms.size)[asked], (rows + terms.exponents)[asked]).max())
    part = worst / size if size > 0.0 else 0.0
    return part if part > FAR_BELOW_Q else 0.0
