"""Decides whether points are solutions, or stationary."""

from __future__ import annotations

import numpy as np

from continuation.arrays import EPS, Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.homotopies.rows import Rows
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.certificate import ROUND_OFF, Certificate

LARGEST_DECIDED = 12
"""Largest order for exact trial of all faces (about 1 s) and exact confirmation."""

ENTRY_ROUNDING = 2 * EPS
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
    return certificate.exact


def to_precision(problem: MixedLCP, certificate: Certificate) -> bool:
    """Whether x solves a program's conditions up to round-off of its largest data, in balanced units.

    `confirmed` rejects every x where a file has 1e-16 instead of zero.
    """
    if problem.primal == 0 or certificate.drowned > 0.0:
        return False
    return problem.relative_residual(certificate.x) <= ROUND_OFF


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
