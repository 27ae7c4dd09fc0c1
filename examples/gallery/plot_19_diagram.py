"""
All branches, and what is stable
================================

u'' + lambda (u - u^3) = 0 on an interval, zero at both ends: five branches leave the trivial one up to lambda = 30. For
the flow u_t = u_xx + lambda (u - u^3) only the first is stable. The Brusselator beside it loses its stability at a Hopf
point, and oscillates from there on.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation


class ChafeeInfante:
    """Second differences on n points."""

    n = 39

    def start(self):
        return np.zeros(self.n), 0.2

    def residual(self, y, lam):
        h = np.pi / (self.n + 1)
        return np.diff(np.concatenate(([0.0], y, [0.0])), 2) / h**2 + lam * (y - y**3)


def brusselator(y, B):
    made = y[0] ** 2 * y[1]
    return np.stack([1.0 - (B + 1.0) * y[0] + made, B * y[0] - made])


def lopsided(y, lam):
    """A weighted mean, so that a branch and its mirror image are two."""
    return float(y @ np.linspace(1.0, 2.0, y.size)) / y.size


found = continuation.diagram(ChafeeInfante(), box={"lam": (0.0, 30.0)}, stability=continuation.Stability())
print(found, found.message)

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
found.plot(left, value=lopsided)
left.set_ylabel("weighted mean of $u$")
oscillator = continuation.from_functions(brusselator, start=([1.0, 0.5], 0.5), target=3.5)
path = continuation.trace(oscillator, observers=[continuation.Stability()])
path.plot(right, value=1)
(hopf,) = path.events
print(f"{hopf.name} at B = {hopf.lam:.10f}, frequency {hopf.observed['frequency']:.10f}")
