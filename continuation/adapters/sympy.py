"""A residual in SymPy: its expressions and their derivatives, compiled to numpy and scipy with common parts once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial
from math import factorial
from typing import Any

import numpy as np
from attrs import frozen

from continuation.adapters.given import filled, library, started
from continuation.arguments.checks import complain
from continuation.arrays import Array, Matrix
from continuation.evaluation.pattern import Pattern, pattern_of
from continuation.jets import Jet

MODULES = ["scipy", "numpy"]


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

    Its derivative is symbolic; SERIES expands the compiled expressions by `continuation.jets`, special functions in
    them by their symbolic derivatives. Symbols are real numbers.

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
    given = rows, symbols, parameter
    # Of a symbol that may be complex |x| has no derivative.
    real = [sp.Dummy(str(symbol), real=True) for symbol in (*symbols, parameter)]
    rows = [one.xreplace(dict(zip((*symbols, parameter), real))) for one in rows]
    place = {symbol: j for j, symbol in enumerate(real[:-1])}
    places = [(i, place[s]) for i, one in enumerate(rows) for s in one.free_symbols if s != real[-1]]
    pattern = pattern_of([i for i, _ in places], [j for _, j in places], n)
    entries = [_slope(sp, rows[i], real[j]) for i, j in zip(pattern.rows, pattern.columns)]
    expanded: dict[str, Any] = {}

    def special(one: Any) -> bool:
        beyond = one.func.__module__.startswith("sympy.functions.special")
        return beyond and sum(bool(part.free_symbols) for part in one.args) == 1

    def renamed(one: Any) -> Any:
        name, x = f"series_{len(expanded)}", sp.Dummy(real=True)
        argument = next(part for part in one.args if part.free_symbols)
        expanded[name] = _by_derivatives(sp, one.xreplace({argument: x}), x)
        return sp.Function(name)(argument)

    values = [one.replace(special, renamed) for one in rows]
    compiled = partial(sp.lambdify, real, modules=[expanded, *MODULES], cse=True)
    slopes = [*entries, *(_slope(sp, one, real[-1]) for one in rows)]
    return SympyHomotopy(given, compiled(values), compiled(slopes), pattern, y0, lam0, target)


def _slope(sp: Any, one: Any, x: Any, order: int = 1) -> Any:
    """The derivative, at a jump that of either side."""
    return sp.diff(one, x, order).replace(sp.DiracDelta, lambda *_: sp.Integer(0))


def _by_derivatives(sp: Any, one: Any, x: Any) -> Callable[[Any], Any]:
    """A function of one number or jet, whose series comes from its derivatives."""

    @cache
    def derivative(k: int) -> Callable[[Any], Any]:
        found: Callable[[Any], Any] = sp.lambdify(x, _slope(sp, one, x, k), modules=MODULES)
        return found

    def value(u: Any) -> Any:
        if not isinstance(u, Jet):
            return derivative(0)(u)
        at, found = u.coefficient(0), 0.0 * u
        for k in range(u.order, -1, -1):
            found = found * (u - at) + derivative(k)(at) / factorial(k)
        return found

    return value
