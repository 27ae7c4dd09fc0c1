"""A homotopy that does all right, and some that do one thing wrong."""

import math

import numpy as np

import continuation
from continuation.linear import factor_bordered
from continuation.metric import Relative

REFERENCE = "@misc{Nobody2026,\n  title = {On products and differences},\n}"


class Interior:
    """y1 y2 = lam, y1 - y2 = 1 from lam = 1 to lam = 0 through y > 0, with every capability there is."""

    target = 0.0
    metric = Relative()
    references = (REFERENCE,)
    events = (continuation.Monitor(lambda u, v: float(u[0] - 1.5), "y1 = 1.5"),)

    def start(self):
        return np.array([0.5 + math.sqrt(1.25), -0.5 + math.sqrt(1.25)]), 1.0

    def residual(self, y, lam):
        return np.stack([y[0] * y[1] - lam, y[0] - y[1] - 1.0 + 0.0 * lam])

    def jacobian(self, y, lam):
        return np.array([[y[1], y[0]], [1.0, -1.0]]), np.array([-1.0, 0.0])

    def differential(self, y, lam, v):
        H_y, H_lam = self.jacobian(y, lam)
        return H_y @ v[:-1] + H_lam * v[-1]

    def bordered(self, y, lam, border):
        return factor_bordered(*self.jacobian(y, lam), border)

    def taylor(self, point, order):
        c = np.zeros((order + 1, 3))
        c[0], c[1] = point.u, point.tangent
        for k in range(2, order + 1):
            c[k] = point.solve(np.array([-float(c[1:k, 0] @ c[k - 1 : 0 : -1, 1]), 0.0]))
        return c

    def max_step(self, u, v):
        falling = v[:2] < 0.0
        return float((u[:2][falling] / -v[:2][falling]).min()) if falling.any() else math.inf

    def observe(self, y, lam):
        return {"gap": float(y[0] * y[1])}

    def finish(self, y, lam):
        return None


def interior(**methods):
    """An `Interior` with methods replaced: the class is made anew, so that pickle and archive cannot name it."""
    return type("Faulty", (Interior,), methods)()


class NoSolution:
    """y^2 + lam^2 + 1 = 0."""

    def start(self):
        return np.array([0.3]), 1.0

    def residual(self, y, lam):
        return y**2 + lam**2 + 1.0


class WrongSeries(Interior):
    def taylor(self, point, order):
        c = super().taylor(point, order)
        c[3] *= 1.01
        return c
