"""All branches at a multiple branch point, where H' loses several ranks.

Lyapunov-Schmidt: every zero nearby is u0 + E a + z, E a basis of the kernel of H', z orthogonal to E, g(a) = 0. The
branching equations (Keller 1977; Allgower and Georg, Section 8.1) are the lowest terms of g; g itself, solved on a
small sphere, gives branches of any order.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.evaluation.evaluator import Evaluator
from continuation.events.singularity import ScaledDerivative, row_sizes
from continuation.linear.nullspace import BORDERS, Bordered, kernels
from continuation.metric import inner, norm
from continuation.point.linearization import linearize

LOST_RANKS = 3
"""Lost ranks that are resolved: a sphere in four dimensions."""

CHORD, LAST_INCREMENT = 30, 1e-13
"""Chord steps onto the graph of z; last increment, relative to the sphere."""

STARTS = 600
"""Newton starts on the sphere: twenty for each of the 27 lines of three cubics."""

NEWTON, ROOT = 30, 1e-9
"""Newton steps; last increment, relative to the sphere."""

DIFFERENCE = 1e-4
"""Step of differences of g, relative to the sphere; half the digits remain."""

SAME_ZERO = 1e-3
"""Nearer zeros, relative to the sphere, are one."""

NOISE, ZERO = 1e-11, 1e-14
"""Round-off of a direction, relative to its largest component; of a point, in extents."""

BENT, BALANCINGS = 0.1, 20
"""Ratio of higher to linear terms off the path: branches of unknowns that stand still along the path, and so have no
unit, bend by a few degrees within the sphere. Twenty halvings leave no digit."""

ISOLATED = 1e-7
"""Least singular value of the scaled equations at an isolated zero."""


class Unresolved(ArithmeticError):
    """Branches at a multiple branch point were not found; the message says why."""


@frozen(eq=False)
class Leaving:
    """A branch: a point `u` with `tangent`, and the unit `ray` at the branch point, in the metric `weights`."""

    u: Array
    ray: Array
    tangent: Array
    weights: Array


@frozen(eq=False)
class Reduced:
    """The reduced equations g(a) = 0, scaled."""

    evaluator: Evaluator
    u: Array
    extent: Array
    sizes: Array
    kernel: Array
    left: Array
    bordered: Bordered

    @classmethod
    def beside(cls, evaluator: Evaluator, u: Array, extent: Array, heading: Array) -> Reduced:
        """In units of the path, by two factorisations."""
        sizes = row_sizes(evaluator, extent, (u, u + 0.1 * heading))
        matrix = ScaledDerivative(evaluator, extent, sizes).at(u)
        kernel, left = kernels(matrix)
        m = kernel.shape[1]
        if m - 1 > LOST_RANKS or left.shape[1] != m - 1:
            more = " or more" if m > BORDERS else ""
            raise Unresolved(f"the kernel of H' has dimension {m}{more} there; up to {LOST_RANKS + 1} are resolved")
        evaluator.counts.factorizations += 2
        return cls(evaluator, u, extent, sizes, kernel, left, Bordered.of(matrix, left, kernel.T))

    def bend(self, heading: Array, radius: float) -> float:
        """Size of g on the sphere off the path, relative to its change as far along the path."""
        along = self.kernel.T @ heading
        along = radius * along / np.linalg.norm(along)
        off = np.linalg.qr(along[:, None], mode="complete")[0][:, 1:].sum(axis=1) * radius
        bent = self.at(off)[1]
        turned = float(np.linalg.norm(self.at(off + along)[1] - bent))
        return float(np.linalg.norm(bent)) / turned if turned else np.inf

    def at(self, a: Array) -> tuple[Array, Array]:
        """The point over the kernel, from u, and g."""
        n, size = self.sizes.size, float(np.linalg.norm(a))
        w, g = self.kernel @ a, np.zeros(self.left.shape[1])
        for _ in range(CHORD):
            H = self.evaluator.residual(self.u + self.extent * w) / self.sizes
            step = self.bordered.solve(-np.concatenate([H + self.left @ g, np.zeros(self.kernel.shape[1])]))
            w, g = w + step[: n + 1], g + step[n + 1 :]
            if np.abs(step).max() <= LAST_INCREMENT * size:
                break
        return w, g

    def slopes(self, a: Array, radius: float) -> Array:
        """Derivatives of g."""
        h = DIFFERENCE * radius
        return np.column_stack([(self.at(a + h * e)[1] - self.at(a - h * e)[1]) / (2.0 * h) for e in np.eye(a.size)])

    def newton(self, a: Array, radius: float) -> Array | None:
        """A zero on the sphere, or None."""
        a = a * (radius / np.linalg.norm(a))
        for _ in range(NEWTON):
            step = _onto_sphere(self.at(a)[1], self.slopes(a, radius), a, radius)
            a = a + step
            if not np.isfinite(a).all() or np.linalg.norm(a) > 4.0 * radius:
                return None
            if np.abs(step).max() <= ROOT * radius:
                return a
        return None


def _equations(slopes: Array, a: Array, radius: float) -> tuple[Array, Array]:
    """Derivatives of g = 0 and |a| = radius, over their sizes, and the sizes."""
    rows = np.concatenate([slopes, 2.0 * a[..., None, :] / radius], axis=-2)
    sizes = np.maximum(np.linalg.norm(rows, axis=-1), np.finfo(float).tiny)
    return rows / sizes[..., None], sizes


def _onto_sphere(g: Array, slopes: Array, a: Array, radius: float) -> Array:
    rows, sizes = _equations(slopes, a, radius)
    off = np.concatenate([g, ((a**2).sum(axis=-1, keepdims=True) - radius**2) / radius], axis=-1)
    step: Array = -(np.linalg.pinv(rows, rcond=1e-12) @ (off / sizes)[..., None])[..., 0]
    return step


@frozen(eq=False)
class Polynomials:
    """g near zero as polynomials of degrees two to four."""

    powers: Array
    coefficients: Array

    @classmethod
    def of(cls, reduced: Reduced, radius: float) -> Polynomials:
        """Fit `reduced` by least squares at points of two spheres around zero, of `radius` and of half of it."""
        m = reduced.kernel.shape[1]
        sums = [c for degree in (2, 3, 4) for c in combinations_with_replacement(range(m), degree)]
        powers = np.array([[c.count(i) for i in range(m)] for c in sums])
        half = _spread(len(sums), m, 1)
        places = np.vstack([half, -half, 0.5 * half])
        values = np.array([reduced.at(radius * a)[1] for a in places])
        terms = np.prod(places[:, None, :] ** powers, axis=2)
        return cls(powers, np.linalg.lstsq(terms, values, rcond=None)[0])

    def at(self, a: Array) -> tuple[Array, Array]:
        """Values, shape (points, k), and derivatives, shape (points, k, m), in radii."""
        raised = a[:, None, :] ** self.powers
        slopes = []
        for i in range(a.shape[1]):
            lower = self.powers.copy()
            lower[:, i] = np.maximum(lower[:, i] - 1, 0)
            slopes.append((self.powers[:, i] * np.prod(a[:, None, :] ** lower, axis=2)) @ self.coefficients)
        return np.prod(raised, axis=2) @ self.coefficients, np.stack(slopes, axis=2)

    def zeros(self) -> list[Array]:
        """Zeros on the unit sphere."""
        found: list[Array] = []
        a = _spread(STARTS, self.powers.shape[1], 2)
        for _ in range(NEWTON):
            step = _onto_sphere(*self.at(a), a, 1.0)
            there = np.abs(step).max(axis=1) < ROOT
            for one in a[there]:
                _add(found, one)
            a = (a + step)[~there]
            far = np.linalg.norm(a, axis=1) > 2.0
            a[far] /= np.linalg.norm(a[far], axis=1)[:, None]
        return found


def _spread(count: int, m: int, seed: int) -> Array:
    points = np.random.default_rng(seed).standard_normal((count, m))
    unit: Array = points / np.linalg.norm(points, axis=1)[:, None]
    return unit


def _add(found: list[Array], a: Array) -> None:
    if not any(np.linalg.norm(a - other) < SAME_ZERO * np.linalg.norm(a) for other in found):
        found.append(a)


def leaving(evaluator: Evaluator, u: Array, heading: Array, weights: Array, step: float) -> list[Leaving]:
    """Find all branches that leave a multiple branch point: first the path's, back and onward.

    `heading`: direction of the arriving path. `step`: radius of the sphere, in the metric. Raises `Unresolved` if the
    kernel is too large, or branches do not leave one by one.
    """
    extent = 1.0 / np.sqrt(weights)
    resting = np.abs(heading) <= NOISE * extent * np.max(np.abs(heading) / extent)
    try:
        for _ in range(BALANCINGS):
            reduced = Reduced.beside(evaluator, u, extent, heading)
            bend = reduced.bend(heading / extent, step)
            if not resting.any() or not 0.0 < bend < np.inf or 0.1 * BENT <= bend <= 10.0 * BENT:
                break
            # This suits cubic terms; for quadratic ones it halves the extent's error, in digits.
            extent = np.where(resting, extent * np.sqrt(BENT / bend), extent)
        found = _on_sphere(reduced, step)
        branches = [_branch(reduced, a, step, reduced.extent**-2.0) for a in found]
    except Unresolved:
        raise
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise Unresolved(f"the branching equations could not be solved there: {error}") from error
    branches.sort(key=lambda b: -abs(inner(b.weights, heading, b.ray)))
    branches[:2] = sorted(branches[:2], key=lambda b: inner(b.weights, heading, b.ray))
    return branches


def _on_sphere(reduced: Reduced, radius: float) -> list[Array]:
    m = reduced.kernel.shape[1]
    found: list[Array] = []
    for guess in Polynomials.of(reduced, radius).zeros():
        if len(found) > 2 * 4 ** (m - 1):
            break
        for way in (guess, -guess):
            a = reduced.newton(way, radius)
            if a is not None:
                _add(found, a)
    many = len(found) > 2 * 4 ** (m - 1)
    if many or not found or any(_flat(reduced, a, radius) for a in found):
        said = "there is a continuum of branches, as symmetries make it" if found else "none was found"
        raise Unresolved(f"the kernel of H' has dimension {m} there, and its branches do not leave one by one: {said}")
    return found


def _flat(reduced: Reduced, a: Array, radius: float) -> bool:
    rows, _ = _equations(reduced.slopes(a, radius), a, radius)
    return bool(np.linalg.svd(rows, compute_uv=False)[-1] < ISOLATED)


def _branch(reduced: Reduced, a: Array, radius: float, weights: Array) -> Leaving:
    w = reduced.at(a)[0]
    nearer = reduced.newton(0.5 * a, 0.5 * radius)
    ray = w / np.linalg.norm(w)
    if nearer is not None:
        half = reduced.at(nearer)[0]
        # Extrapolated, as branches may curve.
        ray = 2.0 * half / np.linalg.norm(half) - ray
    ray = still(reduced.extent * ray, weights)
    u = without_noise(reduced.u, reduced.extent * w, weights)
    near = linearize(reduced.evaluator, u, weights, weights * ray)
    return Leaving(u, ray / norm(weights, ray), still(near.tangent, weights), weights)


def still(v: Array, weights: Array) -> Array:
    """A direction without round-off, which a path would take for scale."""
    size = np.abs(v) * np.sqrt(weights)
    return np.where(size > NOISE * size.max(), v, 0.0)


def without_noise(u: Array, way: Array, weights: Array) -> Array:
    """The point u + way without round-off."""
    there = u + still(way, weights)
    return np.where(np.abs(there) * np.sqrt(weights) > ZERO, there, 0.0)
