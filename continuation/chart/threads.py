"""BLAS on a fixed number of threads while times are taken, and a record of what that was."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

VARIABLES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


@contextmanager
def pinned(threads: int = 1) -> Iterator[str]:
    """Limit BLAS to `threads` for the block; yields what is in force, as text.

    With threadpoolctl (the extra `chart`) the limit holds for any environment variables. Without it the number of
    threads cannot be changed, and the text has the environment variables.
    """
    try:
        from threadpoolctl import threadpool_info, threadpool_limits
    except ImportError:
        given = [f"{name}={os.environ[name]}" for name in VARIABLES if name in os.environ]
        yield f"not pinned (no threadpoolctl); {', '.join(given) or 'no environment variable set'}"
        return
    with threadpool_limits(threads):
        pools = {f"{pool['internal_api']} {pool['version']}: {pool['num_threads']}" for pool in threadpool_info()}
        yield f"pinned by threadpoolctl; {', '.join(sorted(pools))}"
