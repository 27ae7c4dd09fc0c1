"""BLAS on one thread while a path is traced or an LCP is solved.

numpy and scipy each bring an OpenBLAS with a pool of threads of its own. After a call the threads of one pool spin for
a while, on the cores that the other pool is about to use; a library that calls both in turn loses by that. Measured on
two idle cores, two threads in place of one take 1.0 to 6 times as long (`lcp.solve` with a positive definite matrix,
n = 50 to 4,000; dense paths, n = 50 to 2,400); on two busy cores up to 400 times. Where OPENBLAS_NUM_THREADS or
OMP_NUM_THREADS is set, the user has chosen, and nothing is changed.
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
"""What OpenBLAS calls its functions in the wheels of numpy and of scipy, and in other distributions."""


@cache
def _pools() -> tuple[tuple[Callable[[], int], Callable[[int], object]], ...]:
    """Functions that get and set the number of threads of each OpenBLAS; none for another BLAS, or a user's choice."""
    found = []
    if not any(name in os.environ for name in CHOSEN):
        for module in (_umath_linalg, _fblas):
            # A symbol is looked for in what the module was linked with, too.
            library = ctypes.CDLL(module.__file__)
            name = next((name for name in SYMBOLS if hasattr(library, name.format("set"))), None)
            if name is not None:
                found.append((getattr(library, name.format("get")), getattr(library, name.format("set"))))
    return tuple(found)


class _OneThread(ContextDecorator):
    """BLAS uses one thread within; the numbers of before come back when the last of those inside has left.

    The number is the process's own, so there is one counter for it: it costs 2 us where nobody else is inside.
    """

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
"""``with one_thread:``, or a decorator of a function."""
