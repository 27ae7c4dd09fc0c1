"""BLAS on one thread while a path is traced or an LCP is solved.

The threads of numpy's and scipy's OpenBLAS spin on cores that the others need: two take 1 to 6 times as long as one on
two idle cores (n = 50 to 4,000), up to 400 times on busy ones. OPENBLAS_NUM_THREADS or OMP_NUM_THREADS override this.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from contextlib import ContextDecorator
from functools import cache
from threading import Lock

from numpy.linalg import _umath_linalg
from scipy.linalg import _fblas

CHOSEN = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")
SYMBOLS = ("scipy_openblas_{}_num_threads64_", "scipy_openblas_{}_num_threads", "openblas_{}_num_threads")


@cache
def _pools() -> tuple[tuple[Callable[[], int], Callable[[int], object]], ...]:
    found = []
    if not any(name in os.environ for name in CHOSEN):
        for module in (_umath_linalg, _fblas):
            library = ctypes.CDLL(module.__file__)
            name = next((name for name in SYMBOLS if hasattr(library, name.format("set"))), None)
            if name is not None:
                found.append((getattr(library, name.format("get")), getattr(library, name.format("set"))))
    return tuple(found)


class _OneThread(ContextDecorator):
    """BLAS uses one thread; the last to leave restores the counts (2 us)."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._inside = 0
        self._before: list[int] = []

    def __enter__(self) -> None:
        with self._lock:
            if self._inside == 0:
                self._before = [get() for get, _ in _pools()]
                for _, put in _pools():
                    put(1)
            self._inside += 1

    def __exit__(self, *error: object) -> None:
        with self._lock:
            self._inside -= 1
            if self._inside == 0:
                for (_, put), threads in zip(_pools(), self._before):
                    put(threads)


one_thread = _OneThread()
