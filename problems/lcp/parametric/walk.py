"""The walk along a piecewise linear path: from corner to corner by the ratio test, each corner solved for afresh."""

from __future__ import annotations

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from continuation.arrays import Array, largest
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.parametric.basis import Basis
from problems.lcp.parametric.stairs import Stairs

FLAT = 1e-11
"""A rate below this, relative to its row's entries and the direction, is rounding: it leads to no corner. Switches that
vanish so near to each other, relative to the step and to t, vanish at once: on 10,000 problems of integers (n <= 6)
anything from 1e-13 to 1e-7 gives the same; 1e-6 is too loose for cond X = 1e6."""

ZERO_SWITCH = 1e-14
"""Relative to the terms of its row, what of a switch is zero whether it falls or not; and what of a rate of t is, which
then stands still."""

SLOW_RATE = 1e-6
"""Whether a rate of t is rounding is looked at where it is this much smaller than the largest, and t does not drive."""

OUTSIDE_LIMITS = 1e-9
"""How far outside its limits, relative to its row, rounding may put a variable before the path counts as lost."""


@define(eq=False)
class Walk:
    """A place on the path, and how it goes on from there.

    `problem`: Dense. `d` of shape (n,). `state`: The piece of each pair. `driver`: What moves the path on: of pair i
    what moves on its piece, or t for i = n. `value`: Of x_driver, or t, at the last corner; of w_driver the distance
    from its corner. `sign`: Whether the driver grows or falls. `sizes`, of shape (n,): The largest entry of each row of
    [A, d]. `moves_x`, of shape (n,): Where x moves, and w is fixed. `basis`: Its rows are those whose w is fixed, its
    columns the x that move, and t; but for the driver. `shares`, of shape (n,): The column of t. `u`, of shape
    (2, n + 1): (x, t) at the last corner, and how it moves. `t`, `dt`: Its last numbers. `still`: Whether t stands
    still. `slopes`, of shape (2, n): How the limits of all that moves move with t. `gaps`, `rates`, of shape (2, n):
    How far all that moves is from its lower limits, and from its upper ones, and how fast that grows. `tied`: The pairs
    at the next corner, and in `low` whether at their lower limit. `terms`: The sizes of the entries of each row.
    `noise`, of shape (2, n): What gaps and rates are differences of.
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

    # -- where it is, and where the next corner is ----------------------------------------------------------------

    def locate(self) -> bool:
        """Solve for the corner, and for the direction in which the path leaves it; whether that is within its limits.

        Raises `SingularBasisError` if the equations of the pieces are dependent.
        """
        n, j, A = self.problem.n, self.driver, self.problem.A
        row, every = self.state.astype(np.intp) + 1, np.arange(n)
        self.moves_x = self.stairs.moves_x[row, every]
        fixed, slope, *ends = self.stairs.values[:, row, every]
        limits, self.slopes = np.array(ends[:2]), np.array(ends[2:])
        # What a gap is a difference of: entries of its row times the largest number, and q; of x that number itself.
        self.terms = np.where(self.moves_x, 1.0, self.sizes)
        by_x, self.shares = j == n or bool(self.moves_x[j]), self.d - slope
        rows = np.flatnonzero(self.moves_x)
        columns = np.append(rows[rows != j], np.full(int(j != n), n))
        if not by_x:
            # Its w is as far from its corner as the driver has gone, and the corner moves with t.
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
        if j != n and abs(self.dt) <= SLOW_RATE * motion:
            # Whether the rate of t is no more than rounding.
            of_t = np.abs(self.basis.row_of_inverse(n)) @ self.sizes[self.basis.rows]
            self.still = bool(abs(self.dt) <= ZERO_SWITCH * of_t * motion)
        # Of what does not move by x nothing is in z: there x is what is fixed.
        whole[0, :n] += fixed
        self.gaps, self.rates = y[0] - limits - self.t * self.slopes, y[1] - self.dt * self.slopes
        np.negative(self.gaps[1], out=self.gaps[1])
        np.negative(self.rates[1], out=self.rates[1])
        return bool((self.gaps >= -OUTSIDE_LIMITS * self.noise[0]).all())

    def find_tied(self, vanishing: NDArray[np.bool_] | None = None) -> None:
        """Which switches vanish: where it is, or at the next corner those that are told."""
        found = self.gaps <= ZERO_SWITCH * self.noise[0] if vanishing is None else vanishing
        self.tied = np.flatnonzero(found[0] | found[1])
        self.low = found[0, self.tied]

    def next_corner(self) -> float:
        """How far the driver goes until a switch vanishes, and which do then; infinite where nothing stops it."""
        gaps, rates = self.gaps.ravel(), self.rates.ravel()
        falling = np.flatnonzero(self.rates < -FLAT * self.noise[1])
        steps = np.maximum(gaps[falling], 0.0) / -rates[falling]
        step = float(steps.min(initial=np.inf))
        if step == np.inf:
            return step
        reach = max(step, 0.0 if self.still else abs(self.t + step * self.dt) / abs(self.dt))
        vanishing = self.gaps + step * self.rates <= ZERO_SWITCH * (self.noise[0] + step * self.noise[1])
        # The driver has left its corner, however short the step was.
        if self.driver < self.problem.n:
            vanishing[:, self.driver] = False
        vanishing.ravel()[falling[steps <= step + FLAT * reach]] = True
        self.find_tied(vanishing)
        return step

    def snap(self, pairs: tuple[int, ...]) -> None:
        """Put the x of pairs that are at a corner of their graphs there exactly: some are basic, and rounded."""
        at = list(pairs)
        corners = self.stairs.corner_x[:, at]
        self.u[0, at] = corners[np.abs(self.u[0, at] - corners).argmin(axis=0), np.arange(len(at))]

    # -- round the corner -----------------------------------------------------------------------------------------

    def drive(self, i: int, low: bool) -> None:
        """Pair i drives, away from the corner to which it came from above its limit, or from below."""
        self.driver, self.sign = i, 1.0 if low else -1.0
        row = int(self.state[i]) + 1
        self.value = float(self.stairs.values[2 if low else 3, row, i]) if self.stairs.moves_x[row, i] else 0.0

    def switch(self, which: NDArray[np.bool_]) -> None:
        """Of the switches that vanish some are passed: their pairs are on the pieces beyond."""
        for i, low in zip(self.tied[which].tolist(), self.low[which].tolist()):
            self.state[i] += 1 if low != bool(self.moves_x[i]) else -1
