"""Residuals in SymPy, compiled with their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from continuation.adapters.given import Adapted, library, matrix_of, started
from continuation.arguments.checks import complain
from continuation.arrays import Array, Matrix
from continuation.evaluation.pattern import pattern_of


def from_sympy(
    expressions: Sequence[Any], unknowns: Sequence[Any], parameter: Any, start: tuple[Any, float],
    *, target: float | None = 0.0,
) -> Adapted:  # fmt: skip
    """Make a homotopy of SymPy expressions, with a symbolic derivative; symbols are real.

    SERIES uses `continuation.jets`; special functions have their series through points of the path.

    Parameters
    ----------
    expressions : sequence of sympy.Expr
        N of them, to vanish.
    unknowns : sequence of sympy.Symbol
        N of them.
    parameter : sympy.Symbol
    start : tuple
    target : float or None
        As of `continuation.from_functions`.

    Raises
    ------
    TypeError, ValueError
        If numbers of unknowns, expressions and y0 differ, or an expression has other symbols.
    ImportError
        If SymPy is not installed.
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
    again = partial(from_sympy, start=start, target=target), (rows, symbols, parameter)
    # |x| of a complex symbol has no derivative.
    real = [sp.Dummy(str(symbol), real=True) for symbol in (*symbols, parameter)]
    rows = [one.xreplace(dict(zip((*symbols, parameter), real))) for one in rows]
    place = {symbol: j for j, symbol in enumerate(real[:-1])}
    places = [(i, place[s]) for i, one in enumerate(rows) for s in one.free_symbols if s != real[-1]]
    pattern = pattern_of([i for i, _ in places], [j for _, j in places], n)
    entries = [_slope(sp, rows[i], real[j]) for i, j in zip(pattern.rows, pattern.columns)]
    compiled = partial(sp.lambdify, real, modules=["scipy", "numpy"], cse=True)
    value, slope = compiled(rows), compiled([*entries, *(_slope(sp, one, real[-1]) for one in rows)])

    def residual(y: Any, lam: Any) -> Any:
        # 0 * lam makes constant equations arrays or jets.
        return np.stack([part + 0.0 * lam for part in value(*y, lam)])

    def jacobian(y: Array, lam: float) -> tuple[Matrix, Array]:
        found = np.array(slope(*y, lam), dtype=float)
        return matrix_of(pattern, found[: pattern.rows.size]), found[pattern.rows.size :]

    return Adapted(residual, y0, lam0, target, more={"jacobian": jacobian}, again=again)


def _slope(sp: Any, one: Any, x: Any) -> Any:
    return sp.diff(one, x).replace(sp.DiracDelta, lambda *_: sp.Integer(0))
