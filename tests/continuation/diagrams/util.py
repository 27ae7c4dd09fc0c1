"""Diagrams that are known: the cubic equation on an interval, and pitchforks on a trunk."""

import numpy as np
from attrs import define

from continuation import from_functions
from continuation.linear import Banded

from ..kinks.util import Folded

# |lam| - |y| = 0: from the lower left one branch, and the two others from the kink in the middle.
CROSSED = Folded(((0, 0),), ((1, -1),), ((1, 0), (0, 1)), (0,), (0, 0), (-1, 1))


def chafee_infante(n):
    """u'' + lam (u - u^3) = 0 on (0, pi), zero at both ends, second differences; and where branches leave u = 0."""
    h = np.pi / (n + 1)

    def jacobian(y, lam):
        bands = np.full((3, n), h**-2)
        bands[1] = -2.0 * h**-2 + lam * (1.0 - 3.0 * y * y)
        return Banded(bands, 1, 1), y - y**3

    homotopy = from_functions(
        lambda y, lam: np.diff(np.concatenate(([0.0], y, [0.0])), 2) / h**2 + lam * (y - y**3),
        jacobian,
        start=(np.zeros(n), 0.2),
    )
    return homotopy, 4.0 / h**2 * np.sin(0.5 * np.arange(1, 6) * h) ** 2


@define(eq=False)
class Forks:
    """Pitchforks on a trunk: (lam - k) y_k - y_k^3, or with |y|^2 y_k, so that no branch leaves an arm."""

    places: tuple[float, ...]
    coupled: bool = False

    def start(self):
        return np.zeros(len(self.places)), 0.5

    def residual(self, y, lam):
        return (lam - np.array(self.places)) * y - (y @ y if self.coupled else y * y) * y

    def jacobian(self, y, lam):
        own = lam - np.array(self.places)
        if self.coupled:
            return np.diag(own - y @ y) - 2.0 * np.outer(y, y), y.copy()
        return np.diag(own - 3.0 * y * y), y.copy()
