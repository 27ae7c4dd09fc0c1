"""Deflation: known solutions are divided out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import POSITIVE_FINITE, expect, real_vector
from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, Matrix
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.linear import BorderedSystem, factor_bordered
from continuation.linear.elimination import eliminated
from continuation.linear.system import Solver
from continuation.tracing import solve_at


def _vectors(known: Any) -> tuple[Array, ...]:
    expect(
        isinstance(known, Iterable) and not isinstance(known, str),
        "known",
        "several solutions, as in a list",
        known,
        TypeError,
    )
    vectors = tuple(np.atleast_1d(real_vector("known", y)) for y in known)
    expect(all(np.isfinite(y).all() for y in vectors), "known", "finite numbers", known)
    return vectors


@frozen(eq=False)
class Deflated:
    """A homotopy with known solutions divided out: M(y) H(y, lam), M the product of 1 / |y - y_i|^power + shift.

    It keeps the other zeros of H. Use at one parameter value: ``solve_at(Deflated(homotopy, known), lam, guess)``.

    Parameters
    ----------
    homotopy : Homotopy
    known : sequence of array_like, shape (N,)
        Solutions at that value.
    power : float, default 2
    shift : float, default 1
        Keeps M from vanishing far away.
    scale : array_like, shape (N,), optional
        Divides differences; 1 by default.

    References
    ----------
    Farrell, Birkisson, Funke, Deflation techniques for finding distinct solutions of nonlinear partial differential
    equations, SIAM J. Sci. Comput. 37 (2015).
    """

    homotopy: Any
    known: tuple[Array, ...] = field(converter=_vectors)
    power: float = field(default=2.0, validator=POSITIVE_FINITE)
    shift: float = field(default=1.0, validator=POSITIVE_FINITE)
    scale: Any = None
    _evaluator: Evaluator = field(init=False, repr=False)

    @_evaluator.default
    def _made(self) -> Evaluator:
        return Evaluator(self.homotopy, Counts())

    def __attrs_post_init__(self) -> None:
        size = self._evaluator.start().size - 1
        for y in self.known:
            if y.shape != (size,):
                raise ValueError(f"known: expected solutions of {size} unknowns, found shape {y.shape}")

    def start(self) -> tuple[Array, float]:
        """The homotopy's start."""
        u = self._evaluator.start()
        return u[:-1], float(u[-1])

    def factor(self, y: Array) -> tuple[float, Array]:
        """The factor M at y, and the gradient of log M.

        Parameters
        ----------
        y : ndarray, shape (N,)
        """
        scale = np.ones_like(y) if self.scale is None else np.asarray(self.scale, dtype=float)
        ways = (y - np.reshape(self.known, (-1, y.size))) / scale
        distances = np.linalg.norm(ways, axis=1)
        if not distances.all():
            return float("inf"), np.zeros_like(y)
        ones = distances**-self.power
        shares = ones / (ones + self.shift) / distances**2
        return float(np.prod(ones + self.shift)), -self.power * (shares @ ways) / scale

    def residual(self, y: Array, lam: float) -> Array:
        """M(y) H(y, lam); infinite at a known solution."""
        value, H = self.factor(y)[0], np.asarray(self.homotopy.residual(y, lam), dtype=float)
        # inf * 0 would be nan.
        return value * H if np.isfinite(value) else np.full_like(H, np.inf)

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """M (H_y + H (log M)'), dense, and M H_lam: for checks."""
        value, slope = self.factor(y)
        H_y, H_lam = self._evaluator.derivative(y, lam)
        whole = H_y if isinstance(H_y, np.ndarray) else H_y.toarray()
        H = np.asarray(self.homotopy.residual(y, lam), dtype=float)
        return value * (whole + np.outer(H, slope)), value * np.asarray(H_lam, dtype=float)

    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """The derivative times a direction (v_y, v_lam)."""
        value, slope = self.factor(y)
        H_y, H_lam = self._evaluator.derivative(y, lam)
        H = np.asarray(self.homotopy.residual(y, lam), dtype=float)
        return np.asarray(value * (H_y @ v[:-1] + np.asarray(H_lam) * v[-1] + H * float(slope @ v[:-1])))

    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """The bordered matrix, factored, with a rank-one change (Sherman and Morrison).

        If half of the digits cancel, the whole matrix is factored.
        """
        value, slope = self.factor(y)
        H_y, H_lam = self._evaluator.derivative(y, lam)
        system = factor_bordered(H_y, np.asarray(H_lam, dtype=float), border)
        turned = system.solve(np.asarray(self.homotopy.residual(y, lam), dtype=float), 0.0)
        # q = g'v makes the change H q one column.
        changed = eliminated(
            lambda rhs: system.solve(rhs[:-1], rhs[-1]), turned[:, None], np.append(slope, [0.0, -1.0])[None]
        )
        if not abs(changed.schur[0, 0]) * ROOT_OF_ROUND_OFF < 1.0:
            return factor_bordered(*self.jacobian(y, lam), border)

        def solve(r: Array, rho: float) -> Array:
            return changed.solve(np.concatenate([r / value, [rho, 0.0]]))[:-1]

        return Solver(solve, lambda: -system.sign * changed.sign)


def others(homotopy: Any, lam: float, known: Sequence[Array], guesses: Sequence[Array]) -> list[Array]:
    """Further solutions at a parameter value, by Newton's method on the deflated residual."""
    every = list(known)
    spread = np.ptp(np.array([*every, *guesses]), axis=0)
    scale = np.where(spread > 0.0, spread, max(float(spread.max()), np.finfo(float).tiny)) if spread.any() else None
    for guess in guesses:
        while True:
            try:
                # Newton's method without the factor gives full accuracy.
                y = solve_at(homotopy, lam, solve_at(Deflated(homotopy, every, scale=scale), lam, guess))
            except ArithmeticError:
                break
            if any(same_solution(y, other, scale) for other in every):
                break
            every.append(y)
    return every[len(known) :]


def same_solution(y: Array, other: Array, scale: Any = None) -> bool:
    """Whether two solutions agree in six digits, in units of a scale: double ones have half of the digits."""
    size = 1.0 + np.abs(y) if scale is None else scale
    return bool((np.abs(y - other) <= SIX_DIGITS * size).all())
