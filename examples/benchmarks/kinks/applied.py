"""LCPs of applications: contact, prices, production, traffic, regression, classification."""

from collections.abc import Iterator

import numpy as np

from continuation.arrays import Array
from problems.scenes.planar import Body, Contact, free_motion, time_step
from problems.scenes.spatial_prices import trade

Data = tuple[Array, Array]


def _step(bodies: list[Body], contacts: list[Contact], mu: float, seed: int) -> Data:
    """One time step under gravity, from small velocities."""
    A, J, inverse = time_step(bodies, contacts, mu)
    force = np.concatenate([[0.0, -9.81 * m, 0.0] for m, _, _, _ in bodies])
    u = J @ (np.random.default_rng(seed).normal(0.0, 0.05, inverse.size) + 0.01 * inverse * force)
    return A, free_motion(u)


def boxes(seed: int) -> Iterator[Data]:
    """One box on 4 to 16 corners: more contacts than it has degrees of freedom."""
    for corners in (4, 8, 12, 16):
        contacts = [(0, -1, float(x), 0.0, 0.0, 1.0) for x in np.linspace(-0.5, 0.5, corners)]
        yield _step([(1.0, 1.0 / 6.0, 0.0, 0.5)], contacts, 0.5, seed)


def arches(seed: int) -> Iterator[Data]:
    """Stones of a half circle, each touching its neighbours, the ends the ground, at two points."""
    for stones in (5, 10, 15, 25):
        angles = (np.arange(stones) + 0.5) * np.pi / stones
        bodies = [(1.0, 0.1, 5.0 * np.cos(a), 5.0 * np.sin(a)) for a in angles]
        contacts = []
        for k in range(stones + 1):
            a = k * np.pi / stones
            normal = (-np.sin(a), np.cos(a)) if k < stones else (np.sin(a), -np.cos(a))
            body, other = (k, k - 1) if k < stones else (stones - 1, -1)
            contacts += [(body, other, r * np.cos(a), r * np.sin(a), *normal) for r in (4.5, 5.5)]
        yield _step(bodies, contacts, 0.7, seed)


def piles(seed: int) -> Iterator[Data]:
    """Boxes on each other, two corners each."""
    for number in (5, 10, 20, 40):
        bodies = [(1.0, 1.0 / 6.0, 0.0, k + 0.5) for k in range(number)]
        contacts = [(k, k - 1, side, float(k), 0.0, 1.0) for k in range(number) for side in (-0.5, 0.5)]
        yield _step(bodies, contacts, 0.5, seed)


def prices(seed: int) -> Iterator[Data]:
    """Spatial price equilibria (Samuelson, Takayama and Judge): goods go where the price pays for it."""
    r = np.random.default_rng(seed)
    for m in (5, 10, 15, 20):
        supply = r.uniform(1.0, 3.0, m), r.uniform(0.5, 1.5, m)
        demand = r.uniform(10.0, 20.0, m), r.uniform(0.5, 1.5, m)
        problem = trade(supply, demand, r.uniform(1.0, 10.0, (m, m)))
        yield problem.A, problem.q


def leontief(seed: int) -> Iterator[Data]:
    """Outputs that meet demand, x - P x - b >= 0, some of them without any."""
    r = np.random.default_rng(seed)
    for n in (50, 100, 300, 600):
        P = r.random((n, n)) * (r.random((n, n)) < 0.2)
        yield np.eye(n) - 0.9 * P / P.sum(axis=0), -r.normal(0.3, 1.0, n)


def traffic(seed: int) -> Iterator[Data]:
    """Wardrop's equilibrium on a grid of streets with linear delays: flows on routes, and times of pairs."""
    r = np.random.default_rng(seed)
    for side, pairs in ((3, 4), (4, 8), (5, 12), (6, 20)):
        links = {}
        for i in range(side):
            for j in range(side):
                for di, dj in ((0, 1), (1, 0)):
                    if i + di < side and j + dj < side:
                        links[(i, j), (i + di, j + dj)] = len(links)
        routes, of_pair = [], []
        for k in range(pairs):
            i, j = r.integers(0, side - 1, 2)
            for _ in range(6):
                at, route = (int(i), int(j)), np.zeros(len(links))
                while at != (side - 1, side - 1):
                    down = at[1] == side - 1 or (at[0] < side - 1 and r.random() < 0.5)
                    after = (at[0] + 1, at[1]) if down else (at[0], at[1] + 1)
                    route[links[at, after]] = 1.0
                    at = after
                if not any(np.array_equal(route, one) and p == k for one, p in zip(routes, of_pair)):
                    routes.append(route)
                    of_pair.append(k)
        R, G = np.array(routes), np.eye(pairs)[of_pair]
        A = np.block([[R @ np.diag(r.uniform(0.1, 1.0, len(links))) @ R.T, -G], [G.T, np.zeros((pairs, pairs))]])
        yield A, np.concatenate([R @ r.uniform(1.0, 5.0, len(links)), -r.uniform(1.0, 5.0, pairs)])


def lasso_duals(seed: int) -> Iterator[Data]:
    """A penalised regression in positive and negative parts, at a tenth of the largest penalty."""
    r = np.random.default_rng(seed)
    for p in (25, 50, 100, 300):
        X = r.normal(size=(2 * p, p))
        y = X[:, :5] @ r.normal(size=5) * 3.0 + r.normal(size=2 * p)
        G, c = X.T @ X, X.T @ y
        yield np.block([[G, -G], [-G, G]]), np.concatenate([-c, c]) + 0.1 * np.abs(c).max()


def svm_duals(seed: int) -> Iterator[Data]:
    """A support vector machine with Gaussian kernel, without offset: 0 <= a <= 1 and the multipliers of a <= 1."""
    r = np.random.default_rng(seed)
    for n in (25, 50, 100, 200):
        X, side = r.normal(size=(n, 2)), np.where(np.arange(n) % 2, 1.0, -1.0)
        X += 0.7 * side[:, None]
        K = np.exp(-0.5 * ((X[:, None] - X[None]) ** 2).sum(axis=2))
        one = np.eye(n)
        yield np.block([[K * np.outer(side, side), one], [-one, 0.0 * one]]), np.concatenate([-np.ones(n), np.ones(n)])


FAMILIES = (boxes, arches, piles, prices, leontief, traffic, lasso_duals, svm_duals)
