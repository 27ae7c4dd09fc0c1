"""All branches that meet in a kink: rays in the kernels of its pieces.

Near a kink a piecewise smooth map is to first order piecewise linear, with a piece for each choice of signs of the
vanishing switches beta (Scholtes, Introduction to Piecewise Differentiable Equations, 2012, Chapter 4). A branch is a
ray v in a piece's kernel with that piece's signs. Neighbours agree where their switch vanishes: H'_tau = H'_sigma +
C_tau G, G the gradients of beta. With M = [H'_sigma; border], M v = e_{N+1} and Z = M^{-1} [C; 0],

    v_tau = alpha v - Z w,   w = G v_tau,   (I + G Z) w = alpha G v,

of order |beta|. For many switches pivots find one ray: w = D (p - n), D the incoming signs, p and n complementary, p =
(I + D G Z D) n + alpha D G v.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.pieces import Pieces, Signs
from continuation.kinks.pivots import way
from continuation.metric import inner, norm
from continuation.point.linearization import Linearization, linearize

SWITCHES_ENUMERATED = 10
"""Most switches for which all 2^10 pieces are tried; for more, pivots find one ray."""


class UnresolvedError(ArithmeticError):
    """The branches at a kink cannot be determined."""


@frozen(eq=False)
class Ray:
    """A branch: unit direction and signs of its piece."""

    v: Array
    signs: Signs


@frozen(eq=False)
class Corner:
    """A kink and its vanishing switches, from one piece."""

    pieces: Pieces
    evaluator: Evaluator
    point: Linearization
    signs: Signs
    beta: tuple[int, ...]

    def signs_with(self, of_beta: Sequence[int]) -> Signs:
        """Signs with others for the vanishing switches."""
        changed = list(self.signs)
        for j, sign in zip(self.beta, of_beta):
            changed[j] = sign
        return tuple(changed)

    def on(self, signs: Signs) -> Evaluator:
        """An evaluator of one piece, with shared counts."""
        return Evaluator(self.pieces.piece(signs), self.evaluator.counts)

    def tilts(self, v: Array) -> Array:
        """Derivatives of the vanishing switches along v."""
        return self.pieces.along(self.point.u, v)[list(self.beta)]


def rays_at(corner: Corner, come: bool = False) -> list[Ray]:
    """All branches that leave the corner, each once.

    For too many switches, pivots give one ray if a path has `come` there; else `UnresolvedError`.
    """
    if len(corner.beta) > SWITCHES_ENUMERATED and not come:
        raise UnresolvedError(
            f"Their number is {len(corner.beta)}; pieces of up to {SWITCHES_ENUMERATED} switches are gone through."
        )
    found: list[Ray] = []
    for ray in _candidates(corner):
        if not any(norm(corner.point.weights, ray.v - other.v) <= SIX_DIGITS for other in found):
            found.append(ray)
    if len(corner.beta) > SWITCHES_ENUMERATED and not found:
        raise UnresolvedError(f"Their number is {len(corner.beta)}, and where pivots lead no ray is found.")
    return found


def _candidates(corner: Corner) -> Iterator[Ray]:
    family = _Family.of(corner)
    weights = corner.point.weights
    few = len(corner.beta) <= SWITCHES_ENUMERATED
    for taus in product((1, -1), repeat=len(corner.beta)) if few else [family.by_pivots()]:
        signs = corner.signs_with(taus)
        if not corner.pieces.exists(signs):
            continue
        for v, tilts in family.kernel(signs, taus):
            along = np.array(taus) * tilts / family.sizes
            unit = v / norm(weights, v)
            along = along / norm(weights, v)
            if (along < -SIX_DIGITS).any():
                continue
            unsure = np.flatnonzero(along <= SIX_DIGITS).tolist()
            if not unsure or _stays(corner, signs, unit, unsure, family.sizes[unsure]):
                yield Ray(unit, signs)


@frozen(eq=False)
class _Family:
    """Derivatives of the corner's pieces, as low-rank changes of one.

    `sizes`: of the switches' derivatives `GR` along `R`. `columns`: c_j of H'_{j changed} - H'_sigma = c_j grad s_j.
    `Z`: M^{-1} of these; `GZ`: the switches' derivatives along them.
    """

    corner: Corner
    sizes: Array
    R: Array
    GR: Array
    tilts: Array
    columns: Array | None = None
    Z: Array | None = None
    GZ: Array | None = None

    @classmethod
    def of(cls, corner: Corner) -> _Family:
        point, b = corner.point, len(corner.beta)
        R = np.random.default_rng(4).standard_normal((b, point.u.size)) / np.sqrt(point.weights)
        GR = np.array([corner.tilts(r) for r in R]).T
        sizes = np.sqrt((GR**2).mean(axis=1))
        if not sizes.all():
            raise UnresolvedError(f"The derivative of switch {corner.beta[int(np.argmin(sizes))]} vanishes there.")
        family = cls(corner, sizes, R, GR, corner.tilts(point.tangent))
        own = [family.applied(corner.signs, r) for r in R]
        if any(image is None for image in own):
            return family
        flips = [
            corner.signs_with([-corner.signs[j] if j == k else corner.signs[j] for j in corner.beta])
            for k in corner.beta
        ]
        if not all(corner.pieces.exists(signs) for signs in flips):
            return family
        columns = [family.column(k, flips[k], np.array(own)) for k in range(b)]
        Z = np.array([point.solve(c) for c in columns])
        return cls(corner, sizes, R, GR, family.tilts, np.array(columns), Z, np.array([corner.tilts(z) for z in Z]).T)

    def applied(self, signs: Signs, r: Array) -> Array | None:
        apply = self.corner.on(signs).differential(self.corner.point.u)
        return None if apply is None else apply(r)

    def column(self, k: int, signs: Signs, own: Array) -> Array:
        """The c of c grad s_k, the derivative's change with switch k."""
        corner = self.corner
        change = np.array([self.applied(signs, r) for r in self.R]) - own
        c: Array = self.GR[k] @ change / float(self.GR[k] @ self.GR[k])
        left = float(np.abs(change - np.outer(self.GR[k], c)).max())
        if left > SIX_DIGITS * max(float(np.abs(change).max()), float(np.abs(own).max())):
            raise UnresolvedError(f"The pieces beside switch {corner.beta[k]} do not agree where it vanishes.")
        return c

    def kernel(self, signs: Signs, taus: tuple[int, ...]) -> Iterator[tuple[Array, Array]]:
        flipped = np.array(taus) != np.array(self.corner.signs)[list(self.corner.beta)]
        if self.columns is None or self.Z is None or self.GZ is None or not self._adds_up(signs, flipped):
            v = self._factored(signs)
            w = self.corner.tilts(v)
        else:
            # Units of the switches make singular values comparable.
            small = np.eye(len(taus)) + self.GZ * (flipped * self.sizes)[None, :] / self.sizes[:, None]
            small = np.column_stack([small, -self.tilts / self.sizes])
            _, values, rows = np.linalg.svd(small)
            if not values[-1] > ROOT_OF_ROUND_OFF * values[0]:
                raise UnresolvedError(
                    f"The kernel of the piece with the signs {list(taus)} has several dimensions there."
                )
            w, alpha = rows[-1][:-1] * self.sizes, float(rows[-1][-1])
            v = alpha * self.corner.point.tangent - (flipped * w) @ self.Z
        yield v, w
        yield -v, -w

    def by_pivots(self) -> tuple[int, ...]:
        corner = self.corner
        many = f"Their number is {len(corner.beta)}; pieces of up to {SWITCHES_ENUMERATED} switches are gone through"
        if self.GZ is None:
            raise UnresolvedError(f"{many}, and pivots need pieces that differ in one switch each.")
        came = np.array(corner.signs)[list(corner.beta)]
        units = came * self.sizes
        falls = self.tilts / units
        on = None
        if (falls <= SIX_DIGITS * norm(corner.point.weights, corner.point.tangent)).all():
            on = way(np.eye(came.size) + self.GZ * units / units[:, None], np.minimum(falls, 0.0))
        if on is None or on.ray.back:
            raise UnresolvedError(f"{many}, and pivots lead {'nowhere' if on is None else 'back'}.")
        flipped = np.isin(np.arange(came.size), on.switched)
        taus = tuple(np.where(flipped, -came, came).tolist())
        if not self._adds_up(corner.signs_with(taus), flipped):
            raise UnresolvedError(f"{many}, and the changes of these do not add up, as pivots need it.")
        return taus

    def _adds_up(self, signs: Signs, flipped: NDArray[np.bool_]) -> bool:
        """Whether changes of switches add up, as in complementarity problems."""
        if int(flipped.sum()) < 2 or self.columns is None:
            return True
        own, there = (self.applied(s, self.R[0]) for s in (self.corner.signs, signs))
        assert own is not None
        assert there is not None
        left = there - own - (flipped * self.GR[:, 0]) @ self.columns
        return float(np.abs(left).max()) <= SIX_DIGITS * float(np.abs(there).max() + np.abs(own).max())

    def _factored(self, signs: Signs) -> Array:
        """A kernel by its own factorisation, with two borders that must agree."""
        corner, found = self.corner, []
        for seed in (5, 6):
            border = np.random.default_rng(seed).standard_normal(corner.point.u.size) * np.sqrt(corner.point.weights)
            found.append(linearize(corner.on(signs), corner.point.u, corner.point.weights, border).tangent)
        cosine = abs(inner(corner.point.weights, *found))
        if cosine < 1.0 - SIX_DIGITS:
            raise UnresolvedError("The kernel of a piece that meets there has more than one dimension.")
        return found[0]


RAY_LENGTHS = 1e-3, 1e-4, 1e-5
"""Lengths, in the metric, at which rays are checked if the first order does not decide."""


def _stays(corner: Corner, signs: Signs, v: Array, unsure: Sequence[int], sizes: Array) -> bool:
    point, evaluator = corner.point, corner.on(signs)
    which = [corner.beta[k] for k in unsure]
    try:
        near = linearize(evaluator, point.u, point.weights, point.weights * v)
        for length in RAY_LENGTHS:
            u = point.u + length * v
            moves = []
            for _ in range(4):
                move = near.solve(-evaluator.residual(u), 0.0, near.weights * v)
                u = u + move
                moves.append(norm(near.weights, move))
            if not moves[-1] <= SIX_DIGITS * length:
                continue
            s = np.array(signs)[which] * corner.pieces.values(u)[which]
            return bool((s >= -ROOT_OF_ROUND_OFF * length * sizes).all())
    except EvaluationError:
        pass
    return False
