"""The KKT homotopy of Dutta, Das and Jana, with any bounds."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.homotopies import interior
from problems.lcp.homotopies.elimination import factor_rows
from problems.lcp.homotopies.interior import OwnMetric, Parts, RelativeMetric, System
from problems.lcp.homotopies.references import DUTTA_DAS_JANA
from problems.lcp.homotopies.rows import Rows
from problems.lcp.homotopies.starts import Start, kkt_start, natural_units, require_interior
from problems.options import quiet

GIVE = 0.1
"""Relaxation of equations at lambda = 1, in natural units. On 48 monotone problems paths take 32 factorisations; 34
with 0.01, 36 with 1."""


@frozen(eq=False, slots=False, init=False)
class KKTHomotopy:
    """The optimality conditions of min x'(Ax + q), x >= 0, Ax + q >= 0, relaxed by l = lambda from 1 to 0.

    With y = (x, z1, z2), w = Ax + q + l rho, rho = w0 - (A x0 + q), componentwise::

        H1 = (1-l)[(A+A')x + q - z1 - A'z2] + l(x-x0)
        H2 = z1*x - l z1_0*x0
        H3 = z2*w - l z2_0*w0

    The path ends at a KKT point, a solution if A is row sufficient.

    With bounds low and up the objective is (x-low)w for a lower bound alone, (x-up)w for an upper one, and (x-low)s +
    (up-x)t, w = s-t, s, t >= 0, in a box. For an upper bound alone w, z2 <= 0. A box adds the unknown t and its
    multiplier up-low-z2::

        H1 = (1-l)[Ax + q + A'(x-end-z2) - z1 of lower + z1 of upper bounds] + l(x-x0)
        H3 = z2*(w+t) - l z2_0*s0
        H4 = (up-low-z2)*t - l(up-low-z2_0)*t0

    Without bounds H3 = w + l give (z2-z2_0). An index has 3 unknowns, 5 in a box, 2 without bounds.

    Parameters
    ----------
    problem : MixedLCP
        Dense or sparse.
    x0 : array_like, shape (n,), optional
        Between the bounds; may be infeasible. Default: `default_start`.
    z1, z2 : array_like, optional
        Multipliers. z1 is positive, one per finite bound, lower ones first. z2, of shape (n,), is positive; for an
        upper bound alone negative; in a box below up - low. Default for an LCP: ones for a given, strictly feasible x0
        (the paper's start), else equal products x0 z1 and w0 z2.
    w0 : array_like, optional
        Positive, one per finite bound: |w|, in a box s and t. Default for an LCP: A x0 + q if positive (the paper's
        start), else max(A x0 + q, 0) + max |q|.
    structure : Structure, optional
        Shared between starts.
    refine : bool
        Whether solves are corrected to round-off; if not, paths take a third less time.

    Raises
    ------
    TypeError
        If `problem` is no LCP.
    ValueError
        If a vector is not finite, of the wrong length or out of range.

    References
    ----------
    Dutta, Das and Jana, "Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity Problems".
    Infeasible starts follow interior-point methods.
    """

    problem: MixedLCP | LCP
    origin: Start
    structure: Structure
    refine: bool = True
    problem_class: ClassVar[str] = "linear complementarity problems"
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (DUTTA_DAS_JANA,)
    metric: ClassVar[OwnMetric] = OwnMetric()

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
        """The order of A."""
        return self.problem.n

    @cached_property
    def rows(self) -> Rows:
        """The rows w with multipliers."""
        return Rows(self.problem)

    @cached_property
    def own_metric(self) -> RelativeMetric:
        """Metric of relative changes of distances."""
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
        """Natural unit of w over that of x."""
        x, w = natural_units(self.problem)
        return w / x

    @property
    def give(self) -> float:
        """Relaxation per unit of multiplier at lambda = 1."""
        return GIVE * self.unit

    @cached_property
    def c(self) -> Array:
        """Starting products of pairs, zero without a bound."""
        _, _, p, q, _ = self.parts(*self.start())
        return np.where(self.signs == 0.0, 0.0, p * q)

    @property
    def c1(self) -> Array:
        """The products of z1 and distances."""
        return self.c[: self.rows.sides.index.size]

    @cached_property
    def signs(self) -> Array:
        """Signs of the pairs' factors; zero without a bound."""
        rows = self.rows
        ones = np.ones(rows.sides.index.size), np.ones(rows.boxed.size)
        return np.concatenate([ones[0], np.where(rows.free, 0.0, rows.signs), ones[1]])

    @cached_property
    def rho(self) -> Array:
        """w0 - (A x0 + q), shape (n,)."""
        return self.rows.sides.force(self.origin.w0) - self.problem.w(self.origin.x0)

    def start(self) -> tuple[Array, float]:
        """(x0, z1, z2, t0) and 1."""
        sides = self.rows.sides
        t0 = self.origin.w0[sides.low.size :][np.isin(sides.high, self.rows.boxed)]
        return np.concatenate([self.origin.x0, self.origin.z1, self.origin.z2, t0]), 1.0

    def at_solution(self, x: Array) -> Array:
        """The zero of H at lambda = 0 for a solution.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        rows, w = self.rows, self.problem.w(x)
        z2 = x - rows.end
        z1 = np.where(rows.sides.gaps(x) > 0.0, 0.0, np.maximum(rows.sides.pull(w), 0.0))
        return np.concatenate([x, z1, z2, np.maximum(-w[rows.boxed], 0.0)])

    def split(self, y: Array) -> tuple[Array, Array, Array, Array]:
        """The blocks of y, as views.

        Parameters
        ----------
        y : ndarray

        Returns
        -------
        x, z1, z2, t : ndarray
            x, z2 of shape (n,), z1 one per finite bound, t one per box.
        """
        return self.rows.split(y)

    def parts(self, y: Array, lam: float, one: float = 1.0) -> Parts:
        """The `interior.Parts` of H.

        Parameters
        ----------
        y : ndarray
        lam : float
        one : float
            0 leaves out constants, for a direction.
        """
        rows, start = self.rows, self.origin
        n, m, k = rows.ends
        x, z1, z2, t = y[:n], y[n:m], y[m:k], y[k:]
        if one:
            w, origin, gaps = self.problem.w(x), x - start.x0, rows.sides.gaps(x)
            turned = self.structure.transpose @ (x - rows.end - z2)
        else:
            # `@` takes four times as long.
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
        """The end of the rows that is exact in floats, and the other's term sizes."""
        A = self.problem.A.toarray() if self.problem.sparse else self.problem.A
        end = np.abs(A.T) @ np.abs(np.broadcast_to(self.rows.end, self.n))
        return "origin", np.abs(A) + np.abs(A.T), np.abs(self.problem.q) + end * (1.0 + self.n / 4.0)

    @quiet
    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix."""
        # Callers may change their border.
        return factor_rows(System.at(self, y, lam), border.copy())
