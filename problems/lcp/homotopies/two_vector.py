"""The homotopies in (x, y)."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.homotopies import interior, references
from problems.lcp.homotopies.elimination import factor_pairs
from problems.lcp.homotopies.interior import OwnMetric, Parts, RelativeMetric, System
from problems.lcp.homotopies.sides import Sides
from problems.lcp.homotopies.starts import feasible_start, given_inside, natural_units, positive_vector
from problems.options import quiet


@frozen(kw_only=True)
class Blend:
    """Weights `x`, `y`, `A` = a, b, c in H1 = sign [(1-lam)(Ax+q-y) + lam (a (x-x0) + b (y0-y) + c A(x-x0))]."""

    sign: int
    x: int | Array = 0
    y: int = 0
    A: int = 0

    def slopes(self, lam: float) -> tuple[float, float | Array, float]:
        """Alpha, beta, gamma: H1 has derivatives alpha A + beta I by x, -gamma I by y."""
        return 1.0 - lam + lam * self.A, lam * self.x, 1.0 - lam + lam * self.y


@frozen(eq=False, slots=False)
class TwoVectorHomotopy:
    """A blend of ``Ax + q = y`` with equations true at the start, and ``xy = lambda x0 y0``.

    With bounds y is s - t, ``s(x-l) = lambda s0(x0-l)`` for finite l, ``t(u-x) = lambda t0(u-x0)`` for finite u; the
    unknowns are (x, s, t).

    A path that reaches lambda = 0 ends at a solution; others diverge.

    Attributes
    ----------
    name : str
    problem : MixedLCP
    blend : Blend
        Its coefficients.
    x0, y0 : Array
        The start: x0 between the bounds, y0 positive, one per finite bound.
    references : tuple of str
    structure : Structure
    """

    name: str
    problem: MixedLCP | LCP
    blend: Blend
    x0: Array
    y0: Array
    references: tuple[str, ...]
    structure: Structure
    problem_class: ClassVar[str] = "linear complementarity problems"
    target: ClassVar[float | None] = 0.0
    signs: ClassVar[float] = 1.0
    metric: ClassVar[OwnMetric] = OwnMetric()

    residual = interior.residual
    jacobian = interior.jacobian
    differential = interior.differential
    taylor = interior.taylor
    max_step = interior.max_step
    observe = interior.observe
    proof_engine = interior.proof_engine
    certify_end = interior.certify_end

    @property
    def n(self) -> int:
        """The order of A."""
        return self.problem.n

    @cached_property
    def sides(self) -> Sides:
        """The finite bounds."""
        return Sides(self.problem)

    @cached_property
    def own_metric(self) -> RelativeMetric:
        """Metric of relative changes of forces and distances."""
        if self.problem.standard:
            return RelativeMetric()
        unit = natural_units(self.problem)[0]
        return RelativeMetric(lower=self.problem.lower, upper=self.problem.upper, unit=unit)

    @cached_property
    def c(self) -> Array:
        """Distances times y at the start."""
        return self.sides.gaps(self.x0) * self.y0

    def start(self) -> tuple[Array, float]:
        """(x0, y0) and 1."""
        return np.concatenate([self.x0, self.y0]), 1.0

    def at_solution(self, x: Array) -> Array:
        """The zero of H at lambda = 0 for a solution.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        forces = np.where(self.sides.gaps(x) > 0.0, 0.0, np.maximum(self.sides.pull(self.problem.w(x)), 0.0))
        return np.concatenate([x, forces])

    def parts(self, y: Array, lam: float, one: float = 1.0) -> Parts:
        """The `interior.Parts` of H.

        Parameters
        ----------
        y : ndarray
        lam : float
        one : float
            0 leaves out constants, for a direction.
        """
        n, blend, sides = self.n, self.blend, self.sides
        x, y = y[:n], y[n:]
        if one:
            w, dx, dy, gaps = self.problem.w(x), x - self.x0, self.y0 - y, sides.gaps(x)
        else:
            w, dx, dy, gaps = self.problem.A.dot(x), x, -y, sides.pull(x)
        origin = blend.x * dx + blend.y * sides.force(dy)
        if blend.A:
            origin = origin + blend.A * (self.problem.A @ dx)
        return blend.sign * (w - sides.force(y)), blend.sign * origin, y, gaps, 0.0

    def rounded(self) -> tuple[str, Array, Array]:
        """See `KKTHomotopy.rounded`."""
        A, blend = self.problem.A.toarray() if self.problem.sparse else self.problem.A, self.blend
        by_x = np.abs(blend.x) * np.eye(self.n) + abs(blend.A) * np.abs(A)
        constants = by_x @ np.abs(self.x0) + abs(blend.y) * np.bincount(self.sides.index, self.y0, self.n)
        return "goal", by_x, constants * (1.0 + (self.n + self.y0.size) / 4.0)

    @quiet
    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix."""
        return factor_pairs(System.at(self, y, lam), border.copy())


def YuHomotopy(
    problem: MixedLCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Yu et al. 2006, for positive semidefinite A: ``(1-l)(Ax+q-y) + l(x-x0)``, ``xy - l x0 y0``.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        Positive; default ones, and 1/x0. With bounds x0 lies between them, y0 has one number each.
    structure : Structure, optional
        Shared between starts.

    Raises
    ------
    TypeError, ValueError
        For bad input.
    """
    x0 = given_inside(problem, x0)
    with np.errstate(over="ignore"):
        y0 = 1.0 / Sides(problem).gaps(x0) if y0 is None else y0
    return _made("Yu", problem, Blend(sign=1, x=1), x0, y0, references.YU, structure)


def ZhaoHomotopy(
    problem: LCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Zhao et al. 2010, for N-matrices: ``(1-l)(y-Ax-q) + l(x-x0)``, ``xy - l x0 y0``.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        Positive; default `strictly_feasible_start` and A x0 + q. Without y0 x0 must be strictly feasible.
    structure : Structure, optional
        Shared between starts.

    Raises
    ------
    TypeError, ValueError
        For bad input; `NoStrictlyFeasiblePoint` if no default start exists.
    """
    x0, y0 = feasible_start(problem, x0, y0)
    return _made("Zhao", problem, Blend(sign=-1, x=-1), x0, y0, references.ZHAO, structure)


def XuHomotopy(
    problem: LCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Xu et al., for P-matrices: ``(1-l)(y-Ax-q) - l(x-x0)``, ``xy - l x0 y0``.

    From the same x0 and y0 its path is that of `YuHomotopy`.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        As for `ZhaoHomotopy`.
    structure : Structure, optional
        Shared between starts.

    Raises
    ------
    TypeError, ValueError
        For bad input; `NoStrictlyFeasiblePoint` if no default start exists.
    """
    x0, y0 = feasible_start(problem, x0, y0)
    return _made("Xu", problem, Blend(sign=-1, x=1), x0, y0, references.XU, structure)


def WangHomotopy(
    problem: MixedLCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Wang et al. 2010, for P*-matrices: ``(1-l)(Ax+q) - y + l y0``, ``xy - l x0 y0``.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        As for `YuHomotopy`, but y0 is max(1, |q|) by default.
    structure : Structure, optional
        Shared between starts.

    Raises
    ------
    TypeError, ValueError
        For bad input.
    """
    x0, sides = given_inside(problem, x0), Sides(problem)
    y0 = np.maximum(1.0, np.abs(problem.q))[sides.index] if y0 is None else y0
    # x - x0 keeps unbounded rows regular.
    return _made("Wang", problem, Blend(sign=1, x=sides.free, y=1), x0, y0, references.WANG, structure)


def KojimaMegiddoMizunoHomotopy(
    problem: MixedLCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Kojima, Megiddo and Mizuno 1993: ``Ax+q-y + l(y0 - A x0 - q)``, ``xy - l x0 y0``.

    The central path of infeasible interior-point methods. With (xy, y-Ax-q) = l(a, b) and b > 0 they prove convergence
    for classes up to L*- and copositive-plus matrices.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        As for `YuHomotopy`, but y0 is max(A x0 + q, 0) + max(1, |q|) by default, so that b > 0.
    structure : Structure, optional
        Shared between starts.

    Raises
    ------
    TypeError, ValueError
        For bad input.
    """
    x0, sides = given_inside(problem, x0), Sides(problem)
    if y0 is None:
        y0 = np.maximum(sides.pull(problem.w(x0)), 0.0) + np.maximum(1.0, np.abs(problem.q))[sides.index]
    blend, source = Blend(sign=1, x=sides.free, y=1, A=1), references.KOJIMA_MEGIDDO_MIZUNO
    return _made("Kojima-Megiddo-Mizuno", problem, blend, x0, y0, source, structure)


def _made(
    name: str, problem: MixedLCP, blend: Blend, x0: Array, y0: Any, source: str, structure: Structure | None
) -> TwoVectorHomotopy:
    y0, sources = positive_vector("y0", y0, Sides(problem).index.size), (source, references.DUTTA_DAS_JANA)
    return TwoVectorHomotopy(name, problem, blend, x0, y0, sources, structure or Structure(problem))
