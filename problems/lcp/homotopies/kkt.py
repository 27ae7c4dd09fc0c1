"""The KKT homotopy of Dutta, Das and Jana, with bounds of any kind: 2 to 5 unknowns an index, solved with n + 1."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.homotopies import interior
from problems.lcp.homotopies.elimination import factor_rows
from problems.lcp.homotopies.interior import OwnMetric, Parts, Recent, RelativeMetric, System
from problems.lcp.homotopies.references import DUTTA_DAS_JANA
from problems.lcp.homotopies.rows import Rows
from problems.lcp.homotopies.starts import Start, kkt_start, natural_units, require_interior
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
    _recent: Recent = field(factory=Recent, init=False, repr=False)

    residual = interior.residual
    jacobian = interior.jacobian
    differential = interior.differential
    taylor = interior.taylor
    max_step = interior.max_step
    observe = interior.observe
    proof_engine = interior.proof_engine
    certify_end = interior.certify_end

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

    @cached_property
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
            unit=natural_units(self.problem)[0],
        )

    @cached_property
    def unit(self) -> float:
        """A unit of w for one of x."""
        x, w = natural_units(self.problem)
        return w / x

    @property
    def give(self) -> float:
        """How far an equation gives way, at lambda = 1, to a unit of its multiplier."""
        return GIVE * self.unit

    @cached_property
    def c(self) -> Array:
        """The products of all pairs at the start, zero where there is no bound; for an LCP shape (2n,)."""
        _, _, p, q, _ = self.parts(*self.start())
        return np.where(self.signs == 0.0, 0.0, p * q)

    @property
    def c1(self) -> Array:
        """The products of z1 and the distances from the bounds."""
        return self.c[: self.rows.sides.index.size]

    @cached_property
    def signs(self) -> Array:
        """Of the factors of all pairs; zero where there is no bound."""
        rows = self.rows
        ones = np.ones(rows.sides.index.size), np.ones(rows.boxed.size)
        return np.concatenate([ones[0], np.where(rows.free, 0.0, rows.signs), ones[1]])

    @cached_property
    def rho(self) -> Array:
        """w0 - (A x0 + q), shape (n,): zero for a feasible start."""
        return self.rows.sides.force(self.origin.w0) - self.problem.w(self.origin.x0)

    def start(self) -> tuple[Array, float]:
        """(x0, z1, z2, t0) and 1, where t0 is of w0 what is of the upper bounds of boxes."""
        sides = self.rows.sides
        t0 = self.origin.w0[sides.low.size :][np.isin(sides.high, self.rows.boxed)]
        return np.concatenate([self.origin.x0, self.origin.z1, self.origin.z2, t0]), 1.0

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

    def parts(self, y: Array, lam: float, one: float = 1.0) -> Parts:
        """The stationarity F and x - x0; z1, z2, u - l - z2 and the distances, w, t: see `interior`.

        Without bounds w = 0 is asked for: w plus lambda times ``give (z2 - z2_0)``.
        """
        rows, start = self.rows, self.origin
        n, m, k = rows.ends
        x, z1, z2, t = y[:n], y[n:m], y[m:k], y[k:]
        if one:
            w, origin, gaps = self.problem.w(x), x - start.x0, rows.sides.gaps(x)
            turned = self.structure.transpose @ (x - rows.end - z2)
        else:
            # For a few unknowns `@` of numpy takes four times as long.
            w, origin, gaps = self.problem.A.dot(x), x, rows.sides.pull(x)
            turned = self.structure.transpose.dot(x - z2)
        goal = w + turned - rows.sides.force(z1)
        raised = w + lam * self.rho
        if self.problem.standard:
            return goal, origin, y[self.n :], np.concatenate([gaps, raised]), 0.0
        raised[rows.boxed] += t
        p = np.concatenate([z1, z2, one * rows.width - z2[rows.boxed]])
        q, plain = np.concatenate([gaps, raised, t]), np.zeros_like(p)
        free = np.flatnonzero(rows.free)
        there = z1.size + free
        plain[there], p[there] = raised[free], lam
        q[there] = self.give * (z2 - one * start.z2)[free]
        return goal, origin, p, q, plain

    def rounded(self) -> tuple[str, Array, Array]:
        """Which end of the rows is exact in floats; of the other sizes of what is summed, by x and for constants."""
        A = self.problem.A.toarray() if self.problem.sparse else self.problem.A
        # The sum of A'end has n terms, the error that goes with these is that of eight.
        end = np.abs(A.T) @ np.abs(np.broadcast_to(self.rows.end, self.n))
        return "origin", np.abs(A) + np.abs(A.T), np.abs(self.problem.q) + end * (1.0 + self.n / 4.0)

    @quiet
    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix, of order 3n + 1 for an LCP, by way of one of order n + 1; see `elimination`."""
        # Copied, as what is factored must not follow a caller that goes on to change it in place.
        return factor_rows(System.at(self, y, lam), border.copy())
