"""The walk along a piecewise linear path: from corner to corner by the ratio test, each corner solved for afresh."""

from __future__ import annotations

from enum import Enum

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.parametric.basis import Basis
from problems.lcp.parametric.corner import LARGEST_LISTED, Ray, rays, way
from problems.lcp.parametric.stairs import Stairs

FLAT = 1e-11
"""A rate below this, relative to its row's entries and the direction, is rounding: it leads to no corner."""

TIE = 1e-10
"""Switches that vanish so near to each other, relative to the step and to t, vanish at once. On 10,000 problems of
integers (n <= 6) anything from 1e-13 to 1e-7 gives the same; 1e-6 is too loose for cond X = 1e6."""

ROUND_OFF = 1e-14
"""Relative to the terms of its row, what of a switch is zero whether it falls or not."""

NOISE = 1e-15
"""A few units in the last place: a rate of t below what these make of it is zero, and t stands still."""

INSIDE = 1e-9
"""How far outside its limits, relative to its row, rounding may put a variable before the path counts as lost."""


class Left(Enum):
    """What the next corner is."""

    CORNER = "a switch vanishes"
    RAY = "nothing stops it"


@frozen(eq=False)
class Corner:
    """What happened at a corner.

    Attributes
    ----------
    switches : tuple of int
        The indices of the pairs at a corner of their graphs.
    directions : list of Array of shape (n + 1,)
        Of all rays that leave, but the one that was come on; of the one taken alone where there are too many pieces.
    listed : bool
        Whether all are.
    """

    switches: tuple[int, ...]
    directions: list[Array]
    listed: bool


@define(eq=False)
class Walk:
    """A place on the path, and how it goes on from there.

    Attributes
    ----------
    problem : MixedLCP
        Dense.
    d : Array of shape (n,)
    stairs : Stairs
    state : State
        The piece of each pair.
    basis : Basis
        Its rows are those whose w is fixed, its columns the x that move, and t; but for the driver.
    driver : int
        What moves the path on: of pair i what moves on its piece, or t for i = n.
    value : float
        Of x_driver, or t, at the last corner; of w_driver the distance from its corner.
    sign : float
        Whether the driver grows or falls.
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
    x: Array = field(init=False)
    dx: Array = field(init=False)
    t: float = field(init=False, default=0.0)
    dt: float = field(init=False, default=0.0)
    still: bool = field(init=False, default=False)
    left: Array = field(init=False)
    _limits: Array = field(init=False)
    _y: Array = field(init=False)
    _dy: Array = field(init=False)
    _fixed: Array = field(init=False)
    tied: NDArray[np.intp] = field(init=False)
    _low: NDArray[np.bool_] = field(init=False)
    _scale: Array = field(init=False)

    def __attrs_post_init__(self) -> None:
        every = np.arange(self.problem.n)
        row = self.state.astype(np.intp) + 1
        self.moves_x = self.stairs.moves_x[row, every]
        self._fixed = self.stairs.fixed[row, every]
        tables = self.stairs.least, self.stairs.most, self.stairs.least_slope, self.stairs.most_slope
        self._limits = np.array([table[row, every] for table in tables])
        self.fixed_part = self.problem.q + self.matrix @ self._fixed

    # -- where it is, and where the next corner is ----------------------------------------------------------------

    def locate(self) -> None:
        """Solve for the corner, and for the direction in which the path leaves it."""
        n, basis, j = self.problem.n, self.basis, self.driver
        right = np.empty((n, 2), order="F")
        right[:, 0] = self.fixed_part
        if j == n or self.moves_x[j]:
            driven = basis.column(j)
            right[:, 0] += self.value * driven
            right[:, 1] = self.sign * driven
        else:
            right[:, 1] = 0.0
            right[j] -= self.value, self.sign
        z, left = basis.solve(right)
        self.left = np.zeros(n)
        self.left[basis.rows] = left[basis.rows, 0]
        whole = np.zeros((n + 1, 2))
        whole[basis.columns] = z[: basis.order]
        if j == n or self.moves_x[j]:
            whole[j] = self.value, self.sign
        self.t, self.dt = whole[n]
        moving = self.moves_x
        self.x = np.where(moving, whole[:n, 0], self._fixed)
        self.dx = np.where(moving, whole[:n, 1], 0.0)
        y = np.where(moving[:, None], whole[:n], left)
        if j < n and not moving[j]:
            slope = self.d[j] - basis.shares[j]
            y[j] = self.value + slope * self.t, self.sign + slope * self.dt
        self._y, self._dy = y.T
        self._scale = np.abs(whole).max(axis=0)
        self.still = False
        if j != n:
            of_t = np.abs(basis.inverse[basis.column_place[n], : basis.order])
            self.still = bool(abs(self.dt) <= NOISE * (of_t @ self.sizes[basis.rows]) * self._scale[1])

    def gaps(self) -> tuple[Array, Array]:
        """How far all that moves is from its lower limits, and then from its upper ones, and how fast that grows."""
        least, most, least_slope, most_slope = self._limits
        y, dy, t, dt = self._y, self._dy, self.t, self.dt
        return (
            np.concatenate([y - least - t * least_slope, most + t * most_slope - y]),
            np.concatenate([dy - dt * least_slope, dt * most_slope - dy]),
        )

    def find_tied(self) -> None:
        """Which switches vanish where it is."""
        gaps, _ = self.gaps()
        self._tie(self._vanishing(gaps, 0.0))

    def snap(self, pairs: tuple[int, ...]) -> None:
        """Put the x of pairs that are at a corner of their graphs there exactly: some are basic, and rounded."""
        at = list(pairs)
        corners = self.stairs.corner_x[:, at]
        self.x[at] = corners[np.abs(self.x[at] - corners).argmin(axis=0), np.arange(len(at))]

    def next_corner(self) -> tuple[Left, float]:
        """How far the driver goes until a switch vanishes, and which do then."""
        n, t, dt = self.problem.n, self.t, self.dt
        gaps, rates = self.gaps()
        row = np.where(self.moves_x, 1.0, self.sizes)
        flat = FLAT * row * self._scale[1]
        falling = np.flatnonzero((rates < -np.concatenate([flat, flat])) & np.isfinite(gaps))
        if falling.size == 0:
            return Left.RAY, np.inf
        steps = np.maximum(gaps[falling], 0.0) / -rates[falling]
        step = float(steps.min())
        reach = max(step, 0.0 if self.still else abs(t + step * dt) / abs(dt))
        near = falling[steps <= step + TIE * reach]
        still = self._vanishing(gaps + step * rates, step)
        # The driver has left its corner, however short the step was.
        both = np.union1d(near, still[still % n != self.driver])
        self._tie(both)
        return Left.CORNER, step

    def _terms(self, step: float) -> Array:
        """What a gap is a difference of, for all that moves."""
        row = np.where(self.moves_x, 1.0, self.sizes)
        size: Array = row * (self._scale[0] + step * self._scale[1])
        return size + np.where(self.moves_x, 0.0, np.abs(self.problem.q))

    def _vanishing(self, gaps: Array, step: float) -> NDArray[np.intp]:
        terms = self._terms(step)
        with np.errstate(invalid="ignore"):
            return np.flatnonzero(gaps <= ROUND_OFF * np.concatenate([terms, terms]))

    def _tie(self, gaps: NDArray[np.intp]) -> None:
        n = self.problem.n
        _, first = np.unique(gaps % n, return_index=True)
        gaps = gaps[first]
        self.tied, self._low = gaps % n, gaps < n

    def inside(self) -> bool:
        """Whether all that moves is within its limits, but for rounding."""
        gaps, _ = self.gaps()
        terms = self._terms(0.0)
        return bool((gaps >= -INSIDE * np.concatenate([terms, terms])).all())

    # -- round the corner -----------------------------------------------------------------------------------------

    def turn(self) -> Corner | None:
        """Take the corner found; what it was, or None where no way on was found.

        Raises
        ------
        SingularBasisError
            If the basis behind it is singular to working precision.
        """
        if self.tied.size == 1:
            i = int(self.tied[0])
            self._pivot(i)
            return Corner((i,), [], True)
        return self._turn_tied()

    def _pivot(self, i: int) -> None:
        """What moves of pair i leaves the basis, the driver enters, and the complement drives."""
        basis, j, n = self.basis, self.driver, self.problem.n
        low = bool(self._low[self.tied == i][0])
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
        self._drive(i, low)

    def _drive(self, i: int, low: bool) -> None:
        """Pair i drives, away from the corner to which it came from above its limit, or from below."""
        self.driver, self.sign = i, 1.0 if low else -1.0
        self.value = float(self._limits[0 if low else 1][i]) if self.moves_x[i] else 0.0

    def _slope(self, i: int) -> float:
        return float(self.stairs.fixed_slope[self.state[i] + 1, i])

    def _switch(self, i: int, low: bool) -> None:
        """Pair i is on the piece beyond its lower, or upper, limit."""
        up = low != bool(self.moves_x[i])
        self.state[i] += 1 if up else -1
        row = int(self.state[i]) + 1
        self.moves_x[i] = self.stairs.moves_x[row, i]
        tables = self.stairs.least, self.stairs.most, self.stairs.least_slope, self.stairs.most_slope
        for limit, table in zip(self._limits, tables):
            limit[i] = table[row, i]
        before, self._fixed[i] = self._fixed[i], self.stairs.fixed[row, i]
        if before != self._fixed[i]:
            self.fixed_part = self.problem.q + self.matrix @ self._fixed

    def _turn_tied(self) -> Corner | None:
        tied, low = self.tied, self._low
        S, r, along = self.small()
        on = way(S, r)
        every = tied.size <= LARGEST_LISTED
        found = [self._direction(ray, along) for ray in rays(S, r)] if every else []
        if on is None:
            return Corner(tuple(tied.tolist()), found, every) if every else None
        self.switch_tied(np.isin(np.arange(tied.size), on.switched))
        i = int(tied[on.driver])
        self.rebase(i, bool(low[on.driver]))
        self._drive(i, bool(low[on.driver]))
        return Corner(tuple(tied.tolist()), found, every)

    def switch_tied(self, which: NDArray[np.bool_]) -> None:
        """Of the switches that vanish some are passed."""
        for i, low in zip(self.tied[which], self._low[which]):
            self._switch(int(i), bool(low))

    def rebase(self, driver: int, low: bool = True) -> None:
        """Rows and columns anew, from the pieces and the driver; a w that drives leaves its lower corner, or upper.

        Raises
        ------
        SingularBasisError
            If their block is singular.
        """
        n = self.problem.n
        moving = np.flatnonzero(self.moves_x)
        shares = self.basis.shares
        shares[:] = self.d
        shares[moving] -= self.stairs.fixed_slope[self.state[moving] + 1, moving]
        rows = moving.tolist()
        columns = [i for i in rows if i != driver] + ([n] if driver != n else [])
        if driver < n and not self.moves_x[driver]:
            rows.append(driver)
            shares[driver] -= self._limits[2 if low else 3][driver]
        self.basis.reset(rows, columns)

    def small(self) -> tuple[Array, Array, Array]:
        """S and r of the small LCP, and how (x, t) moves with each of its variables."""
        n, basis, tied = self.problem.n, self.basis, self.tied
        m = tied.size
        sign = np.where(self._low, 1.0, -1.0)
        right = np.zeros((n, m), order="F")
        for k, i in enumerate(tied):
            if self.moves_x[i]:
                right[i, k] = -sign[k]
            else:
                right[:, k] = sign[k] * self.matrix[:, i]
        z, left = basis.solve(right)
        along = np.zeros((n + 1, m + 1))
        along[basis.columns, :m] = z[: basis.order]
        along[:n, m], along[n, m] = self.dx, self.dt
        moving = self.moves_x[tied]
        rates = np.where(moving[:, None], along[tied, :m], left[tied])
        rates = np.column_stack([rates, self._dy[tied]])
        slopes = np.where(self._low, self._limits[2][tied], self._limits[3][tied])
        rates = sign[:, None] * (rates - slopes[:, None] * along[n])
        fixed = np.flatnonzero(~moving)
        along[tied[fixed], fixed] = sign[fixed]
        rates[:, m] = np.minimum(rates[:, m], 0.0)
        return rates[:, :m], rates[:, m], along

    def _direction(self, ray: Ray, along: Array) -> Array:
        direction: Array = along @ np.append(ray.grown, ray.driven)
        return direction / np.linalg.norm(direction)
