"""The arc-length method of structural mechanics, for paths with bounds: a rival of ours, in a few lines."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from scipy.optimize import brentq

from continuation.arrays import Array
from problems.nonlinear.normal_map import NormalMap, NormalPiece
from problems.scenes.scene import Quantities, Rival

STEP = 0.2
"""Of the arc: the turns of the scenes are several times as far apart."""

LOAD_STEPS = 500
"""At most until the load is reached: some ten times what the scenes take on their default meshes."""

NEWTON_ITERATIONS = 20
"""Steps of Newton's method at most: three or four are usual."""


def arc_length_method(load: float, named: Callable[[float, float, Array], Quantities]) -> Rival:
    """The rival for scenes whose path turns in a fold and then comes to a bound.

    `load`: At which the answer is asked for. `named`: The loads of the fold and of the first kink behind it, and the
    point z on the way up from there at the load, to quantities.
    """
    return Rival("arc length (Crisfield)", "", lambda scene: named(*follow(scene.problem(), load)))


def follow(problem: NormalMap, load: float) -> tuple[float, float, Array]:
    """Follow the path on spheres about its last point, with the active set of that point.

    A step that leaves the set is made shorter, to end where it does; from there the next set goes on. Raises
    `ArithmeticError` if Newton's method fails, or the path does not turn, come to a bound, and reach the load.

    References
    ----------
    Riks, J. Appl. Mech. 39 (1972); Crisfield, Computers & Structures 13 (1981).
    """
    z, lam = problem.start()
    n = z.size
    signs = np.sign(problem.switches(z, lam))
    bounded = [np.flatnonzero(np.isfinite(bound)) for bound in (problem.lower, problem.upper)]
    # A switch grows with z at a lower bound and falls at an upper one.
    place, growing = np.concatenate(bounded), np.repeat([1.0, -1.0], [len(part) for part in bounded])

    def gaps(u: Array) -> Array:
        found: Array = signs * problem.switches(u[:-1], u[-1])
        return found

    u, fold, kink = np.append(z, lam), np.nan, np.nan
    along = _tangent(problem.piece(signs), u, np.eye(n + 1)[-1])
    for _ in range(LOAD_STEPS):
        arc = Arc(problem.piece(signs), u, along)
        far, change = STEP, -1
        new = arc.at(far)
        if gaps(new).min() < 0.0:
            # The first that changes: the least gap is nonnegative up to there, and below zero behind it.
            far = brentq(lambda s, arc=arc: gaps(arc.at(s)).min(), 1e-9 * STEP, STEP, xtol=1e-15)
            new = arc.at(far)
            change = int(np.argmin(gaps(new)))
        tangent = _tangent(arc.piece, new, along)
        if tangent[-1] < 0.0 < along[-1] and np.isnan(fold):
            turned = brentq(lambda s, arc=arc: _tangent(arc.piece, arc.at(s), arc.along)[-1], 0.0, far)
            fold = float(arc.at(turned)[-1])
        if not np.isnan(kink) and new[-1] >= load:
            end = brentq(lambda s, arc=arc: arc.at(s)[-1] - load, 0.0, far, xtol=1e-15)
            return fold, kink, arc.at(end)[:-1]
        if change >= 0:
            signs[change] = -signs[change]
            outward = signs[change] * growing[change] * np.eye(n + 1)[place[change]]
            tangent = _tangent(problem.piece(signs), new, outward)
            kink = float(new[-1]) if np.isnan(kink) and not np.isnan(fold) else kink
        u, along = new, tangent
    raise ArithmeticError(f"the path did not turn, come to a bound, and reach {load:g} in {LOAD_STEPS} steps")


@frozen(eq=False)
class Arc:
    """The path of one active set from a point on, in a direction."""

    piece: NormalPiece
    start: Array
    along: Array

    def at(self, radius: float) -> Array:
        """The point at a distance, in the load and the mean square of the unknowns."""
        u, weight = self.start + radius * self.along, _weight(self.start.size)
        for _ in range(NEWTON_ITERATIONS):
            away = u - self.start
            off = np.append(self.piece.residual(u[:-1], u[-1]), weight @ away**2 - radius**2)
            change = np.linalg.solve(_bordered(self.piece, u, 2.0 * weight * away), -off) if radius else 0.0 * u
            u = u + change
            # Quadratic convergence: what follows a step of 1e-10 is below round-off.
            if np.abs(change).max() <= 1e-10 * np.abs(u).max():
                return u
        load = f"{self.start[-1]:g}"
        raise ArithmeticError(f"Newton's method did not converge in {NEWTON_ITERATIONS} steps from a load of {load}")


def _weight(size: int) -> Array:
    return np.append(np.full(size - 1, 1.0 / (size - 1)), 1.0)


def _bordered(piece: NormalPiece, u: Array, row: Array) -> Array:
    H, H_lam = piece.jacobian(u[:-1], u[-1])
    dense = H.toarray() if sp.issparse(H) else H
    return np.vstack([np.column_stack([dense, H_lam]), row])


def _tangent(piece: NormalPiece, u: Array, forward: Array) -> Array:
    """Of length 1, within a right angle of a vector."""
    weight = _weight(u.size)
    found: Array = np.linalg.solve(_bordered(piece, u, weight * forward), np.eye(u.size)[-1])
    return found / np.sqrt(weight @ found**2)
