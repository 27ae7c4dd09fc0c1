"""What is known exactly about each path: curves, turning points and lengths, for tests and charts.

One module a problem. Points are rows (y_1, ..., y_N, lam).
"""

from tests.truth import aircraft, bratu, circle, cusp, exponential_cosine, freudenstein_roth, pitchfork

__all__ = ["aircraft", "bratu", "circle", "cusp", "exponential_cosine", "freudenstein_roth", "pitchfork"]
