"""What the tests of theorems have in common."""

import numpy as np


def powers(rng, n, largest):
    """Units that are powers of two."""
    return 2.0 ** rng.integers(-largest, largest + 1, n)


def x_at_end(problem, path):
    return np.maximum(path.endpoint.y[: problem.n], 0.0)
