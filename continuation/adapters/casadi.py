"""Residuals in CasADi, with its sparse derivatives."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from continuation.adapters.given import Adapted, library, matrix_of, started
from continuation.arguments.checks import expect
from continuation.arrays import Array, Matrix
from continuation.evaluation.pattern import Pattern


def from_casadi(function: Any, start: tuple[Any, float], *, target: float | None = 0.0) -> Adapted:
    """Make a homotopy of a CasADi function.

    Parameters
    ----------
    function : casadi.Function
        Maps y, shape (N, 1), and a number lam to shape (N, 1).
    start : tuple
    target : float or None
        As of `continuation.from_functions`.

    Raises
    ------
    ImportError
        If CasADi is not installed.
    TypeError, ValueError
        If `function` does not fit.
    """
    ca = library("casadi")
    expect(isinstance(function, ca.Function), "function", "a casadi.Function of (y, lam)", function, TypeError)
    y0, lam0 = started(start)
    n = y0.size
    inputs = [function.size_in(k) for k in range(function.n_in())]
    outputs = [function.size_out(k) for k in range(function.n_out())]
    if inputs != [(n, 1), (1, 1)] or outputs != [(n, 1)]:
        raise ValueError(f"function: expected (({n}, 1), (1, 1)) -> ({n}, 1), found {inputs} -> {outputs}")
    y, lam = ca.MX.sym("y", n), ca.MX.sym("lam")
    r = function(y, lam)
    H_y = ca.jacobian(r, y)
    slope = ca.Function("slope", [y, lam], [H_y, ca.densify(ca.jacobian(r, lam))])
    rows, columns = (np.array(places, dtype=np.intp) for places in H_y.sparsity().get_triplet())
    pattern = Pattern(rows, columns, n)

    def residual(y: Array, lam: float) -> Array:
        return np.asarray(function(np.asarray(y, dtype=float), float(lam)).full()).ravel()

    def jacobian(y: Array, lam: float) -> tuple[Matrix, Array]:
        H_y, H_lam = slope(y, lam)
        return matrix_of(pattern, np.array(H_y.nonzeros())), np.asarray(H_lam.full()).ravel()

    again = partial(from_casadi, target=target), (function, start)
    return Adapted(residual, y0, lam0, target, more={"jacobian": jacobian}, again=again)
