"""The KKT homotopy of Dutta, Das and Jana, with bounds of any kind: 2 to 5 unknowns an index, solved with n + 1."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array, Matrix
from continuation.linear import BorderedSystem
from continuation.point.linearization import Linearization
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.homotopies.cores import Recent, in_full
from problems.lcp.homotopies.interior import OwnMetric, RelativeMetric, convolved, longest_step, observed
from problems.lcp.homotopies.kkt_system import KKTSystem, factor_kkt
from problems.lcp.homotopies.quadratics import exact_end, kkt_form
from problems.lcp.homotopies.references import DUTTA_DAS_JANA
from problems.lcp.homotopies.rows import Rows
from problems.lcp.homotopies.starts import Start, kkt_start, natural_units, require_interior
from problems.lcp.quadratic.engine import ByProducts
from problems.options import quiet

GIVE = 0.1
"""In natural units, how far an equation gives way to its multiplier at lambda = 1.

On 48 monotone problems with all kinds of bounds (n = 10, 50) the paths take 32 factorisations, 36 with 1, 34 with 0.01,
54 with 10.
"""


@frozen(eq=False, slots=False, init=False)
class KKTHomotopy:
    """The optimality conditions of min x'(A x + q), x >= 0, A x + q >= 0, relaxed by lambda from 1 to 0.

    With y = (x, z1, z2), w = A x + q + lambda rho, rho = w0 - (A x0 + q) and products componentwise::

        H1 = (1 - lambda) [(A + A') x + q - z1 - A' z2] + lambda (x - x0)
        H2 = z1 * x - lambda z1_0 * x0
        H3 = z2 * w - lambda z2_0 * w0

    The path ends at a KKT point. Where A is row sufficient that solves the LCP; elsewhere it may not: check it.

    With bounds what is minimised is (x - l) w where there is a lower one alone, (x - u) w an upper one, and in a box
    (x - l) s + (u - x) t with w = s - t, s, t >= 0. There z1 has a number for each bound, w and z2 are at most zero
    where there is an upper bound alone, and in a box t is an unknown and u - l - z2 its multiplier::

        H1 = (1 - lambda) [A x + q + A'(x - end - z2) - z1 of lower + z1 of upper bounds] + lambda (x - x0)
        H3 = z2 * (w + t) - lambda z2_0 * s0,    H4 = (u - l - z2) * t - lambda (u - l - z2_0) * t0

    Where there is no bound w = 0 is asked for, H3 = w + lambda give (z2 - z2_0). So there are 3, 5 or 2 unknowns an
    index, and one matrix of order n is factored whatever the bounds are.

    Parameters
    ----------
    problem : MixedLCP
        Dense, sparse or, as sparse, banded.
    x0 : array_like, shape (n,), optional
        Between the bounds, for an LCP positive; feasible or not. Default: `default_start`.
    z1, z2 : array_like, optional
        Multipliers: z1 positive, one a finite bound, lower ones first; z2 of shape (n,), positive, with an upper bound
        alone negative, in a box between 0 and u - l. Default for an LCP: ones, as in the paper, where x0 is given and
        strictly feasible; else such that all products x0 z1 and w0 z2 are equal.
    w0 : array_like, optional
        Positive, one a finite bound: |w|, in a box s and t. Default for an LCP: A x0 + q where that is positive, which
        is the paper's start; else max(A x0 + q, 0) + max |q|.
    structure : Structure, optional
        That of the problem, to share between starts what was found out about A.
    refine : bool
        Whether bordered solves are corrected to round-off. Without it a path takes a third less time, and its points
        are good enough for a loose tolerance.

    Raises
    ------
    TypeError
        If `problem` is no LCP.
    ValueError
        If a vector is not finite, not of the length or not inside what is said above; the message names it.

    References
    ----------
    Dutta, Das and Jana, "Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity Problems". The
    start off the feasible set is that of infeasible interior-point methods.
    """

    problem: MixedLCP | LCP
    origin: Start
    structure: Structure
    refine: bool = True
    problem_class: ClassVar[str] = "linear complementarity problems"
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (DUTTA_DAS_JANA,)
    metric: ClassVar[OwnMetric] = OwnMetric()
    _recent: Recent[KKTSystem] = field(factory=Recent, init=False, repr=False)

    def __init__(
        self,
        problem: MixedLCP,
        x0: Any = None,
        z1: Any = None,
        z2: Any = None,
        w0: Any = None,
        *,
        structure: Structure | None = None,
        refine: bool = True,
    ) -> None:
        require_interior(problem)
        origin = kkt_start(problem, x0, z1, z2, w0)
        self.__attrs_init__(problem, origin, structure if structure is not None else Structure(problem), refine)

    @property
    def n(self) -> int:
        """The order of A: for an LCP y has 3n components."""
        return self.problem.n

    @cached_property
    def rows(self) -> Rows:
        """What the rows ask for."""
        return Rows(self.problem)

    @cached_property
    def own_metric(self) -> RelativeMetric:
        """Relative changes of the distances from what bounds the unknowns."""
        if self.problem.standard:
            return RelativeMetric()
        rows, m = self.rows, self.rows.sides.index.size
        above, t = np.full(m, np.inf), np.full(rows.boxed.size, np.inf)
        lower, upper = rows.bounds
        return RelativeMetric(
            lower=np.concatenate([self.problem.lower, np.zeros(m), lower, np.zeros(t.size)]),
            upper=np.concatenate([self.problem.upper, above, upper, t]),
            unit=self._units[0],
        )

    @cached_property
    def _units(self) -> tuple[float, float]:
        return natural_units(self.problem)

    @cached_property
    def give(self) -> float:
        """How far an equation gives way, at lambda = 1, to a unit of its multiplier."""
        return GIVE * self._units[1] / self._units[0]

    @cached_property
    def c1(self) -> Array:
        """z1 times the distances from the bounds at the start."""
        return self.origin.z1 * self.rows.sides.gaps(self.origin.x0)

    @cached_property
    def c2(self) -> Array:
        """z2 w, in boxes z2 s, at the start, shape (n,)."""
        rows = self.rows
        if self.problem.standard:
            return self.origin.z2 * self.origin.w0
        return self.origin.z2 * rows.raised(rows.sides.force(self.origin.w0), self.t0)

    @cached_property
    def c3(self) -> Array:
        """(u - l - z2) t at the start, one a box."""
        return (self.rows.width - self.origin.z2[self.rows.boxed]) * self.t0

    @cached_property
    def t0(self) -> Array:
        """T at the start: of w0 what is of the upper bounds of boxes."""
        sides = self.rows.sides
        return self.origin.w0[sides.low.size :][np.isin(sides.high, self.rows.boxed)]

    @cached_property
    def rho(self) -> Array:
        """w0 - (A x0 + q), shape (n,): zero for a feasible start."""
        return self.rows.sides.force(self.origin.w0) - self.problem.w(self.origin.x0)

    def start(self) -> tuple[Array, float]:
        """(x0, z1, z2, t0) and 1."""
        return np.concatenate([self.origin.x0, self.origin.z1, self.origin.z2, self.t0]), 1.0

    def at_solution(self, x: Array) -> Array:
        """The zero of H at lambda = 0 that a solution is: its multipliers are forces and distances.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        rows, w = self.rows, self.problem.w(x)
        z2 = x - rows.end
        z1 = np.where(rows.sides.gaps(x) > 0.0, 0.0, np.maximum(rows.sides.pull(w), 0.0))
        t = np.where(rows.width > z2[rows.boxed], 0.0, np.maximum(-w[rows.boxed], 0.0))
        return np.concatenate([x, z1, z2, t])

    def split(self, y: Array) -> tuple[Array, Array, Array, Array]:
        """The blocks x, z1, z2, t of y, as views.

        Parameters
        ----------
        y : ndarray

        Returns
        -------
        x, z1, z2, t : ndarray
            x and z2 of shape (n,), z1 with one number a finite bound, t with one a box.
        """
        return self.rows.split(y)

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (3n,) for an LCP."""
        x, z1, z2, t = self.split(y)
        rows, w = self.rows, self.problem.w(x)
        raised = w + lam * self.rho
        parts = [
            (1.0 - lam) * self._stationarity(x, z1, z2, w) + lam * (x - self.origin.x0),
            z1 * rows.sides.gaps(x) - lam * self.c1,
        ]
        if self.problem.standard:
            return np.concatenate([*parts, z2 * raised - lam * self.c2])
        free, boxed = rows.free, rows.boxed
        raised[boxed] += t
        second = z2 * raised - lam * self.c2
        second[free] = (raised + lam * self.give * (z2 - self.origin.z2))[free]
        return np.concatenate([*parts, second, (rows.width - z2[boxed]) * t - lam * self.c3])

    def _stationarity(self, x: Array, z1: Array, z2: Array, w: Array) -> Array:
        """(A + A') x + q - z1 - A' z2, from w = A x + q."""
        rows = self.rows
        gradient: Array = w + self.structure.transpose @ (x - rows.end - z2) - rows.sides.force(z1)
        return gradient

    def _system(self, y: Array, lam: float) -> KKTSystem:
        x, z1, z2, t = self.split(y)
        rows, w = self.rows, self.problem.w(x)
        column = x - self.origin.x0 - self._stationarity(x, z1, z2, w)
        factor, rest, c2, sizes = z2, w + lam * self.rho, self.c2, (x, z2)
        if not self.problem.standard:
            free, give, unit = rows.free, self.give, self._units[0]
            factor, rest = np.where(free, 1.0, z2), np.where(free, lam * give, rows.raised(rest, t))
            c2 = np.where(free, give * (self.origin.z2 - z2), c2)
            sizes = rows.sides.sizes(x, unit), np.where(free, np.maximum(np.abs(z2), unit), z2)
        gap = rows.sides.gaps(x)
        return KKTSystem(
            self.structure, rows, lam, gap, z1, self.c1, factor, rest, c2, z2, t, self.c3, self.rho, column, sizes,
            1.0 if self.problem.standard else self.give / GIVE,
        )  # fmt: skip

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam) in full, for an LCP of order 3n, sparse as A is: for reference, the engine uses `bordered`."""
        return in_full(self._system(y, lam).apply, y.size, self.problem.sparse)

    @quiet
    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix, of order 3n + 1 for an LCP, by way of one of order n + 1; see `factor_kkt`."""
        # Copied, as what is factored must not follow a caller that goes on to change its y in place.
        return factor_kkt(self._system(y.copy(), lam), border.copy(), self.refine)

    @quiet
    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """H' v, one shorter than v."""
        return self._recent.at(y, lam, self._system).apply(v)

    @quiet
    def taylor(self, point: Linearization, order: int) -> Array:
        """Coefficients of the path in the pseudo-arclength of `point`, one a row.

        H is quadratic in its unknowns, lambda, w and F, so coefficient k solves H' c_k = -(products of lower ones):
        one solve and two products with A an order (Cochelin's asymptotic numerical method).
        """
        rows, n = self.rows, self.n
        c = np.zeros((order + 1, point.u.size))
        c[0] = point.u
        c[1:2] = point.tangent
        lam, boxed = c[:, -1:], rows.boxed
        x, z1, z2, t = (c[:, block] for block in self.places)
        w, pull = np.zeros((order + 1, n)), np.zeros((order + 1, n))
        defect = np.empty(point.u.size - 1)
        first, forces, second, third = self.split(defect)
        for k in range(2, order + 1):
            j = k - 1
            slope = self.problem.A @ x[j]
            w[j] = rows.raised(slope + self.rho * lam[j], t[j])
            gradient = slope + self.structure.transpose @ (x[j] - z2[j]) - rows.sides.force(z1[j])
            pull[j] = x[j] - gradient
            first[:] = convolved(lam, pull, k)
            forces[:] = convolved(z1, rows.sides.pull(x), k)
            second[:] = convolved(z2, w, k)
            if not self.problem.standard:
                second[rows.free] = self.give * convolved(lam, z2, k)[rows.free]
                third[:] = -convolved(z2[:, boxed], t, k)
            c[k] = point.solve(-defect)
        return c

    @cached_property
    def places(self) -> tuple[slice, slice, slice, slice]:
        """Where the blocks of y are in (y, lambda)."""
        n, m = self.n, self.n + self.rows.sides.index.size
        return slice(n), slice(n, m), slice(m, m + n), slice(m + n, -1)

    def proof_engine(self) -> ByProducts:
        """H as affine parts and one product of them, for proofs of paths."""
        return ByProducts(kkt_form(self))

    def certify_end(self, y: Array) -> str:
        """A sentence on the exact solution at x, where there is one.

        Parameters
        ----------
        y : ndarray
            The end of a path.
        """
        return exact_end(self.problem, y[: self.n])

    def max_step(self, u: Array, v: Array) -> float:
        """How far along v until x, z1, z2, t or what z2 and t are complementary to ends; lambda itself is free."""
        rows, sides = self.rows, self.rows.sides
        (x, z1, z2, t), (dx, d1, d2, d3) = self.split(u[:-1]), self.split(v[:-1])
        w, dw = self.problem.w(x) + u[-1] * self.rho, self.problem.A.dot(dx) + v[-1] * self.rho
        value = [sides.gaps(x), z1, rows.inside(z2, rows.raised(w, t), t)]
        change = [sides.pull(dx), d1, rows.moved(d2, rows.raised(dw, d3), d3)]
        return longest_step(np.concatenate(value), np.concatenate(change))

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """The natural residual and the gap x'w of the unrelaxed problem at x."""
        return observed(self.problem, y[: self.n])
