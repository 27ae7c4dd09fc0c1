"""What the tests of theorems have in common."""

import numpy as np
from hypothesis import settings


def share(examples):
    """So many examples in the default profile, a hundred times as many in the nightly one."""
    return settings(max_examples=settings.default.max_examples * examples // 100)


def powers(rng, n, largest):
    """Units that are powers of two."""
    return 2.0 ** rng.integers(-largest, largest + 1, n)


def x_at_end(problem, path):
    return np.maximum(path.endpoint.y[: problem.n], 0.0)
