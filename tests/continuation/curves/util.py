"""Families with known curves: functions of a second parameter, each with the start of one member."""

from functools import cache

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.polynomial.chebyshev import chebder, chebval

import continuation
from continuation import from_functions
from continuation.linear import Banded, Operator


def cusp_form(mu=1.0):
    """lam + mu y - y^3: folds where 27 lam^2 = 4 mu^3."""
    return from_functions(lambda y, lam: lam + mu * y - y**3, start=([-2.0], -6.0), target=None)


def imperfect(eps=0.1):
    """The pitchfork lam y - y^3 + eps: folds at 27 eps^2 = 4 lam^3, through the pitchfork itself at eps = 0."""
    return from_functions(lambda y, lam: lam * y - y**3 + eps, start=([-2.0], 4.05), target=None)


@frozen
class Lorenz:
    """Continued in r. Pitchfork at r = 1, Hopf points at r = sigma (sigma + b + 3) / (sigma - b - 1)."""

    sigma: float = 10.0
    b: float = 8.0 / 3.0
    target = None

    def start(self):
        return np.zeros(3), 0.5

    def residual(self, y, lam):
        return np.stack([self.sigma * (y[1] - y[0]), y[0] * (lam - y[2]) - y[1], y[0] * y[1] - self.b * y[2]])


def wing(r, b=8.0 / 3.0):
    """An equilibrium of Lorenz that is not the origin."""
    x = np.sqrt(b * (r - 1.0))
    return np.array([x, x, r - 1.0]), r


def brusselator(A=1.0):
    """Continued in B: Hopf points at B = 1 + A^2, frequency A."""
    return from_functions(
        lambda y, lam: np.stack([A - (lam + 1.0) * y[0] + y[0] ** 2 * y[1], lam * y[0] - y[0] ** 2 * y[1]]),
        start=([1.0, 1.0], 1.0),
        target=None,
    )


def van_der_pol(k=1.0):
    """x'' = lam (1 - x^2) x' - k x: Hopf points at lam = 0, frequency the root of k."""
    return from_functions(
        lambda y, lam: np.stack([y[1], lam * (1.0 - y[0] * y[0]) * y[1] - k * y[0]]),
        start=(np.zeros(2), -1.0),
        target=None,
    )


def takens_bogdanov(mu=1.0):
    """The normal form: folds at lam = 0, Hopf points at lam = -mu^2, frequency (2 mu)^(1/2); they meet at 0."""
    return from_functions(
        lambda y, lam: np.stack([y[1], lam + mu * y[1] + y[0] ** 2 + y[0] * y[1]]),
        start=([-2.0, 0.0], -4.0),
        target=None,
    )


def zero_hopf(mu=1.0):
    """Folds at lam = 0, Hopf points where lam = mu^2 with frequency 2: they meet at mu = 0."""
    return from_functions(
        lambda y, lam: np.stack([lam - y[0] ** 2, (mu + y[0]) * y[1] - 2.0 * y[2], 2.0 * y[1] + (mu + y[0]) * y[2]]),
        start=([2.0, 0.0, 0.0], 4.0),
        target=None,
    )


def coupled(mu=1.0, sparse=False):
    """Two pitchforks, coupled: from the branch y_1 = -y_2 another one leaves at lam = 3 mu, where y_1^2 = mu."""
    return from_functions(
        lambda y, lam: lam * y - y**3 + mu * (y[::-1] - y),
        (lambda y, lam: (sp.csc_array(np.diag(lam - 3.0 * y**2 - mu) + mu * np.eye(2)[::-1]), y.copy()))
        if sparse
        else None,
        start=([2.0, -2.0], 6.0),
        target=None,
    )


def ring(a=1.0):
    """y_0^2 / a + y_1^2 + lam^2 = 1, y_1 = a lam y_0: where y_1 is largest moves with a."""
    return from_functions(
        lambda y, lam: np.stack([y[0] ** 2 / a + lam**2 + y[1] ** 2 - 1.0, y[1] - a * lam * y[0]]),
        start=([1.0, 0.0], 0.0),
        target=None,
    )


def steep(u, v):
    """Where the slope is -0.4."""
    return v[0] + 0.4 * v[1]


@frozen
class Bent:
    """y = 2 lam inside a circle of radius mu^(1/2), another curve outside: kinks at 5 lam^2 = mu."""

    mu: float = 5.0
    target = None

    def start(self):
        return np.array([0.0]), 0.0

    def residual(self, y, lam):
        return y - 2.0 * lam + 0.3 * np.maximum(self.switches(y, lam)[:1], 0.0)

    def switches(self, y, lam):
        return np.stack([y[0] ** 2 + lam**2 - self.mu, lam + 0.5])

    def piece(self, signs):
        slope = 0.3 * (signs[0] > 0)
        return from_functions(
            lambda y, lam: y - 2.0 * lam + slope * self.switches(y, lam)[:1], start=self.start(), target=None
        )


@cache
def second_derivative(n):
    """Of even functions on (-1, 1) that vanish at the ends, at the Chebyshev points of (0, 1]: shape (n, n)."""
    x, coefficients = np.cos(0.5 * np.pi * np.arange(1, n + 1) / n), np.eye(2 * n + 1)[:, 2::2]
    # Of T_2 - 1, T_4 - 1, ..., and of their second derivatives.
    values, bends = chebval(x, coefficients) - 1.0, chebval(x, chebder(coefficients, 2))
    return np.linalg.solve(values, bends).T


def gelfand(eps=0.2, n=16):
    """u'' + lam exp(u / (1 + eps u)) = 0, u(-1) = u(1) = 0, by collocation: u(0) is the last unknown."""
    D2 = second_derivative(n)
    return from_functions(
        lambda y, lam: D2 @ y + lam * np.exp(y / (1.0 + eps * y)), start=(np.zeros(n), 0.0), target=None
    )


@frozen
class GelfandBanded:
    """The same by second-order differences, on all of the interval."""

    eps: float = 0.2
    n: int = 16
    kind: str = "banded"
    target = None

    @property
    def square(self):
        return (2.0 / (self.n + 1)) ** 2

    def start(self):
        return np.zeros(self.n), 0.0

    def residual(self, y, lam):
        u = np.concatenate((np.zeros(1), y, np.zeros(1)))
        return u[:-2] - 2.0 * y + u[2:] + self.square * lam * np.exp(y / (1.0 + self.eps * y))

    def jacobian(self, y, lam):
        slope = self.square * np.exp(y / (1.0 + self.eps * y))
        bands = np.ones((3, self.n))
        bands[1] = lam * slope / (1.0 + self.eps * y) ** 2 - 2.0
        matrix = Banded(bands, 1, 1)
        made = {
            "banded": lambda: matrix,
            "sparse": matrix.tosparse,
            "dense": matrix.toarray,
            "operator": lambda: Operator(matrix.toarray(), np.linalg.inv(matrix.toarray())),
        }
        return made[self.kind](), slope


@frozen
class Diffusing:
    """Two species on n points, (d - lam) z + turning, both ends held at 0: z = 0, and a Hopf point for each mode.

    At the mode's rate, with the frequency `turn`.
    """

    n: int = 20
    target: float = 2.5
    side: int = 1
    turn: float = 3.0

    def rate(self, mode):
        return 0.08 * (self.n + 1) ** 2 * np.sin(0.5 * mode * np.pi / (self.n + 1)) ** 2

    def start(self):
        return np.zeros(2 * self.n), 0.0

    def matrix(self, lam):
        laplacian = (self.n + 1) ** 2 * sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(self.n, self.n))
        grow, turn = 0.02 * laplacian + lam * sp.eye_array(self.n), self.turn * sp.eye_array(self.n)
        return self.side * sp.csc_array(sp.block_array([[grow, -turn], [turn, grow]]))

    def residual(self, y, lam):
        return self.matrix(lam) @ y - self.side * y**3

    def jacobian(self, y, lam):
        return sp.csc_array(self.matrix(lam) - self.side * sp.diags_array(3.0 * y * y)), self.side * y


def first_fold(homotopy, **options):
    """The first turning point of a path."""
    path = continuation.trace(homotopy, events=[continuation.TurningPoint(terminal=1)], **options)
    return path.turning_points[0]


def named(path, name):
    """The events of this name."""
    return [event for event in path.events if event.name == name]
