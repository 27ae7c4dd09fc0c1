"""A trunk with branch points of known places and multiplicities, in any units, is followed past each of them."""

from itertools import cycle

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import brentq

import continuation

from ...util import by_preset, every_preset, path_of
from ..util import scalar

PRESETS = continuation.FAST, continuation.DEFAULT, continuation.CONSERVATIVE


def named(value):
    return getattr(value, "name", str(value))


class Trunk:
    """(E - f(lam)) z + z^3 = 0 along z = y / D - c sin(w lam) = 0: H' loses as many ranks as E has eigenvalues f(lam).

    `bent`: Whether c and the nonlinear part of f are there. `spread`: Decades of the units of unknowns and equations.
    """

    def __init__(self, seed, bent=False, spread=0.0):
        r = np.random.default_rng([912, seed])
        n = int(r.integers(5, 30))
        places = np.cumsum(r.uniform(0.5, 30.0, n))
        times = r.choice([1, 1, 2, 3], n)
        times = times[: 1 + np.searchsorted(np.cumsum(times), n)]
        places, n = places[: times.size], times.sum()
        Q = np.linalg.qr(r.normal(size=(n, n)))[0]
        self.E = Q @ np.diag(np.repeat(places, times)) @ Q.T
        self.first, self.target = places[0] - r.uniform(0.1, 20.0), places[-1] + r.uniform(0.1, 20.0)
        self.length, self.k = self.target - self.first, 0.6 * bent * r.random()
        self.c, self.w = bent * r.normal(size=n), 2.0 * np.pi * r.uniform(0.2, 1.0) / self.length
        self.D, self.F = 10.0 ** r.uniform(-spread, spread, (2, n))
        found = [(brentq(lambda lam, e=e: self.f(lam) - e, self.first, self.target), k) for e, k in zip(places, times)]
        self.expected = [(lam, "branch point" if k == 1 else "multiple branch point") for lam, k in found]

    def f(self, lam):
        t = (lam - self.first) / self.length
        return self.first + self.length * (t + self.k * np.sin(2.0 * np.pi * t) / (2.0 * np.pi))

    def z(self, y, lam):
        return y / self.D - self.c * np.sin(self.w * lam)

    def start(self):
        return self.D * self.c * np.sin(self.w * self.first), self.first

    def residual(self, y, lam):
        z = self.z(y, lam)
        return self.F * (self.E @ z - self.f(lam) * z + z**3)

    def jacobian(self, y, lam):
        z, t = self.z(y, lam), (lam - self.first) / self.length
        H_z = self.E - self.f(lam) * np.eye(z.size) + np.diag(3.0 * z * z)
        H_lam = -(1.0 + self.k * np.cos(2.0 * np.pi * t)) * z - H_z @ (self.c * self.w * np.cos(self.w * lam))
        return self.F[:, None] * H_z / self.D, self.F * H_lam


def passed(trunk, preset, **options):
    """The path, of which every branch point is as expected."""
    path = path_of(trunk, preset=preset, **options)
    assert [event.name for event in path.events] == [name for _, name in trunk.expected]
    np.testing.assert_allclose([event.lam for event in path.events], [lam for lam, _ in trunk.expected], rtol=1e-6)
    return path


@pytest.mark.parametrize(
    ("seed", "preset"), [*zip(range(6), cycle(PRESETS)), *((93, preset) for preset in PRESETS)], ids=named
)
def test_every_branch_point_is_found_with_its_multiplicity(seed, preset):
    trunk = Trunk(seed)
    path = passed(trunk, preset)
    # 14 to 26 each, and 5 of 120 paths wrong, while looks at H' overlooked eigenvalues.
    assert path.counts.factorizations <= 15 * (1 + len(trunk.expected))


@pytest.mark.parametrize(
    ("seed", "beside", "preset"),
    list(zip(range(6), (1e-16, 1e-13, 1e-10, 1e-8, 1e-6, 1e-4), cycle(PRESETS))),
    ids=named,
)
def test_a_start_beside_a_symmetric_trunk_is_put_on_it(seed, beside, preset):
    # What Newton's method leaves of an unknown, 1e-40, is no size: 28 of 100 paths ended at their start.
    trunk = Trunk(seed, spread=3.0)
    y, lam = trunk.start()
    moved = y + beside * trunk.D * np.random.default_rng(seed).normal(size=y.size)
    path = passed(trunk, preset, start=(moved, lam))
    assert not path.u[0, :-1].any()


@every_preset
@pytest.mark.parametrize("seed", [2, 606, 622])
def test_unknowns_that_stand_still_have_units_of_their_own(seed, preset):
    passed(Trunk(seed, spread=4.0), preset)


@by_preset(*PRESETS[:2])
@pytest.mark.parametrize("seed", [0, 3, 8, 33, 49, 206])
def test_eigenvalues_that_vanish_together_may_do_so_at_different_rates(seed, preset):
    trunk = Trunk(seed, bent=True)
    # 10 to 72 each; 94 to 122 of seed 49 if each place looked at has a matrix of its own.
    assert passed(trunk, preset).counts.factorizations <= 90 * (1 + len(trunk.expected))


@every_preset
@pytest.mark.parametrize("ranks", [5, 6, 7])
def test_any_number_of_ranks_may_be_lost(ranks, preset):
    pitchforks = continuation.from_functions(
        lambda y, lam: lam * y - y**3,
        lambda y, lam: (np.diag(lam - 3.0 * y * y), y.copy()),
        start=(np.zeros(ranks), -1.0),
        target=1.0,
    )
    path = path_of(pitchforks, preset=preset)
    assert [event.name for event in path.events] == ["multiple branch point"]


class Beam:
    """K y - lam y - y^3 = 0 for a beam of n points: H' has a condition of 1e8, and loses one rank at lam = 1."""

    target = 2.0

    def __init__(self, n):
        ends = 2.0 - 2.0 * np.cos(np.pi / (n + 1))
        once = sp.diags_array([-np.ones(n - 1), np.full(n, 2.0), -np.ones(n - 1)], offsets=[-1, 0, 1])
        self.n, self.K = n, sp.csc_array(once @ once / ends**2)

    def start(self):
        return np.zeros(self.n), 0.0

    def residual(self, y, lam):
        return self.K @ y - lam * y - y**3

    def jacobian(self, y, lam):
        return sp.csc_array(self.K - sp.diags_array(lam + 3.0 * y * y)), -y


def test_a_fine_mesh_loses_no_rank_by_its_condition():
    path = path_of(Beam(150))
    assert [event.name for event in path.events] == ["branch point"]
    assert path.events[0].lam == pytest.approx(1.0, rel=1e-7)  # round-off of K is 1e-9


@pytest.mark.parametrize("power", [2, 12, 40, 80])
def test_a_straight_trunk_has_the_scale_of_its_start(power):
    """Lengths are tried until H bends; where lam^80 overflows is no length of the path."""
    trunk = scalar(lambda y, lam: y * (lam**power - 2.0) - y**3, start=(0.0, 0.3), target=None)
    path = continuation.trace(trunk, budget=continuation.Budget(steps=15))
    assert [event.lam for event in path.events] == pytest.approx([2.0 ** (1.0 / power)])


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_a_branch_off_a_trunk_at_rest_is_followed_in_any_unit(unit):
    homotopy = continuation.from_functions(
        lambda y, lam: np.stack([y[0] / unit - lam, (1.0 - 2.0 * lam) * y[1] / unit + (y[1] / unit) ** 3]),
        start=(np.zeros(2), 0.0),
        target=2.0,
    )
    branch = path_of(homotopy, start=continuation.switch_branch(homotopy, continuation.trace(homotopy).events[0])[0])
    assert abs(branch.endpoint.y[1]) == pytest.approx(np.sqrt(3.0) * unit)
    assert len(branch) < 30
