"""A residual in SymPy: its expressions and their derivatives, compiled to numpy with common parts once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from attrs import frozen

from continuation.adapters.given import filled, library, started
from continuation.arguments.checks import complain
from continuation.arrays import Array, Matrix
from continuation.evaluation.pattern import Pattern, pattern_of


@frozen(eq=False)
class SympyHomotopy:
    """A homotopy of expressions of SymPy; see `from_sympy`."""

    given: tuple[Any, ...]
    """Expressions, unknowns, parameter: what the rest is made of."""
    values: Callable[..., Any]
    slopes: Callable[..., Any]
    """Entries of H_y in the order of the pattern, then H_lam."""
    pattern: Pattern
    y0: Array
    lam0: float
    target: float | None

    def __reduce__(self) -> Any:
        return partial(from_sympy, start=(self.y0, self.lam0), target=self.target), self.given

    def start(self) -> tuple[Array, float]:
        """The given start."""
        return self.y0.copy(), self.lam0

    def residual(self, y: Any, lam: Any) -> Any:
        """H, of numbers or jets."""
        # What is added makes arrays, or jets, of equations that are constant.
        return np.stack([value + 0.0 * lam for value in self.values(*y, lam)])

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam): dense, `Banded` or sparse, as it is."""
        found = np.array(self.slopes(*y, lam), dtype=float)
        size = self.pattern.rows.size
        return filled(self.pattern, found[:size]), found[size:]


def from_sympy(
    expressions: Sequence[Any], unknowns: Sequence[Any], parameter: Any, start: tuple[Any, float],
    *, target: float | None = 0.0,
) -> SympyHomotopy:  # fmt: skip
    """Make a homotopy of expressions of SymPy.

    Its derivative is symbolic; SERIES expands the compiled expressions by `continuation.jets`.

    Parameters
    ----------
    expressions : sequence of sympy.Expr
        N of them, to vanish.
    unknowns : sequence of sympy.Symbol
        N of them.
    parameter : sympy.Symbol
        The parameter.
    start : tuple
    target : float or None
        As of `continuation.from_functions`.

    Raises
    ------
    TypeError, ValueError
        If the numbers of unknowns, expressions and y0 differ, or an expression has other symbols.
    ImportError
        Without SymPy.
    """
    sp = library("sympy")
    y0, lam0 = started(start)
    rows, symbols = [sp.sympify(one) for one in expressions], list(unknowns)
    n = len(symbols)
    if not len(rows) == n == y0.size:
        raise ValueError(f"expressions: expected as many as unknowns and numbers y0, found {len(rows)}, {n}, {y0.size}")
    others = set().union(*(one.free_symbols for one in rows)) - {*symbols, parameter}
    if others:
        wanted = "no symbols but the unknowns and the parameter"
        raise complain(ValueError, "expressions", wanted, sorted(map(str, others)))
    place = {symbol: j for j, symbol in enumerate(symbols)}
    places = [(i, place[s]) for i, one in enumerate(rows) for s in one.free_symbols if s != parameter]
    pattern = pattern_of([i for i, _ in places], [j for _, j in places], n)
    entries = [sp.diff(rows[i], symbols[j]) for i, j in zip(pattern.rows, pattern.columns)]
    compiled = partial(sp.lambdify, [*symbols, parameter], modules="numpy", cse=True)
    return SympyHomotopy(
        (rows, symbols, parameter), compiled(rows), compiled([*entries, *(sp.diff(one, parameter) for one in rows)]),
        pattern, y0, lam0, target,
    )  # fmt: skip
