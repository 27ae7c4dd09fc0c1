"""All rays of degenerate kinks, against enumeration of all pieces in whole numbers; straight, and of curved maps."""

import numpy as np
import pytest

from continuation import Monitor, Status
from continuation import kink_rays as rays

from ...util import path_of
from .util import Folded, Joined

NEAR = Monitor(lambda u, v: float(np.abs(u).max()) - 0.3, "near", terminal=1)


def straight(u):
    """Coordinates in which a bent map is a cone."""
    return u + 0.2 * (np.roll(u, 1) ** 2 - u * np.roll(u, -1))


def bent(function):
    return lambda y, lam: function(*np.split(straight(np.append(y, lam)), [-1]))


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
        curved = Joined(lambda *signs: bent(cone.piece(signs).residual), bent(cone.switches), cone.start())  # noqa: B023
        if followed >= 12 or not len(wanted) or any(np.abs(cone.switches(v[:-1], v[-1])).min() < 1e-9 for v in wanted):
            # A border along which a branch leaves bends, and first order does not tell on which side.
            continue
        np.testing.assert_allclose(unit(rays(curved, np.zeros(n + 1))), wanted, rtol=0, atol=1e-6)
        for v in wanted:
            path = path_of(curved, start=(np.zeros(n + 1), v), events=[NEAR], status=Status.STOPPED_AT_EVENT)
            for step in path.steps[1:]:
                np.testing.assert_allclose(unit([straight(step.u)])[0], v, rtol=0, atol=1e-6)
            followed += 1
    assert followed >= 12
