"""The LCP homotopies by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from attrs import frozen

from continuation.arrays import Array
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import MixedLCP
from problems.lcp.homotopies.kkt import KKTHomotopy
from problems.lcp.homotopies.starts import Start
from problems.lcp.homotopies.two_vector import (
    KojimaMegiddoMizunoHomotopy,
    TwoVectorHomotopy,
    WangHomotopy,
    XuHomotopy,
    YuHomotopy,
    ZhaoHomotopy,
)

LCPHomotopy = KKTHomotopy | TwoVectorHomotopy


@frozen
class Registered:
    """A homotopy.

    `feasible`: whether its default start is strictly feasible. `example`: a paper example it solves. `bounds`: whether
    it takes bounds.
    """

    name: str
    title: str
    sentence: str
    make: Callable[..., LCPHomotopy]
    feasible: bool = False
    example: int = 2
    bounds: bool = False

    def from_x0(self, problem: MixedLCP, x0: Array | None, structure: Structure) -> LCPHomotopy:
        """Homotopy from x0 or its default."""
        return self.make(problem, x0, structure=structure)

    def at(self, problem: MixedLCP, start: Start, structure: Structure, refine: bool) -> LCPHomotopy:
        """The homotopy at a start; one in (x, y) uses x0 and w0."""
        if self.make is KKTHomotopy:
            return KKTHomotopy(problem, start.x0, start.z1, start.z2, start.w0, structure=structure, refine=refine)
        return self.make(problem, start.x0, start.w0, structure=structure)


HOMOTOPIES: Mapping[str, Registered] = {
    one.name: one
    for one in (
        Registered(
            "kkt", "KKT", "The KKT homotopy of Dutta, Das and Jana, for any A, from any positive start.", KKTHomotopy,
            bounds=True,
        ),
        Registered(
            "wang", "Wang", "Wang's homotopy, for P*-matrices, from any positive start.", WangHomotopy, bounds=True
        ),
        Registered(
            "yu", "Yu", "Yu's homotopy, for positive semidefinite A, from any positive start.", YuHomotopy,
            bounds=True,
        ),
        Registered(
            "xu", "Xu", "Xu's homotopy, for P-matrices, from a strictly feasible start.", XuHomotopy, feasible=True
        ),
        Registered(
            "zhao", "Zhao", "Zhao's homotopy, for N-matrices, from a strictly feasible start.", ZhaoHomotopy,
            feasible=True, example=6,
        ),
        Registered(
            "kmm", "Kojima", "The central path of Kojima, Megiddo and Mizuno, from any positive start.",
            KojimaMegiddoMizunoHomotopy, bounds=True,
        ),
    )
}  # fmt: skip
"""A test compares these with the entry points."""
