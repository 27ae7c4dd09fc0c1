"""A straight trunk with branch points of known places and multiplicities, from any start, is followed past each one."""

import numpy as np
import pytest

import continuation


class Trunk:
    """(E - lam) y + y^3 = 0 along y = 0, mixed by a rotation: H' loses as many ranks as an eigenvalue of E is there."""

    def __init__(self, seed):
        r = np.random.default_rng([912, seed])
        n = int(r.integers(5, 30))
        places = np.cumsum(r.uniform(0.5, 30.0, n))
        times = r.choice([1, 1, 2, 3], n)
        times = times[: 1 + np.searchsorted(np.cumsum(times), n)]
        places = places[: times.size]
        Q = np.linalg.qr(r.normal(size=(times.sum(), times.sum())))[0]
        self.E = Q @ np.diag(np.repeat(places, times)) @ Q.T
        self.first = places[0] - r.uniform(0.1, 20.0)
        self.target = places[-1] + r.uniform(0.1, 20.0)
        self.expected = [(place, "branch point" if k == 1 else "multiple branch point") for place, k in zip(places, times)]

    def start(self):
        return np.zeros(len(self.E)), self.first

    def residual(self, y, lam):
        return self.E @ y - lam * y + y**3

    def jacobian(self, y, lam):
        return self.E - lam * np.eye(y.size) + np.diag(3.0 * y * y), -y


PRESETS = (continuation.FAST, continuation.DEFAULT, continuation.CONSERVATIVE, continuation.SERIES)


@pytest.mark.parametrize("preset", PRESETS, ids=lambda preset: preset.name)
@pytest.mark.parametrize("seed", range(8))
def test_every_branch_point_is_found_with_its_multiplicity(seed, preset):
    trunk = Trunk(seed)
    path = continuation.trace(trunk, preset=preset)
    assert path.status is continuation.Status.REACHED_TARGET
    assert [event.name for event in path.events] == [name for _, name in trunk.expected]
    places = [place for place, _ in trunk.expected]
    np.testing.assert_allclose([event.lam for event in path.events], places, rtol=1e-8)
    assert path.counts.factorizations <= 15 * (1 + len(places))
