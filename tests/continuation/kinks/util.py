"""Maps of pieces, and piecewise linear ones with exact answers: A u + b + sum_j c_j |g_j u + d_j|, of integers."""

from fractions import Fraction
from itertools import product

import attrs
import numpy as np

from continuation import from_functions

from ...exact import determinant


@attrs.frozen(eq=False)
class Joined:
    """A map of its pieces: `make(*signs)` gives the residual of one, `watched` the switches."""

    make: object
    watched: object
    at: tuple
    target: float | None = None
    slope: object = None

    @property
    def count(self):
        return len(self.switches(*self.start()))

    def start(self):
        return np.atleast_1d(np.array(self.at[0], dtype=float)), float(self.at[1])

    def switches(self, y, lam):
        return self.watched(y, lam)

    def piece(self, signs):
        jacobian = None if self.slope is None else self.slope(*map(int, signs))
        return from_functions(self.make(*map(int, signs)), jacobian, start=self.start())

    def residual(self, y, lam):
        signs = np.where(np.asarray(self.switches(y, lam)) >= 0.0, 1, -1)
        return self.make(*map(int, signs))(y, lam)


def whole(rows):
    """A matrix of integers."""
    return tuple(tuple(int(x) for x in row) for row in rows)


@attrs.frozen
class Folded:
    """The map: `A`, `C` (N rows), `G` (m rows) and `b`, `d` of integers; `at` is a point on its path."""

    A: tuple
    C: tuple
    G: tuple
    b: tuple
    d: tuple
    at: tuple
    target: float | None = None

    @classmethod
    def random(cls, generator, n, m, cone=False):
        """With a path through the origin's neighbour `at`; or a cone, every switch of which vanishes at 0."""
        A, C, G, d, at = (generator.integers(-3, 4, shape) for shape in ((n, n + 1), (n, m), (m, n + 1), m, n + 1))
        if cone:
            d, at = 0 * d, 0 * at
        b = -(A @ at + C @ np.abs(G @ at + d))
        return cls(whole(A), whole(C), whole(G), *(tuple(map(int, x)) for x in (b, d, at)))

    def start(self):
        return np.array(self.at[:-1], dtype=float), float(self.at[-1])

    def residual(self, y, lam):
        u = np.append(y, lam)
        return np.array(self.A) @ u + np.array(self.b) + np.array(self.C) @ np.abs(np.array(self.G) @ u + self.d)

    def switches(self, y, lam):
        G = np.array(self.G, dtype=float)
        return G[:, :-1] @ y + G[:, -1] * lam + np.array(self.d)

    def piece(self, signs):
        """(A + C S G) u + b + C S d."""
        CS = np.array(self.C) * signs
        H, b = np.array(self.A) + CS @ np.array(self.G) + 0.0, np.array(self.b) + CS @ np.array(self.d)
        return from_functions(
            lambda y, lam: H[:, :-1] @ y + H[:, -1] * lam + b,
            lambda y, lam: (H[:, :-1], H[:, -1]),
            start=self.start(),
        )

    # -- exactly ----------------------------------------------------------------------------------------------

    def kernel(self, signs):
        """The kernel of a piece as integers, by minors; all zero where it has more dimensions than one."""
        A, C, G = (np.array(x, dtype=object) for x in (self.A, self.C, self.G))
        H = A + (C * np.array(signs, dtype=object)) @ G
        n = len(H)
        return [(-1) ** k * determinant([[row[j] for j in range(n + 1) if j != k] for row in H]) for k in range(n + 1)]

    def values(self, u):
        """The switches at a point of fractions."""
        return [sum(g * x for g, x in zip(row, u)) + d for row, d in zip(self.G, self.d)]

    def slopes(self, v):
        """Their derivatives."""
        return [sum(g * x for g, x in zip(row, v)) for row in self.G]

    def rays(self, u):
        """All rays that leave a point, each with the signs of a piece that it lies in; None where they are no lines."""
        values, found = self.values(u), {}
        for signs in product((1, -1), repeat=len(values)):
            if any(value * sign < 0 for value, sign in zip(values, signs)):
                continue
            v = self.kernel(signs)
            if not any(v):
                return None
            for w in (v, [-x for x in v]):
                if all(value or slope * sign >= 0 for value, slope, sign in zip(values, self.slopes(w), signs)):
                    size = sum(abs(x) for x in w)
                    found.setdefault(tuple(Fraction(x, size) for x in w), signs)
        return found
