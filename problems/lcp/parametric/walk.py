"""The walk along a piecewise linear path: from corner to corner by the ratio test, each corner solved for afresh."""

from __future__ import annotations

from enum import Enum

import numpy as np
from attrs import define, field
from numpy.typing import NDArray

from continuation.arrays import Array, largest
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.parametric.basis import Basis
from problems.lcp.parametric.stairs import Stairs

FLAT = 1e-11
"""A rate below this, relative to its row's entries and the direction, is rounding: it leads to no corner."""

SWITCH_TIE = 1e-10
"""Switches that vanish so near to each other, relative to the step and to t, vanish at once. On 10,000 problems of
integers (n <= 6) anything from 1e-13 to 1e-7 gives the same; 1e-6 is too loose for cond X = 1e6."""

ZERO_SWITCH = 1e-14
"""Relative to the terms of its row, what of a switch is zero whether it falls or not."""

RATE_NOISE = 1e-15
"""A few units in the last place: a rate of t below what these make of it is zero, and t stands still."""

SLOW_RATE = 1e-6
"""Whether a rate of t is rounding is looked at where it is this much smaller than the largest."""

OUTSIDE_LIMITS = 1e-9
"""How far outside its limits, relative to its row, rounding may put a variable before the path counts as lost."""


class Left(Enum):
    """What the next corner is."""

    CORNER = "a switch vanishes"
    RAY = "nothing stops it"


@define(eq=False)
class Walk:
    """A place on the path, and how it goes on from there.

    `problem`: Dense. `d` of shape (n,). `state`: The piece of each pair. `basis`: Its rows are those whose w is fixed,
    its columns the x that move, and t; but for the driver. `driver`: What moves the path on: of pair i what moves on
    its piece, or t for i = n. `value`: Of x_driver, or t, at the last corner; of w_driver the distance from its corner.
    `sign`: Whether the driver grows or falls. `matrix`, of shape (n, n): A, in Fortran's order. `sizes`, of shape (n,):
    The largest entry of each row of [A, d]. `u`, of shape (2, n + 1): (x, t) at the last corner, and how it moves. `t`,
    `dt`: Its last numbers. `still`: Whether t stands still. `gaps`, `rates`, of shape (2, n): How far all that moves is
    from its lower limits, and from its upper ones, and how fast that grows. `tied`: The pairs at the next corner, and
    in `low` whether at their lower limit. `limits`, `slopes`, of shape (2, n): The limits of all that moves at t = 0,
    and how they move with t: None if none does. `dy`, `scale`, `terms`: How all that moves does so; the largest number
    of u and of its rate; the sizes of the entries of each row. `step`: How far the driver goes to the next corner.
    `degenerate`: Whether several switches have vanished at once before.
    """

    problem: MixedLCP
    d: Array
    stairs: Stairs
    state: State
    basis: Basis
    driver: int
    value: float
    sign: float
    matrix: Array
    sizes: Array
    fixed_part: Array = field(init=False)
    moves_x: NDArray[np.bool_] = field(init=False)
    u: Array = field(init=False)
    t: float = field(init=False, default=0.0)
    dt: float = field(init=False, default=0.0)
    still: bool = field(init=False, default=False)
    gaps: Array = field(init=False)
    rates: Array = field(init=False)
    tied: NDArray[np.intp] = field(init=False)
    low: NDArray[np.bool_] = field(init=False)
    limits: Array = field(init=False)
    slopes: Array | None = field(init=False)
    _fixed: Array = field(init=False)
    terms: Array = field(init=False)
    _constant: Array = field(init=False)
    dy: Array = field(init=False)
    scale: list[float] = field(init=False)
    step: float = field(init=False, default=0.0)
    degenerate: bool = field(init=False, default=False)

    def __attrs_post_init__(self) -> None:
        every = np.arange(self.problem.n)
        row = self.state.astype(np.intp) + 1
        stairs = self.stairs
        self.moves_x = stairs.moves_x[row, every]
        self._fixed = stairs.fixed[row, every]
        self.limits = np.array([stairs.least[row, every], stairs.most[row, every]])
        slopes = np.array([stairs.least_slope[row, every], stairs.most_slope[row, every]])
        self.slopes = slopes if stairs.levels.any() else None
        self.fixed_part = self.problem.q + self.matrix @ self._fixed
        # What a gap is a difference of: entries of its row times the largest number, and q; of x that number itself.
        self.terms = np.where(self.moves_x, 1.0, self.sizes)
        self._constant = np.where(self.moves_x, 0.0, np.abs(self.problem.q))

    # -- where it is, and where the next corner is ----------------------------------------------------------------

    def locate(self) -> None:
        """Solve for the corner, and for the direction in which the path leaves it."""
        n, basis, j = self.problem.n, self.basis, self.driver
        by_x = j == n or bool(self.moves_x[j])
        right = np.zeros((n, 2), order="F")
        right[:, 0] = self.fixed_part
        if by_x:
            driven = basis.column(j)
            right[:, 0] += self.value * driven
            right[:, 1] = self.sign * driven
        else:
            right[j] -= self.value, self.sign
        z, left = basis.solve(right)
        self.u = whole = np.zeros((2, n + 1))
        if basis.order:
            whole[0, basis.columns], whole[1, basis.columns] = z[: basis.order, 0], z[: basis.order, 1]
        if by_x:
            whole[:, j] = self.value, self.sign
        self.t, self.dt = whole[:, n].tolist()
        y = np.where(self.moves_x, whole[:, :n], left.T)
        if not by_x:
            slope = self.d[j] - basis.shares[j]
            y[:, j] = self.value + slope * self.t, self.sign + slope * self.dt
        self.dy = dy = y[1]
        self.scale = [largest(whole[0]), largest(whole[1])]
        self.still = j != n and abs(self.dt) <= SLOW_RATE * self.scale[1] and self._stands()
        # Of what does not move by x nothing is in z: there x is what is fixed.
        whole[0, :n] += self._fixed
        if self.degenerate:
            self._settle(y)
        self.gaps, self.rates = y[0] - self.limits, np.empty((2, n))
        self.rates[0], self.rates[1] = dy, -dy
        if self.slopes is not None:
            self.gaps -= self.t * self.slopes
            moved = self.dt * self.slopes
            self.rates[0] -= moved[0]
            self.rates[1] += moved[1]
        np.negative(self.gaps[1], out=self.gaps[1])

    def _settle(self, y: Array) -> None:
        """What is basic and stays at its limit, as x of columns that are alike, is there exactly."""
        for limit in self.limits:
            near = self.moves_x & (np.abs(y[0] - limit) <= ZERO_SWITCH * self.scale[0])
            y[0, near] = self.u[0, :-1][near] = limit[near]
            near &= np.abs(y[1]) <= FLAT * self.scale[1]
            y[1, near] = self.u[1, :-1][near] = 0.0

    def _stands(self) -> bool:
        """Whether the rate of t is no more than rounding."""
        basis = self.basis
        of_t = np.abs(basis.inverse[basis.column_place[self.problem.n], : basis.order])
        return bool(abs(self.dt) <= RATE_NOISE * (of_t @ self.sizes[basis.rows]) * self.scale[1])

    def find_tied(self) -> None:
        """Which switches vanish where it is."""
        self._tie(self.gaps <= ZERO_SWITCH * self._terms(0.0))

    def next_corner(self) -> tuple[Left, float]:
        """How far the driver goes until a switch vanishes, and which do then."""
        gaps, rates = self.gaps.ravel(), self.rates.ravel()
        falling = np.flatnonzero(self.rates < -FLAT * self.scale[1] * self.terms)
        if falling.size == 0:
            return Left.RAY, np.inf
        steps = np.maximum(gaps[falling], 0.0) / -rates[falling]
        step = float(steps.min())
        if step == np.inf:
            return Left.RAY, step
        reach = max(step, 0.0 if self.still else abs(self.t + step * self.dt) / abs(self.dt))
        self.step = step
        vanishing = self.gaps + step * self.rates <= ZERO_SWITCH * self._terms(step)
        # The driver has left its corner, however short the step was.
        if self.driver < self.problem.n:
            vanishing[:, self.driver] = False
        vanishing.ravel()[falling[steps <= step + SWITCH_TIE * reach]] = True
        self._tie(vanishing)
        return Left.CORNER, step

    def _terms(self, step: float) -> Array:
        return (self.scale[0] + step * self.scale[1]) * self.terms + self._constant

    def _tie(self, vanishing: NDArray[np.bool_]) -> None:
        self.tied = np.flatnonzero(vanishing[0] | vanishing[1])
        self.low = vanishing[0, self.tied]

    def inside(self) -> bool:
        """Whether all that moves is within its limits, but for rounding."""
        return bool((self.gaps >= -OUTSIDE_LIMITS * self._terms(0.0)).all())

    # -- round the corner -----------------------------------------------------------------------------------------

    def pivot(self, i: int) -> None:
        """What moves of pair i leaves the basis, the driver enters, and the complement drives."""
        basis, j, n = self.basis, self.driver, self.problem.n
        low = bool(self.low[self.tied == i][0])
        driver_x = j == n or bool(self.moves_x[j])
        leaving_x = bool(self.moves_x[i])
        self._switch(i, low)
        if i == j:
            # From one corner of its graph to the other: what is basic stays so.
            if not leaving_x:
                basis.share(i, self.d[i] - self._slope(i))
        elif driver_x and leaving_x:
            basis.exchange_column(i, j)
        elif driver_x:
            basis.share(i, self.d[i] - self._slope(i))
            basis.enter_both(i, j)
        elif leaving_x:
            basis.leave_both(j, i)
            basis.share(j, self.d[j])
        else:
            basis.share(i, self.d[i] - self._slope(i))
            basis.exchange_row(j, i)
            basis.share(j, self.d[j])
        self.drive(i, low)

    def drive(self, i: int, low: bool) -> None:
        """Pair i drives, away from the corner to which it came from above its limit, or from below."""
        self.driver, self.sign = i, 1.0 if low else -1.0
        self.value = float(self.limits[0 if low else 1, i]) if self.moves_x[i] else 0.0

    def _slope(self, i: int) -> float:
        return float(self.stairs.fixed_slope[self.state[i] + 1, i])

    def _switch(self, i: int, low: bool) -> None:
        """Pair i is on the piece beyond its lower, or upper, limit."""
        up = low != bool(self.moves_x[i])
        self.state[i] += 1 if up else -1
        row = int(self.state[i]) + 1
        self.moves_x[i] = self.stairs.moves_x[row, i]
        stairs = self.stairs
        self.limits[:, i] = stairs.least[row, i], stairs.most[row, i]
        if self.slopes is not None:
            self.slopes[:, i] = stairs.least_slope[row, i], stairs.most_slope[row, i]
        self.terms[i], self._constant[i] = (
            (1.0, 0.0) if self.moves_x[i] else (self.sizes[i], abs(float(self.problem.q[i])))
        )
        before, self._fixed[i] = self._fixed[i], self.stairs.fixed[row, i]
        if before != self._fixed[i]:
            self.fixed_part = self.problem.q + self.matrix @ self._fixed

    def switch_tied(self, which: NDArray[np.bool_]) -> None:
        """Of the switches that vanish some are passed."""
        for i, low in zip(self.tied[which], self.low[which]):
            self._switch(int(i), bool(low))

    def rebase(self, driver: int, low: bool = True) -> None:
        """Rows and columns anew, from the pieces and the driver; a w that drives leaves its lower corner, or upper.

        Raises `SingularBasisError` if their block is singular.
        """
        n = self.problem.n
        moving = np.flatnonzero(self.moves_x)
        shares = self.basis.shares
        shares[:] = self.d
        shares[moving] -= self.stairs.fixed_slope[self.state[moving] + 1, moving]
        columns = np.append(moving[moving != driver], np.full(int(driver != n), n))
        rows = moving
        if driver < n and not self.moves_x[driver]:
            rows = np.append(rows, driver)
            shares[driver] -= 0.0 if self.slopes is None else self.slopes[0 if low else 1, driver]
        self.basis.reset(rows, columns)
