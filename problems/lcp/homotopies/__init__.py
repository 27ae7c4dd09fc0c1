"""LCP homotopies, which factor matrices of order n + 1."""

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
