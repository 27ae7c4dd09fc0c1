"""Bratu's problem: the continuum in closed form, and folds of the difference equations.

The tables were computed by an independent Newton method on Moore and Spence's system, to the digits shown.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

FOLD_1D = {
    100: (3.513651506259, 1.186668404831),
    200: (3.513785470018, 1.186798294404),
    500: (3.513823435897, 1.186835106661),
    1000: (3.513828894680, 1.186840399612),
}
"""n: (lam, max u) at the fold of `problems.bifurcation.Bratu1D`."""

FOLD_2D = {10: 6.795336259705, 20: 6.804690882680, 30: 6.806555879189, 50: 6.807546291652, 100: 6.807977170015}
"""m: lam at the fold of `problems.bifurcation.Bratu2D`."""

FOLD_MAX_2D = {50: 1.390069754724, 100: 1.391255352067}
"""m: max u at the fold of `problems.bifurcation.Bratu2D`."""


def continuum_fold_1d() -> tuple[float, float, float]:
    """(theta, lam, max u) at the continuum's fold: z tanh z = 1, z = th/4, lam = 8 z^2/cosh(z)^2."""
    z: float = brentq(lambda z: z * np.tanh(z) - 1.0, 1.0, 1.5, xtol=1e-15)
    return 4.0 * z, float(8.0 * (z / np.cosh(z)) ** 2), float(2.0 * np.log(np.cosh(z)))
