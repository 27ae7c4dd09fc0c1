"""Homotopies for the linear complementarity problem: plug-ins of `continuation`, each with its reduction to order n.

Complementary pairs are eliminated one by one (`cores`, with bounds `sides` and `rows`), so that what is factored is of
order n + 1 whatever the number of unknowns. The full system is known by its products alone, and corrections in it
regain the digits that elimination loses near the boundary.
"""

from problems.lcp.data.matrix_structure import Structure
from problems.lcp.homotopies.kkt import KKTHomotopy
from problems.lcp.homotopies.starts import Start, default_start, random_start
from problems.lcp.homotopies.two_vector import (
    KojimaMegiddoMizunoHomotopy,
    TwoVectorHomotopy,
    WangHomotopy,
    XuHomotopy,
    YuHomotopy,
    ZhaoHomotopy,
)

__all__ = [
    "KKTHomotopy", "KojimaMegiddoMizunoHomotopy", "Start", "Structure", "TwoVectorHomotopy", "WangHomotopy",
    "XuHomotopy", "YuHomotopy", "ZhaoHomotopy", "default_start", "random_start",
]  # fmt: skip
