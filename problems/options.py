"""Option checks of the problems, and silent overflow."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from numbers import Integral, Real
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs.validators import optional

from continuation.arguments.checks import FINITE, Validator, expect, integer, is_number
from continuation.arrays import Array, Mask, Matrix
from continuation.arrays import finite as finite_sum
from continuation.budget import Budget
from continuation.linear.silence import without_warnings

quiet = without_warnings(over="ignore", invalid="ignore")
"""Decorator: overflow gives inf or nan without warnings."""


positive_integer = integer(1)
finite = FINITE
finite_or_none: Validator = optional(FINITE)
"""None means no target."""


def check_tolerance(value: Any) -> None:
    """Require 0 < tolerance < 1, else ValueError."""
    expect(is_number(value) and 0.0 < value < 1.0, "tolerance", "a number between 0 and 1", value)


def check_seed(value: Any) -> None:
    """Require an integer seed >= 0, else ValueError."""
    fine = isinstance(value, Integral) and not isinstance(value, bool) and int(value) >= 0
    expect(fine, "seed", "an integer, at least 0", value)


def check_budget(value: Any) -> None:
    """Require a Budget or None, else TypeError."""
    expect(value is None or isinstance(value, Budget), "budget", "a Budget", value, TypeError)


REAL = (Real, Decimal, np.bool_)
"""Types of real entries of object arrays."""


def real_array(name: str, value: Any) -> Array:
    """Copy `value` to a float array, or keep a read-only one that owns its row-major floats.

    Raises `ValueError` for complex numbers, dates, text, masked entries, ragged rows, numbers beyond 1e308.
    """
    if type(value) is np.ndarray and value.dtype == float:
        own = value.base is None and value.flags.c_contiguous and not value.flags.writeable
        kept: Array = value if own else np.array(value, order="C")
        return kept
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{name}: expected real numbers, found a masked array with masked entries; fill them first")
    try:
        # MATLAB matrices come by columns.
        array = np.array(value, order="C")
        entries = array.flat if array.dtype == object else ()
        if array.dtype.kind not in "fiubO" or not all(isinstance(entry, REAL) for entry in entries):
            raise TypeError(f"dtype {array.dtype}")
        with np.errstate(over="ignore"):
            numbers: Array = array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError) as error:
        found = f"found {type(value).__name__} ({' '.join(str(error).split())[:100]})"
        raise ValueError(f"{name}: expected real numbers, {found}") from None
    if array.dtype.itemsize > numbers.itemsize and np.any(np.isinf(numbers) & np.isfinite(array)):
        raise ValueError(f"{name}: expected numbers below 1.8e308 in size, found larger ones")
    return numbers


def sound_sparse(name: str, value: Any) -> Any:
    """Convert a sparse matrix to float CSR; bad indices would corrupt memory.

    Duplicates add up. Raises `ValueError` for non-real numbers or indices outside the shape.
    """
    expect(value.dtype.kind in "fiub", name, "real numbers", value.dtype)
    expect(value.ndim == 2, name, "a matrix", value.shape)
    try:
        if value.format in ("csr", "csc", "bsr"):
            # scipy narrows the checked object's indices.
            type(value)((value.data, value.indices, value.indptr), shape=value.shape).check_format(full_check=True)
        elif value.format == "coo":
            type(value)((value.data, (value.row, value.col)), shape=value.shape)
        # Sums of small integers overflow.
        matrix = sp.csr_array(value.astype(float))
        matrix.check_format(full_check=True)
        matrix.sum_duplicates()
    except (ValueError, TypeError, IndexError, OverflowError, MemoryError) as error:
        reason = " ".join(str(error).split())[:160]
        raise ValueError(f"{name}: expected a sparse matrix whose indices fit its shape, found {reason}") from None
    return matrix


def expect_nowhere(wrong: Mask, name: str, expected: str, found: Callable[[int], str]) -> None:
    """Raise ValueError with what is found at the first index, if any, where numbers are wrong."""
    if wrong.any():
        raise ValueError(f"{name}: expected {expected}, found {found(int(np.argmax(wrong)))}")


def check_finite(name: str, value: Any) -> None:
    """Raise ValueError naming the first nonfinite entry."""
    entries = value if isinstance(value, np.ndarray) else value.data
    # Finite numbers may have an infinite sum.
    if entries.size == 0 or finite_sum(entries.ravel()) or np.isfinite(entries).all():
        return
    at = np.argwhere(~np.isfinite(entries))[0]
    if sp.issparse(value):
        value = value.tocoo()
        at = np.array([value.coords[0][at[0]], value.coords[1][at[0]]])
    index = int(at[0]) if at.size == 1 else tuple(map(int, at))
    raise ValueError(f"{name}: expected finite numbers, found {entries[~np.isfinite(entries)][0]} at index {index}")


def finite_matrix(name: str, value: Any) -> Matrix:
    """Copy `value` to an array of finite floats, or a CSR matrix if it is sparse, or raise ValueError."""
    matrix = sound_sparse(name, value) if sp.issparse(value) else real_array(name, value)
    check_finite(name, matrix)
    return matrix


def finite_vector(name: str, value: Any, size: int | None = None) -> Array:
    """Copy `value` to a vector of finite floats (of length `size`), or raise ValueError."""
    vector = real_array(name, value)
    kind = np.asarray(value).dtype
    if kind.kind == "b" or vector.ndim != 1 or vector.size == 0:
        raise ValueError(f"{name}: expected a vector of real numbers, found shape {vector.shape}, dtype {kind}")
    expect(size is None or vector.size == size, name, f"{size} numbers", vector.size)
    check_finite(name, vector)
    return vector
