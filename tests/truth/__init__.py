"""What is known exactly about each path: curves and turning points, for tests.

One module a problem. Points are rows (y_1, ..., y_N, lam).
"""

from tests.truth import aircraft, bratu, exponential_cosine

__all__ = ["aircraft", "bratu", "exponential_cosine"]
