"""Defects of rows: shares of x in their terms, and q drowned in rounding."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix
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


def shares_in_rows(A: Matrix, terms: Terms, distance: Array, asked: NDArray[np.bool_]) -> Array:
    """Signed distances from a bound as largest shares in a row's terms; infinite where not asked."""
    there = distance == 0.0
    shares = np.where(there, 0.0, np.inf)
    indices = (asked & ~there).nonzero()[0]
    indices = indices[np.isfinite(distance[indices])]
    if indices.size:
        sizes, powers = np.frexp(np.abs(distance[indices]))
        totals, exponents = np.where(terms.size > 0.0, terms.size, 1.0), np.broadcast_to(terms.exponents, distance.size)
        with np.errstate(over="ignore", under="ignore"):
            if sp.issparse(A):
                columns = abs(sp.csr_array(A)[:, indices]).tocoo()
                row, k = columns.coords
                most, present = np.zeros((2, indices.size))
                np.maximum.at(most, k, np.ldexp(columns.data * sizes[k] / totals[row], powers[k] - exponents[row]))
                np.maximum.at(present, k, columns.data)
            else:
                columns = np.abs(A[:, indices])
                present = columns.max(axis=0)
                most = np.ldexp(columns * sizes / totals[:, None], powers - exponents[:, None]).max(axis=0)
        most = np.minimum(most, np.finfo(float).max)
        shares[indices] = np.sign(distance[indices]) * np.where(present > 0.0, most, 1.0)
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
