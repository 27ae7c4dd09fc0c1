"""Bratu's problem: folds of the difference equations.

The tables were computed by an independent Newton method on Moore and Spence's system, to the digits shown.
"""

from __future__ import annotations

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
