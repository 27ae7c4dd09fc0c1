"""All rays of degenerate kinks, against enumeration of all pieces in whole numbers."""

import numpy as np
import pytest

from continuation import kink_rays as rays
from continuation.kinks.rays import UnresolvedError

from .util import Folded


def unit(vectors):
    """Of unit length, sorted."""
    found = np.array([np.array(v, dtype=float) / np.linalg.norm(np.array(v, dtype=float)) for v in vectors])
    return found[np.lexsort(np.round(found, 6).T)] if len(found) else found


@pytest.mark.parametrize(("n", "m"), [(1, 2), (2, 2), (2, 3), (3, 3), (3, 5)])
def test_every_ray_of_a_degenerate_kink_is_found(n, m):
    generator = np.random.default_rng(100 * n + m)
    compared = refused = 0
    for _ in range(40):
        cone = Folded.random(generator, n, m, cone=True)
        zero = np.zeros(n + 1)
        if any(not any(row) for row in cone.G) or not any(cone.kernel([1] * m)):
            # A switch without a derivative; a piece on which no path comes.
            continue
        wanted = cone.rays([0] * (n + 1))
        if wanted is None:
            refused += 1
            try:
                rays(cone, zero)
            except UnresolvedError:
                continue
            continue
        found = rays(cone, zero)
        assert found.shape == (len(wanted), n + 1), cone
        assert np.allclose(unit(found), unit(wanted), atol=1e-12), cone
        compared += 1
    assert compared >= 15
