"""Degenerate kinks of curved maps: every branch is found, and followed without a change to another."""

import attrs
import numpy as np
import pytest

from continuation import Monitor, Status, trace
from continuation import kink_rays as rays
from continuation.kinks.rays import UnresolvedError

from .util import Folded

BEND = 0.2


def straightened(u):
    """Coordinates in which the map is piecewise linear: u + a quadratic that vanishes at 0."""
    return u + BEND * (np.roll(u, 1) ** 2 - u * np.roll(u, -1))


@attrs.frozen
class Bent:
    """A piecewise linear cone in other coordinates."""

    cone: Folded
    target: float | None = None

    def start(self):
        return self.cone.start()

    def _at(self, y, lam):
        u = straightened(np.append(y, lam))
        return u[:-1], u[-1]

    def residual(self, y, lam):
        return self.cone.residual(*self._at(y, lam))

    def switches(self, y, lam):
        return self.cone.switches(*self._at(y, lam))

    def piece(self, signs):
        return BentPiece(self, self.cone.piece(signs))


@attrs.frozen
class BentPiece:
    whole: Bent
    piece: object

    def start(self):
        return self.whole.start()

    def residual(self, y, lam):
        return self.piece.residual(*self.whole._at(y, lam))


@pytest.mark.parametrize(("n", "m"), [(1, 2), (2, 2), (2, 4)])
def test_every_branch_is_found_and_followed(n, m):
    generator = np.random.default_rng(7 * n + m)
    near = Monitor(lambda u, v: float(np.abs(u).max()) - 0.3, "near", terminal=1)
    followed = 0
    while followed < 12:
        cone = Folded.random(generator, n, m, cone=True)
        wanted = None if any(not any(row) for row in cone.G) else cone.rays([0] * (n + 1))
        if not wanted:
            continue
        try:
            found = rays(Bent(cone), np.zeros(n + 1))
        except UnresolvedError:
            # A border along which a branch leaves bends, and first order does not tell on which side.
            continue
        exact = np.array([[float(x) for x in ray] for ray in wanted])
        exact /= np.linalg.norm(exact, axis=1)[:, None]
        assert found.shape == exact.shape
        for v in found:
            w = exact[int(np.argmax(exact @ v))]
            assert np.abs(v - w).max() < 1e-6
            path = trace(Bent(cone), start=(np.zeros(n + 1), v), events=[near])
            assert path.status is Status.STOPPED_AT_EVENT, cone
            along = np.array([straightened(step.u) for step in path.steps[1:]])
            along /= np.linalg.norm(along, axis=1)[:, None]
            assert np.abs(along - w).max() < 1e-6
            followed += 1
