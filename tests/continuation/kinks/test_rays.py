"""All rays of degenerate kinks, against enumeration of all pieces in whole numbers; straight, and of curved maps."""

import attrs
import numpy as np
import pytest

from continuation import Monitor, Status, from_functions, trace
from continuation import kink_rays as rays

from .util import Folded

NEAR = Monitor(lambda u, v: float(np.abs(u).max()) - 0.3, "near", terminal=1)


@attrs.frozen
class Bent:
    """A piecewise linear cone in other coordinates: u + `bend` times a quadratic."""

    cone: object
    bend: float
    target: float | None = None

    def straight(self, u):
        return u + self.bend * (np.roll(u, 1) ** 2 - u * np.roll(u, -1))

    def bent(self, function):
        return lambda y, lam: function(*np.split(self.straight(np.append(y, lam)), [-1]))

    def start(self):
        return self.cone.start()

    def residual(self, y, lam):
        return self.bent(self.cone.residual)(y, lam)

    def switches(self, y, lam):
        return self.bent(self.cone.switches)(y, lam)

    def piece(self, signs):
        return from_functions(self.bent(self.cone.piece(signs).residual), start=self.start())


def unit(vectors):
    """Of unit length, sorted."""
    found = np.array(vectors, dtype=float).reshape(len(vectors), -1)
    found /= np.linalg.norm(found, axis=1)[:, None]
    return found[np.lexsort(np.round(found, 5).T)]


def cones(n, m, seed):
    """Cones with the rays that leave 0, unless a switch has no derivative or kernels are no lines."""
    generator = np.random.default_rng(seed)
    for _ in range(60):
        cone = Folded.random(generator, n, m, cone=True)
        wanted = cone.rays([0] * (n + 1)) if all(map(any, cone.G)) else None
        if wanted is not None:
            yield cone, unit(list(wanted)) if wanted else np.zeros((0, n + 1))


@pytest.mark.parametrize(("n", "m"), [(1, 2), (2, 2), (2, 3), (3, 3), (3, 5)])
def test_every_ray_of_a_degenerate_kink_is_found(n, m):
    compared = 0
    for cone, wanted in cones(n, m, 100 * n + m):
        found = rays(cone, np.zeros(n + 1))
        assert found.shape == wanted.shape
        if len(wanted):
            np.testing.assert_allclose(unit(found), wanted, rtol=0, atol=1e-12)
            compared += 1
    assert compared >= 15


@pytest.mark.parametrize(("n", "m"), [(1, 2), (2, 2), (2, 4)])
def test_every_branch_of_a_curved_map_is_found_and_followed(n, m):
    followed = 0
    for cone, wanted in cones(n, m, 7 * n + m):
        bent = Bent(cone, 0.2)
        if followed >= 12 or not len(wanted) or any(np.abs(cone.switches(v[:-1], v[-1])).min() < 1e-9 for v in wanted):
            # A border along which a branch leaves bends, and first order does not tell on which side.
            continue
        np.testing.assert_allclose(unit(rays(bent, np.zeros(n + 1))), wanted, rtol=0, atol=1e-6)
        for v in wanted:
            path = trace(bent, start=(np.zeros(n + 1), v), events=[NEAR])
            assert path.status is Status.STOPPED_AT_EVENT, cone
            for step in path.steps[1:]:
                np.testing.assert_allclose(unit([bent.straight(step.u)])[0], v, rtol=0, atol=1e-6)
            followed += 1
    assert followed >= 12
