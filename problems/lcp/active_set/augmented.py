"""Active sets of a quadratic program from its proximal augmented Lagrangian.

With penalties the function is convex and piecewise quadratic: Newton's method with exact line search cannot cycle.

References
----------
Hermans, Themelis and Patrinos, Math. Prog. Comp. 14 (2022); Qi and Sun, Math. Prog. 58 (1993).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix
from continuation.counts import Counts
from continuation.linear.factoring import Factoring
from continuation.linear.symmetric import factor_cholesky
from problems.lcp.data.problem import BETWEEN, LOWER, UPPER, MixedLCP, State

MOST_PENALTY, PENALTY_GROWTH = 1e8, 10.0
"""The largest penalty, and the growth at each change of multipliers; the first penalty is objective over violations."""

STEPS_PER_CHANGE = 100
"""Most Newton steps for one set of multipliers."""


@frozen(eq=False)
class Saddle:
    """A program: P, c, rows R x + d >= 0 (= 0 where `free`), x in [lower, upper]."""

    problem: MixedLCP
    P: Matrix
    R: Matrix
    c: Array
    d: Array
    free: NDArray[np.bool_]

    @classmethod
    def of(cls, problem: MixedLCP) -> Saddle | None:
        """Program in the first `problem.primal` unknowns, or None."""
        n, A = problem.primal, problem.A
        P, R, low, high = A[:n][:, :n], A[n:][:, :n], problem.lower[n:], problem.upper[n:]
        if n == 0 or not _same(P, P.T) or not _same(R.T, -A[:n][:, n:]) or abs(A[n:][:, n:]).sum() != 0.0:
            return None
        free = np.isinf(low)
        known = np.isinf(high).all() and (free | (low == 0.0)).all()
        return cls(problem, P, R, problem.q[:n], problem.q[n:], free) if known else None


def _same(one: Matrix, other: Matrix) -> bool:
    return bool((abs(one - other)).sum() == 0.0)


@frozen(eq=False)
class Penalised:
    """The augmented Lagrangian, with terms for rows, then bounds."""

    saddle: Saddle
    low: Array
    high: Array
    sigma: float
    weight: float

    def values(self, x: Array) -> Array:
        """R x + d and x."""
        return np.concatenate([self.saddle.R @ x + self.saddle.d, x])

    def pulled(self, y: Array) -> Array:
        """The gradient of y'`values`."""
        m = self.saddle.d.size
        back: Array = self.saddle.R.T @ y[:m] + y[m:]
        return back

    def hessian(self, active: NDArray[np.bool_]) -> Matrix:
        """The Hessian where these rows and bounds are violated."""
        R, m = self.saddle.R, self.saddle.d.size
        part, diagonal = R[np.flatnonzero(active[:m])], self.sigma * active[m:] + 1.0 / self.weight
        penalised = self.sigma * (part.T @ part)
        if sp.issparse(R):
            return sp.csc_array(self.saddle.P + penalised + sp.diags_array(diagonal))
        return np.asfortranarray(self.saddle.P + penalised + np.diag(diagonal))

    def step(self, t: Array, dv: Array, slope: float, curvature: float) -> float:
        """Zero of the piecewise linear derivative along a direction.

        `t`: values plus multipliers over penalties, `dv`: their change.
        """
        with np.errstate(all="ignore"):
            enters = np.concatenate([(self.low - t) / dv, (self.high - t) / dv])
        rate = self.sigma * np.concatenate([-dv * np.abs(dv), dv * np.abs(dv)])
        outside = (t < self.low) | (t > self.high)
        after = np.flatnonzero((enters > 0.0) & np.isfinite(enters) & (rate != 0.0))
        after = after[np.argsort(enters[after], kind="stable")]
        at, curvature = np.append(0.0, enters[after]), curvature + self.sigma * float(dv[outside] @ dv[outside])
        curvatures = np.cumsum(np.append(curvature, rate[after]))
        slopes = slope + np.append(0.0, np.cumsum(curvatures[:-1] * np.diff(at)))
        last = np.count_nonzero(slopes < 0.0) - 1
        return float(at[last] - slopes[last] / curvatures[last] if curvatures[last] > 0.0 else at[last])


def guesses(saddle: Saddle, counts: Counts, factoring: Factoring) -> Iterator[tuple[State, Array]]:
    """Yield active sets and nearly solved points, one per change of multipliers, for a positive semidefinite P."""
    problem, m, n = saddle.problem, saddle.d.size, saddle.c.size
    low = np.append(np.zeros(m), problem.lower[:n])
    high = np.append(np.where(saddle.free, 0.0, np.inf), problem.upper[:n])
    x, y, accurate, weight = problem.near_zero[:n], np.zeros(m + n), 1.0, PENALTY_GROWTH
    values = np.append(saddle.R @ x + saddle.d, x)
    violated = values - np.clip(values, low, high)
    objective = abs(float(0.5 * x @ (saddle.P @ x) + saddle.c @ x))
    sigma = min(max(1.0, objective) / max(1.0, 0.5 * float(violated @ violated)), MOST_PENALTY)
    while True:
        found = _minimised(Penalised(saddle, low, high, sigma, weight), x, y, accurate, counts, factoring)
        if found is None:
            return
        x, t = found
        y = sigma * (t - np.clip(t, low, high))
        state = np.where(t < low, LOWER, np.where(t > high, UPPER, BETWEEN))
        # A violated row is active; other multipliers are zero.
        state[:m] = np.where(saddle.free | (state[:m] == LOWER), BETWEEN, LOWER)
        yield np.roll(state, n), problem.clipped(np.append(x, -y[:m]))
        accurate = accurate / PENALTY_GROWTH
        sigma, weight = (min(PENALTY_GROWTH * value, MOST_PENALTY) for value in (sigma, weight))


def _minimised(
    one: Penalised, x: Array, y: Array, accurate: float, counts: Counts, factoring: Factoring
) -> tuple[Array, Array] | None:
    saddle, centre, pieces, factor = one.saddle, x, b"", None
    for _ in range(STEPS_PER_CHANGE):
        t = one.values(x) + y / one.sigma
        force = one.sigma * (t - np.clip(t, one.low, one.high))
        smooth = saddle.P @ x + saddle.c
        gradient = smooth + (x - centre) / one.weight + one.pulled(force)
        terms = max(float(np.abs(smooth).max()), float(np.abs(saddle.c).max()), np.finfo(float).tiny)
        if float(np.abs(gradient).max()) <= max(accurate, 1e-13) * terms:
            break
        active = (t < one.low) | (t > one.high)
        key = active.tobytes()
        if factor is None or key != pieces:
            counts.factorizations += 1
            hessian, pieces = one.hessian(active), key
            factor = factoring.factor(hessian) if sp.issparse(hessian) else factor_cholesky(hessian)
        if factor is None:
            return None
        d = factor.solve(-gradient)
        dv = np.append(saddle.R @ d, d)
        slope = float(gradient @ d)
        if not slope < 0.0:
            break
        x = x + one.step(t, dv, slope, float(d @ (saddle.P @ d)) + float(d @ d) / one.weight) * d
    return x, one.values(x) + y / one.sigma
