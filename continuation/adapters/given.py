"""Shared parts of the adapters."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import expect, real_vector
from continuation.arrays import Array, Matrix
from continuation.evaluation.derivatives import SPARSE_FROM
from continuation.evaluation.functions import FunctionHomotopy
from continuation.evaluation.pattern import Pattern


@frozen(eq=False, slots=False)
class Adapted(FunctionHomotopy):
    """A homotopy by another library; see `from_jax`, `from_casadi` and `from_sympy`.

    `more`: further methods by name. `again`: a function and arguments that rebuild it from a pickle.
    """

    more: Mapping[str, Any] = field(kw_only=True)
    again: tuple[Any, ...] = field(kw_only=True)

    def __attrs_post_init__(self) -> None:
        for name, capability in self.more.items():
            object.__setattr__(self, name, capability)

    def __reduce__(self) -> Any:
        return self.again


def library(name: str) -> Any:
    """Import a library or one of its modules, or raise an ImportError that names the package."""
    try:
        return import_module(name)
    except ImportError as error:
        package = name.partition(".")[0]
        raise ImportError(f"{name} is needed for this: pip install 'pseudoarclength[{package}]' ({error})") from error


def started(start: Any) -> tuple[Array, float]:
    """The pair (y0, lam0) as numbers; TypeError or ValueError otherwise."""
    expect(isinstance(start, (tuple, list)) and len(start) == 2, "start", "a pair (y0, lam0)", start)
    lam0 = real_vector("start", start[1])
    expect(lam0.size == 1, "start", "a pair (y0, lam0) with one number lam0", start)
    return np.atleast_1d(real_vector("start", start[0])).astype(float), float(lam0.item())


def matrix_of(pattern: Pattern, entries: Array) -> Matrix:
    """The matrix with these entries: dense if small or a quarter full."""
    n = pattern.n
    if n >= SPARSE_FROM and 4 * entries.size <= n * n:
        return pattern.matrix(entries)
    matrix = np.zeros((n, n))
    matrix[pattern.rows, pattern.columns] = entries
    return matrix
