"""Named homotopies that need a factory: LCP homotopies and Brown's function."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from continuation.arguments.checks import expect
from continuation.arrays import Array
from problems.lcp.data.files import read_problem
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program
from problems.lcp.homotopies.registry import HOMOTOPIES, LCPHomotopy, Registered
from problems.nonlinear import FixedPointHomotopy, brown


def brown_fixed_point(n: int = 5) -> FixedPointHomotopy:
    """Brown's almost linear function by the fixed-point homotopy from the origin.

    Parameters
    ----------
    n : int
        Equations.
    """
    F = brown(n)
    return FixedPointHomotopy(F, np.zeros(n), F.jacobian)


def _plugin(homotopy: Registered) -> Callable[..., LCPHomotopy]:
    def make(example: int = homotopy.example, file: str = "", q: str = "") -> LCPHomotopy:
        problem, x0 = _problem(example, file, q)
        return homotopy.make(problem, x0)

    make.__name__ = make.__qualname__ = homotopy.name
    make.__doc__ = f"""{homotopy.sentence}

    Parameters
    ----------
    example : int
        1 to 10, of the paper, from the paper's start; not used where a file is given.
    file, q : str
        As for ``continuation solve``.
    """
    return make


globals().update({name: _plugin(homotopy) for name, homotopy in HOMOTOPIES.items()})


def _problem(number: int, file: str, q: str) -> tuple[MixedLCP, Array | None]:
    if file:
        try:
            read = read_problem(file, q or None)
        except ValueError as error:
            # The reader's parameter is `path`.
            raise ValueError(str(error).replace("path:", "file:", 1)) from error
        return read.problem if isinstance(read, Program) else read, None
    from problems.paper import EXAMPLES

    expect(number in range(1, len(EXAMPLES) + 1), "example", f"a number from 1 to {len(EXAMPLES)}", number)
    example = EXAMPLES[number - 1]
    return example.problem, example.x0
