"""Families with known curves: a second parameter is an attribute of each."""

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

import continuation
from continuation.linear import Banded, Operator, Symmetric


@frozen
class CuspForm:
    """lam + mu y - y^3: folds where 27 lam^2 = 4 mu^3."""

    mu: float = 1.0
    target = None

    def start(self):
        return np.array([-2.0]), -8.0 + 2.0 * self.mu

    def residual(self, y, lam):
        return lam + self.mu * y - y**3


@frozen
class Imperfect:
    """The pitchfork lam y - y^3 + eps: folds at 27 eps^2 = 4 lam^3, through the pitchfork itself at eps = 0."""

    eps: float = 0.1
    target = None

    def start(self):
        return np.array([-2.0]), 4.05

    def residual(self, y, lam):
        return lam * y - y**3 + self.eps


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

    def wing(self, r):
        """An equilibrium that is not the origin."""
        x = np.sqrt(self.b * (r - 1.0))
        return np.array([x, x, r - 1.0]), r


@frozen
class Brusselator:
    """Continued in B: Hopf points at B = 1 + A^2, frequency A."""

    A: float = 1.0
    target = None

    def start(self):
        return np.array([self.A, 1.0 / self.A]), 1.0

    def residual(self, y, lam):
        x, z = y[0], y[1]
        return np.stack([self.A - (lam + 1.0) * x + x * x * z, lam * x - x * x * z])


@frozen
class VanDerPol:
    """x'' = lam (1 - x^2) x' - k x: Hopf points at lam = 0, frequency the root of k."""

    k: float = 1.0
    target = None

    def start(self):
        return np.zeros(2), -1.0

    def residual(self, y, lam):
        return np.stack([y[1], lam * (1.0 - y[0] * y[0]) * y[1] - self.k * y[0]])


@frozen
class TakensBogdanov:
    """The normal form: folds at lam = 0, Hopf points at lam = -mu^2 with frequency (2 mu)^(1/2); both meet at 0."""

    mu: float = 1.0
    target = None

    def start(self):
        return np.array([-2.0, 0.0]), -4.0

    def residual(self, y, lam):
        return np.stack([y[1], lam + self.mu * y[1] + y[0] ** 2 + y[0] * y[1]])


@frozen
class ZeroHopf:
    """Folds at lam = 0, Hopf points where lam = mu^2 with frequency 2: they meet at mu = 0."""

    mu: float = 1.0
    target = None

    def start(self):
        return np.array([2.0, 0.0, 0.0]), 4.0

    def residual(self, y, lam):
        growth = self.mu + y[0]
        return np.stack([lam - y[0] ** 2, growth * y[1] - 2.0 * y[2], 2.0 * y[1] + growth * y[2]])


@frozen
class Coupled:
    """Two pitchforks, coupled: from the branch y_1 = -y_2 another one leaves at lam = 3 mu, where y_1^2 = mu."""

    mu: float = 1.0
    target = None

    def start(self):
        return np.array([2.0, -2.0]), 4.0 + 2.0 * self.mu

    def residual(self, y, lam):
        return lam * y - y**3 + self.mu * (y[::-1] - y)


@frozen
class CoupledSparse:
    """The same with a sparse derivative."""

    mu: float = 1.0
    target = None

    def start(self):
        return Coupled(self.mu).start()

    def residual(self, y, lam):
        return Coupled(self.mu).residual(y, lam)

    def jacobian(self, y, lam):
        return sp.csc_array(np.diag(lam - 3.0 * y**2 - self.mu) + self.mu * np.eye(2)[::-1]), y.copy()


@frozen
class Ring:
    """y_0^2 / a + y_1^2 + lam^2 = 1, y_1 = a lam y_0: where y_1 is largest moves with a."""

    a: float = 1.0
    target = None

    def start(self):
        return np.array([np.sqrt(self.a), 0.0]), 0.0

    def residual(self, y, lam):
        return np.stack([y[0] ** 2 / self.a + lam**2 + y[1] ** 2 - 1.0, y[1] - self.a * lam * y[0]])


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
        return continuation.from_functions(
            lambda y, lam: y - 2.0 * lam + slope * self.switches(y, lam)[:1], start=self.start(), target=None
        )


def second_derivative(n):
    """Of even functions on (-1, 1) that vanish at the ends, at the Chebyshev points of (0, 1]: shape (n, n)."""
    k = np.arange(2 * n + 1)
    x = np.cos(np.pi * k / (2 * n))
    c = np.where(k % (2 * n) == 0, 2.0, 1.0) * (-1.0) ** k
    D = np.outer(c, 1.0 / c) / (x[:, None] - x[None, :] + np.eye(k.size))
    D -= np.diag(D.sum(axis=1))
    whole = D @ D
    even = whole[1 : n + 1, 1 : n + 1].copy()
    even[:, :-1] += whole[1 : n + 1, :n:-1][:, 1:]
    return even


@frozen(eq=False)
class Gelfand:
    """u'' + lam exp(u / (1 + eps u)) = 0, u(-1) = u(1) = 0, by collocation: u(0) is the last unknown."""

    eps: float = 0.2
    n: int = 16
    target = None
    D2: np.ndarray | None = field(default=None, repr=False)

    def __attrs_post_init__(self):
        if self.D2 is None:
            object.__setattr__(self, "D2", second_derivative(self.n))

    def start(self):
        return np.zeros(self.n), 0.0

    def residual(self, y, lam):
        return self.D2 @ y + lam * np.exp(y / (1.0 + self.eps * y))


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
            "symmetric": lambda: Symmetric(matrix.toarray()),
            "operator": lambda: Operator(matrix.toarray(), np.linalg.inv(matrix.toarray())),
        }
        return made[self.kind](), slope


@frozen
class Diffusing:
    """The Brusselator with diffusion (d, 2 d) between fixed ends, sparse, continued in B.

    Its first Hopf point is at B = 1 + A^2 + 3 d k, with k the least eigenvalue of minus the second difference.
    """

    A: float = 1.0
    n: int = 20
    d: float = 0.01
    target = None

    @property
    def hopf(self):
        """(B, frequency)."""
        k = self.d * (2.0 * (self.n + 1) * np.sin(0.5 * np.pi / (self.n + 1))) ** 2
        B = 1.0 + self.A**2 + 3.0 * k
        return B, np.sqrt((B - 1.0 - k) * (-(self.A**2) - 2.0 * k) + self.A**2 * B)

    def start(self):
        return np.tile([self.A, 1.0 / self.A], self.n), 1.0

    def at(self, B):
        """The equilibrium without a pattern."""
        return np.tile([self.A, B / self.A], self.n), B

    def residual(self, y, lam):
        x, z, k = y[0::2], y[1::2], self.d * (self.n + 1) ** 2

        def curved(w, end):
            w = np.concatenate((np.full(1, end), w, np.full(1, end)))
            return w[:-2] - 2.0 * w[1:-1] + w[2:]

        f = self.A - (lam + 1.0) * x + x * x * z + k * curved(x, self.A)
        g = lam * x - x * x * z + 2.0 * k * curved(z, lam / self.A)
        return np.stack([f, g], axis=1).ravel()

    def jacobian(self, y, lam):
        x, z, k = y[0::2], y[1::2], self.d * (self.n + 1) ** 2
        middle = np.stack([-(lam + 1.0) + 2.0 * x * z - 2.0 * k, -x * x - 4.0 * k], axis=1).ravel()
        above, below = np.zeros((2, 2 * self.n - 1))
        above[0::2], below[0::2] = x * x, lam - 2.0 * x * z
        aside = np.tile([k, 2.0 * k], self.n - 1)
        matrix = sp.diags_array([aside, below, middle, above, aside], offsets=[-2, -1, 0, 1, 2], format="csc")
        slope = np.stack([-x, x], axis=1)
        slope[[0, -1], 1] += 2.0 * k / self.A
        return matrix, slope.ravel()


@frozen(eq=False)
class Rescaled:
    """A member of a family in other units: y by the factors d, lam by a, the equations by e."""

    family: object
    d: np.ndarray
    e: np.ndarray
    a: float
    mu: float
    target = None

    def start(self):
        y, lam = self.family(self.mu).start()
        return y * self.d, lam / self.a

    def residual(self, y, lam):
        return self.e * self.family(self.mu).residual(y / self.d, self.a * lam)


def first_fold(homotopy, **options):
    """The first turning point of a path."""
    path = continuation.trace(homotopy, events=[continuation.TurningPoint(terminal=1)], **options)
    return path.turning_points[0]


def named(path, name):
    """The events of this name."""
    return [event for event in path.events if event.name == name]
