"""The walk from corner to corner by ratio tests."""

from __future__ import annotations

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from continuation.arrays import SIX_DIGITS, Array, largest
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.parametric.basis import Basis
from problems.lcp.parametric.stairs import Stairs

FLAT = 1e-11
"""Smaller relative rates are rounding. Switches so close, relative to the step and t, vanish together: on 10,000
integer problems 1e-13 to 1e-7 give the same; 1e-6 is too loose for cond X = 1e6."""

ZERO_SWITCH = 1e-14
"""Smaller switches and rates of t, relative to their row's terms, are zero."""

OUTSIDE_LIMITS = 1e-9
"""Largest violation of limits by rounding, relative to the row."""


@define(eq=False)
class Walk:
    """A point of the path, and its continuation.

    `state`: the piece of each pair. `driver`: the variable that moves on, that of pair i on its piece, or t for i = n.
    `value`: x_driver or t at the last corner, or the distance of w_driver from its corner. `sign`: whether the driver
    grows (1) or falls (-1). `moves_x`: whether x moves and w is fixed. `basis`: rows of fixed w, columns of moving x
    and t, without the driver. `shares`: the column of t. `u`: (x, t) at the last corner and its derivative. `gaps`,
    `rates`: distances from lower and upper limits, and derivatives. `tied`: the pairs at the next corner; `low`:
    whether at lower limits. `noise`: the scales of gaps and rates.
    """

    problem: MixedLCP
    d: Array
    stairs: Stairs
    state: State
    driver: int
    value: float
    sign: float
    sizes: Array = field(init=False)
    moves_x: NDArray[np.bool_] = field(init=False)
    basis: Basis = field(init=False)
    shares: Array = field(init=False)
    u: Array = field(init=False)
    t: float = field(init=False, default=0.0)
    dt: float = field(init=False, default=0.0)
    still: bool = field(init=False, default=False)
    slopes: Array = field(init=False)
    gaps: Array = field(init=False)
    rates: Array = field(init=False)
    tied: NDArray[np.intp] = field(init=False)
    low: NDArray[np.bool_] = field(init=False)
    terms: Array = field(init=False)
    noise: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        self.sizes = np.maximum(np.abs(self.problem.A).max(axis=1, initial=0.0), np.abs(self.d))

    def locate(self) -> bool:
        """Solve for corner and direction; return whether limits hold. Raises `SingularBasisError`."""
        n, j, A = self.problem.n, self.driver, self.problem.A
        row, every = self.state.astype(np.intp) + 1, np.arange(n)
        self.moves_x = self.stairs.moves_x[row, every]
        fixed, slope, *ends = self.stairs.values[:, row, every]
        limits, self.slopes = np.array(ends[:2]), np.array(ends[2:])
        self.terms = np.where(self.moves_x, 1.0, self.sizes)
        by_x, self.shares = j == n or bool(self.moves_x[j]), self.d - slope
        rows = np.flatnonzero(self.moves_x)
        columns = np.append(rows[rows != j], np.full(int(j != n), n))
        if not by_x:
            # The driver's w is its distance from the corner.
            rows = np.append(rows, j)
            self.shares[j] -= self.slopes[0 if self.sign > 0.0 else 1, j]
        block = np.empty((n, columns.size), order="F")
        block[:, : columns.size - (j != n)] = A[:, columns[: columns.size - (j != n)]]
        if j != n:
            block[:, -1] = self.shares
        self.basis = Basis.of(rows, columns, block)
        right = np.zeros((n, 2), order="F")
        right[:, 0] = self.problem.q + A @ fixed
        if by_x:
            driven = self.shares if j == n else A[:, j]
            right[:, 0] += self.value * driven
            right[:, 1] = self.sign * driven
        else:
            right[j] -= self.value, self.sign
        z, left = self.basis.solve(right)
        self.u = whole = np.zeros((2, n + 1))
        whole[:, columns] = z.T
        if by_x:
            whole[:, j] = self.value, self.sign
        self.t, self.dt = whole[:, n].tolist()
        y = np.where(self.moves_x, whole[:, :n], left.T)
        if not by_x:
            y[:, j] = np.array([self.value, self.sign]) + (self.d[j] - self.shares[j]) * whole[:, n]
        place, motion = largest(whole[0]), largest(whole[1])
        self.noise = np.array([[place], [motion]]) * self.terms
        self.noise[0] += np.where(self.moves_x, 0.0, np.abs(self.problem.q))
        self.still = False
        # Rounding may be all that moves a slow t.
        if j != n and abs(self.dt) <= SIX_DIGITS * motion:
            of_t = np.abs(self.basis.inverse((columns == n).astype(float), transposed=1)) @ self.sizes[self.basis.rows]
            self.still = bool(abs(self.dt) <= ZERO_SWITCH * of_t * motion)
        whole[0, :n] += fixed
        self.gaps, self.rates = y[0] - limits - self.t * self.slopes, y[1] - self.dt * self.slopes
        np.negative(self.gaps[1], out=self.gaps[1])
        np.negative(self.rates[1], out=self.rates[1])
        return bool((self.gaps >= -OUTSIDE_LIMITS * self.noise[0]).all())

    def find_tied(self, vanishing: NDArray[np.bool_] | None = None) -> None:
        """Find the switches that vanish, here or as told."""
        found = self.gaps <= ZERO_SWITCH * self.noise[0] if vanishing is None else vanishing
        self.tied = np.flatnonzero(found[0] | found[1])
        self.low = found[0, self.tied]

    def next_corner(self) -> float:
        """The driver's way to the next corner, perhaps infinite; sets `tied`."""
        gaps, rates = self.gaps.ravel(), self.rates.ravel()
        falling = np.flatnonzero(self.rates < -FLAT * self.noise[1])
        steps = np.maximum(gaps[falling], 0.0) / -rates[falling]
        step = float(steps.min(initial=np.inf))
        if step == np.inf:
            return step
        reach = max(step, 0.0 if self.still else abs(self.t + step * self.dt) / abs(self.dt))
        vanishing = self.gaps + step * self.rates <= ZERO_SWITCH * (self.noise[0] + step * self.noise[1])
        if self.driver < self.problem.n:
            vanishing[:, self.driver] = False
        vanishing.ravel()[falling[steps <= step + FLAT * reach]] = True
        self.find_tied(vanishing)
        return step

    def snap(self, pairs: tuple[int, ...]) -> None:
        """Set x_i of these pairs to the nearer corner, against round-off."""
        at = list(pairs)
        corners = self.stairs.corner_x[:, at]
        self.u[0, at] = corners[np.abs(self.u[0, at] - corners).argmin(axis=0), np.arange(len(at))]

    def drive(self, i: int, low: bool) -> None:
        """Let pair i drive away from its corner."""
        self.driver, self.sign = i, 1.0 if low else -1.0
        row = int(self.state[i]) + 1
        self.value = float(self.stairs.values[2 if low else 3, row, i]) if self.stairs.moves_x[row, i] else 0.0

    def switch(self, which: NDArray[np.bool_]) -> None:
        """Move pairs that switch to the pieces beyond."""
        for i, low in zip(self.tied[which].tolist(), self.low[which].tolist()):
            self.state[i] += 1 if low != bool(self.moves_x[i]) else -1
