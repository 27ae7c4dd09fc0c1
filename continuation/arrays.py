"""The array types that the whole library speaks."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""A float64 array; shapes are named in the docstrings."""

Matrix: TypeAlias = Any
"""A dense (N, N) array, a scipy sparse array, a `continuation.linear.Banded`, or a LinearOperator."""
