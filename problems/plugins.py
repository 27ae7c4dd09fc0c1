"""What is registered under a name where a class alone will not do: the homotopies of an LCP, and Brown's function."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array
from problems.lcp.data.files import read_problem
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies import (
    KKTHomotopy,
    KojimaMegiddoMizunoHomotopy,
    TwoVectorHomotopy,
    WangHomotopy,
    XuHomotopy,
    YuHomotopy,
    ZhaoHomotopy,
)
from problems.nonlinear import Differentiable, FixedPointHomotopy, brown


def brown_fixed_point(n: int = 5) -> Differentiable[FixedPointHomotopy]:
    """Brown's almost linear function by the fixed-point homotopy from the origin.

    Parameters
    ----------
    n : int
        Number of equations and unknowns.
    """
    F = brown(n)
    return Differentiable(FixedPointHomotopy(F, np.zeros(n)), F.jacobian)


def kkt(example: int = 2, file: str = "", q: str = "") -> KKTHomotopy:
    """The KKT homotopy of Dutta, Das and Jana for an LCP: from the paper's start, or a default start for a file.

    Parameters
    ----------
    example : int
        1 to 10, of the paper; not used where a file is given.
    file, q : str
        As for ``continuation solve``.
    """
    problem, x0 = _problem(example, file, q)
    return KKTHomotopy(problem, x0)


def wang(example: int = 2, file: str = "", q: str = "") -> TwoVectorHomotopy:
    """Wang's homotopy for an LCP, from x = e; options as for kkt."""
    return WangHomotopy(_problem(example, file, q)[0])


def yu(example: int = 2, file: str = "", q: str = "") -> TwoVectorHomotopy:
    """Yu's homotopy for an LCP; options as for kkt."""
    return YuHomotopy(*_problem(example, file, q))


def zhao(example: int = 6, file: str = "", q: str = "") -> TwoVectorHomotopy:
    """Zhao's homotopy for an LCP, from a strictly feasible start; options as for kkt."""
    return ZhaoHomotopy(*_problem(example, file, q))


def xu(example: int = 2, file: str = "", q: str = "") -> TwoVectorHomotopy:
    """Xu's homotopy for an LCP, from a strictly feasible start; options as for kkt."""
    return XuHomotopy(*_problem(example, file, q))


def kmm(example: int = 2, file: str = "", q: str = "") -> TwoVectorHomotopy:
    """The homotopy of Kojima, Megiddo and Mizuno for an LCP, from x = e; options as for kkt."""
    return KojimaMegiddoMizunoHomotopy(_problem(example, file, q)[0])


def _problem(number: int, file: str, q: str) -> tuple[LCP, Array | None]:
    """The LCP of a file, or one of the paper's with its start."""
    if file:
        try:
            return read_problem(file, q or None), None
        except ValueError as error:
            # The reader speaks of its own parameter, `path`.
            raise ValueError(str(error).replace("path:", "file:", 1)) from error
    from problems.paper import EXAMPLES

    if number not in range(1, len(EXAMPLES) + 1):
        raise ValueError(f"example: expected a number from 1 to {len(EXAMPLES)}, found {number!r}")
    example = EXAMPLES[number - 1]
    return example.problem, example.x0
