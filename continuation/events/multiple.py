"""All branches at a multiple branch point, where H' loses several ranks.

Lyapunov-Schmidt: every zero nearby is u0 + E a + z, E a basis of the kernel of H', z orthogonal to E, g(a) = 0. The
branching equations (Keller 1977; Allgower and Georg, Section 8.1) are the lowest terms of g; g itself, solved on a
small sphere, gives branches of any order.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from attrs import frozen

from continuation.arrays import ROOT_OF_ROUND_OFF, Array
from continuation.evaluation.evaluator import Evaluator
from continuation.events.locate import THREE_DIGITS
from continuation.events.singularity import ScaledDerivative, scales
from continuation.linear.nullspace import BORDERS, Bordered, kernels
from continuation.linear.refine import BACKWARD_ERROR
from continuation.metric import inner, norm
from continuation.point.linearization import SOLVED, linearize

LOST_RANKS = 3
"""Most lost ranks: a sphere in four dimensions."""

STEPS = 30
"""Most steps of an iteration."""

STARTS = 600
"""Newton starts on the sphere: twenty for each of the 27 lines of three cubics."""

NOISE = 1e-11
"""Round-off of a direction, relative to its largest component."""

BENT = 0.1
"""Ratio of higher to linear terms off the path, which gives unknowns that stand still along the path a unit: their
branches bend by a few degrees within the sphere."""


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
        """The equations in units of the path, by two factorisations."""
        _, sizes = scales(evaluator, extent, (u, u + 0.1 * heading))
        matrix = ScaledDerivative(evaluator, extent, sizes).at(u)
        kernel, left = kernels(matrix)
        m = kernel.shape[1]
        if m - 1 > LOST_RANKS or left.shape[1] != m - 1:
            more = " or more" if m > BORDERS else ""
            raise Unresolved(f"the kernel of H' has dimension {m}{more} there; up to {LOST_RANKS + 1} are resolved")
        evaluator.counts.factorizations += 2
        return cls(evaluator, u, extent, sizes, kernel, left, Bordered.of(matrix, left, kernel.T))

    def bend(self, heading: Array, radius: float) -> float:
        """|g(b)| over |g(a + b) - g(b)|, a along the path and b across it, of size `radius`."""
        along = self.kernel.T @ heading
        along = radius * along / np.linalg.norm(along)
        off = np.linalg.qr(along[:, None], mode="complete")[0][:, 1:].sum(axis=1) * radius
        bent = self.at(off)[1]
        turned = float(np.linalg.norm(self.at(off + along)[1] - bent))
        return float(np.linalg.norm(bent)) / turned if turned else np.inf

    def at(self, a: Array) -> tuple[Array, Array]:
        """The displacement over the kernel, and g."""
        n, size = self.sizes.size, float(np.linalg.norm(a))
        w, g = self.kernel @ a, np.zeros(self.left.shape[1])
        for _ in range(STEPS):
            H = self.evaluator.residual(self.u + self.extent * w) / self.sizes
            step = self.bordered.solve(-np.concatenate([H + self.left @ g, np.zeros(self.kernel.shape[1])]))
            w, g = w + step[: n + 1], g + step[n + 1 :]
            if np.abs(step).max() <= SOLVED * size:
                break
        return w, g


def _onto_sphere(g: Array, slopes: Array, a: Array, radius: float) -> tuple[Array, Array]:
    """Newton's step to g = 0 and |a| = radius, and the derivatives of these, over their sizes."""
    rows = np.concatenate([slopes, 2.0 * a[..., None, :] / radius], axis=-2)
    sizes = np.maximum(np.linalg.norm(rows, axis=-1, keepdims=True), np.finfo(float).tiny)
    off = np.concatenate([g, ((a**2).sum(axis=-1, keepdims=True) - radius**2) / radius], axis=-1)
    return -(np.linalg.pinv(rows / sizes, rcond=1e-12) @ (off[..., None] / sizes))[..., 0], rows / sizes


@frozen(eq=False)
class Polynomials:
    """g near zero as polynomials of degrees two to four, in radii."""

    reduced: Reduced
    radius: float
    powers: Array
    coefficients: Array

    @classmethod
    def of(cls, reduced: Reduced, radius: float) -> Polynomials:
        """Fit `reduced` by least squares at points of two spheres around zero, of `radius` and half of it."""
        m = reduced.kernel.shape[1]
        sums = [c for degree in (2, 3, 4) for c in combinations_with_replacement(range(m), degree)]
        powers = np.array([[c.count(i) for i in range(m)] for c in sums])
        half = _spread(len(sums), m, 1)
        places = np.vstack([half, -half, 0.5 * half])
        values = np.array([reduced.at(radius * a)[1] for a in places])
        terms = np.prod(places[:, None, :] ** powers, axis=2)
        return cls(reduced, radius, powers, np.linalg.lstsq(terms, values, rcond=None)[0])

    def at(self, a: Array) -> tuple[Array, Array]:
        """Values, shape (points, k), and derivatives, shape (points, k, m)."""
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
        for _ in range(STEPS):
            step, _ = _onto_sphere(*self.at(a), a, 1.0)
            there = np.abs(step).max(axis=1) < ROOT_OF_ROUND_OFF
            for one in a[there]:
                _add(found, one)
            a = (a + step)[~there]
            far = np.linalg.norm(a, axis=1) > 2.0
            a[far] /= np.linalg.norm(a[far], axis=1)[:, None]
        return found

    def root(self, a: Array, length: float = 1.0) -> tuple[Array, bool] | None:
        """A zero of g on a sphere, by Newton's method with these slopes, and whether it is isolated; or None."""
        a = a * (length / np.linalg.norm(a))
        for _ in range(STEPS):
            g, slopes = self.reduced.at(self.radius * a)[1], self.at(a[None])[1][0]
            step, rows = _onto_sphere(g, slopes, a, length)
            a = a + step
            if not np.linalg.norm(a) <= 4.0 * length:
                return None
            if np.abs(step).max() <= ROOT_OF_ROUND_OFF * length:
                return a, bool(np.linalg.svd(rows, compute_uv=False)[-1] >= ROOT_OF_ROUND_OFF)
        return None


def _spread(count: int, m: int, seed: int) -> Array:
    points = np.random.default_rng(seed).standard_normal((count, m))
    unit: Array = points / np.linalg.norm(points, axis=1)[:, None]
    return unit


def _add(found: list[Array], a: Array) -> None:
    if not any(np.linalg.norm(a - other) < THREE_DIGITS * np.linalg.norm(a) for other in found):
        found.append(a)


def leaving(evaluator: Evaluator, u: Array, heading: Array, weights: Array, step: float) -> list[Leaving]:
    """Find all branches that leave a multiple branch point: first the path's, back and onward.

    `heading`: direction of the arriving path. `step`: radius of the sphere, in the metric. Raises `Unresolved` if the
    kernel is too large, or branches do not leave one by one.
    """
    extent = 1.0 / np.sqrt(weights)
    resting = np.abs(heading) <= NOISE * extent * np.max(np.abs(heading) / extent)
    try:
        for _ in range(STEPS):
            reduced = Reduced.beside(evaluator, u, extent, heading)
            bend = reduced.bend(heading / extent, step)
            if not resting.any() or not 0.0 < bend < np.inf or 0.1 * BENT <= bend <= 10.0 * BENT:
                break
            # Exact for cubic terms; for quadratic ones it halves the extent's error, in digits.
            extent = np.where(resting, extent * np.sqrt(BENT / bend), extent)
        branches = _branches(Polynomials.of(reduced, step))
    except Unresolved:
        raise
    except (ArithmeticError, np.linalg.LinAlgError) as error:
        raise Unresolved(f"the branching equations could not be solved there: {error}") from error
    branches.sort(key=lambda b: -abs(inner(b.weights, heading, b.ray)))
    branches[:2] = sorted(branches[:2], key=lambda b: inner(b.weights, heading, b.ray))
    return branches


def _branches(near: Polynomials) -> list[Leaving]:
    m = near.reduced.kernel.shape[1]
    found: list[Array] = []
    flat = False
    for guess in near.zeros():
        for root in (near.root(guess), near.root(-guess)) if len(found) <= 2 * 4 ** (m - 1) else ():
            if root is not None:
                _add(found, root[0])
                flat |= not root[1]
    if len(found) > 2 * 4 ** (m - 1) or not found or flat:
        said = "there is a continuum of branches, as symmetries make it" if found else "none was found"
        raise Unresolved(f"the kernel of H' has dimension {m} there, and its branches do not leave one by one: {said}")
    return [_branch(near, a) for a in found]


def _branch(near: Polynomials, a: Array) -> Leaving:
    reduced, half = near.reduced, near.root(a, 0.5)
    weights = reduced.extent**-2.0
    w = reduced.at(near.radius * a)[0]
    ray = w / np.linalg.norm(w)
    if half is not None:
        nearer = reduced.at(near.radius * half[0])[0]
        # Extrapolated, as branches may curve.
        ray = 2.0 * nearer / np.linalg.norm(nearer) - ray
    ray = still(reduced.extent * ray, weights)
    u = without_noise(reduced.u, reduced.extent * w, weights)
    at = linearize(reduced.evaluator, u, weights, weights * ray)
    return Leaving(u, ray / norm(weights, ray), still(at.tangent, weights), weights)


def still(v: Array, weights: Array) -> Array:
    """A direction without round-off, which would look like a path's scale."""
    size = np.abs(v) * np.sqrt(weights)
    return np.where(size > NOISE * size.max(), v, 0.0)


def without_noise(u: Array, way: Array, weights: Array) -> Array:
    """Point u + way without round-off."""
    there = u + still(way, weights)
    return np.where(np.abs(there) * np.sqrt(weights) > BACKWARD_ERROR, there, 0.0)
