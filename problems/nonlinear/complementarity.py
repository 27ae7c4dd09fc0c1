"""Nonlinear complementarity problems with bounds: Newton's method and Wang's path."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

import continuation
from continuation import jets
from continuation.arguments.checks import expect
from continuation.arrays import Array, Matrix
from continuation.budget import Budget
from continuation.linear import BorderedSystem
from continuation.path import Path
from continuation.status import Status
from problems.lcp.data.bounds import without_equal_bounds
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import MixedLCP
from problems.lcp.homotopies import interior
from problems.lcp.homotopies.interior import OwnMetric, Parts, RelativeMetric
from problems.lcp.homotopies.references import WANG
from problems.lcp.homotopies.sides import Sides
from problems.lcp.homotopies.starts import inside_start, inside_vector
from problems.lcp.homotopies.two_vector import Blend, TwoVectorHomotopy
from problems.lcp.proof.certificate import Certificate, certify
from problems.lcp.search.solver import solve as solve_affine
from problems.nonlinear.start_checks import Function, Jacobian, value_at
from problems.options import check_budget, check_tolerance, quiet

NEWTON_STEPS = 20
"""Steps of Josephy's method; near a solution five suffice."""

AFFINE = Budget(steps=200, factorizations=400)
"""Most affine problems need few active sets."""


@frozen(eq=False, slots=False)
class MixedComplementarity:
    """Find x in [lower, upper] with F_i(x) >= 0 where x_i = lower_i, <= 0 where x_i = upper_i, and 0 between.

    Parameters
    ----------
    F : callable
        ``F(x) -> (n,)``.
    jacobian : callable or None
        ``jacobian(x) -> (n, n)``, dense or sparse; by default Taylor arithmetic.
    lower, upper : array_like, shape (n,)
        May be infinite; at least one is a vector.

    References
    ----------
    Facchinei and Pang, Finite-Dimensional Variational Inequalities and Complementarity Problems, 2003.
    """

    F: Function
    jacobian: Jacobian | None = None
    lower: Array = field(default=None, kw_only=True)
    upper: Array = field(default=None, kw_only=True)

    def __attrs_post_init__(self) -> None:
        sizes = [np.size(bound) for bound in (self.lower, self.upper) if bound is not None and np.ndim(bound) == 1]
        expect(sizes, "lower", "a vector of bounds, lower or upper", (self.lower, self.upper))
        like = MixedLCP(sp.eye_array(sizes[0], format="csr"), np.zeros(sizes[0]), self.lower, self.upper)
        object.__setattr__(self, "lower", like.lower)
        object.__setattr__(self, "upper", like.upper)
        without_equal_bounds(like.lower, like.upper)
        x = inside_start(like)
        value_at(self.F, x, self.jacobian)

    @property
    def n(self) -> int:
        """Number of unknowns."""
        return int(self.lower.size)

    def slope(self, x: Array) -> Matrix:
        """F'(x), shape (n, n).

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        if self.jacobian is not None:
            return self.jacobian(x.copy())
        return np.asarray(jets.jacobian(self.F, x))

    def linearized(self, x: Array) -> MixedLCP:
        """The affine problem with F and F' of x.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        slope = self.slope(x)
        return MixedLCP(slope, np.asarray(self.F(x.copy()), dtype=float) - slope @ x, self.lower, self.upper)


@frozen(eq=False, slots=False)
class InteriorHomotopy:
    """Wang's homotopy: ``(1-l) F(x) - y + l y0 = 0`` and ``y_i`` times its distance from a bound ``= l c_i``.

    Here y is s - t, with s at lower and t at upper bounds; free unknowns add l (x - x0).

    Parameters
    ----------
    problem : MixedComplementarity
    x0 : array_like, shape (n,), optional
        Strictly between the bounds; default near zero.
    """

    problem: MixedComplementarity
    x0: Array = field(default=None)
    problem_class: ClassVar[str] = "nonlinear complementarity problems"
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (WANG,)
    metric: ClassVar[OwnMetric] = OwnMetric()
    signs: ClassVar[float] = 1.0

    residual = interior.residual
    max_step = interior.max_step

    def __attrs_post_init__(self) -> None:
        x0 = inside_start(self._shape) if self.x0 is None else inside_vector("x0", self.x0, self._shape)
        object.__setattr__(self, "x0", x0)

    @cached_property
    def _shape(self) -> MixedLCP:
        n = self.problem.n
        return MixedLCP(sp.csr_array((n, n)), np.zeros(n), self.problem.lower, self.problem.upper)

    @cached_property
    def sides(self) -> Sides:
        """The finite bounds."""
        return Sides(self._shape)

    @cached_property
    def y0(self) -> Array:
        """Forces at the start, at least 1."""
        return np.maximum(1.0, np.abs(self.problem.F(self.x0.copy())))[self.sides.index]

    @cached_property
    def c(self) -> Array:
        """`y0` times distances from the bounds."""
        return self.sides.gaps(self.x0) * self.y0

    @cached_property
    def own_metric(self) -> RelativeMetric:
        """The metric of relative changes."""
        return RelativeMetric(lower=self.problem.lower, upper=self.problem.upper)

    def start(self) -> tuple[Array, float]:
        """(x0, y0) and 1."""
        return np.concatenate([self.x0, self.y0]), 1.0

    def parts(self, y: Array, lam: float, one: float = 1.0) -> Parts:
        """The `interior.Parts` of H; for directions the pairs alone.

        Parameters
        ----------
        y : ndarray
        lam : float
        one : float
            0 for a direction.
        """
        n, sides = self.problem.n, self.sides
        x, forces = y[:n], y[n:]
        if not one:
            return x, x, forces, sides.pull(x), 0.0
        goal = self.problem.F(x.copy()) - sides.force(forces)
        return goal, sides.force(self.y0 - forces) + sides.free * (x - self.x0), forces, sides.gaps(x), 0.0

    def _linearized(self, y: Array) -> TwoVectorHomotopy:
        problem, blend = self.problem.linearized(y[: self.problem.n]), Blend(sign=1, x=self.sides.free, y=1)
        found = TwoVectorHomotopy("Wang", problem, blend, self.x0, self.y0, self.references, Structure(problem))
        vars(found).update(sides=self.sides, c=self.c, own_metric=self.own_metric)
        return found

    @quiet
    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix."""
        return self._linearized(y).bordered(y, lam, border)

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam) in full."""
        return self._linearized(y).jacobian(y, lam)


@frozen(eq=False)
class ComplementaritySolution:
    """Result for a nonlinear complementarity problem.

    Attributes
    ----------
    success : bool
        Whether the residual meets the tolerance.
    certificate : Certificate
        For the problem linearised at x.
    path : Path or None
    message : str
    """

    success: bool
    certificate: Certificate
    path: Path | None
    message: str

    @property
    def x(self) -> Array:
        """Solution, or best point found, shape (n,)."""
        return self.certificate.x


def solve_complementarity(
    problem: MixedComplementarity, x0: Any = None, *, tolerance: float = 1e-10, budget: Budget | None = None
) -> ComplementaritySolution:
    """Solve by Newton's method from x0, else from the end of Wang's path.

    Parameters
    ----------
    problem : MixedComplementarity
    x0 : array_like, shape (n,), optional
        Strictly between the bounds; default near zero.
    tolerance : float
        Relative residual.
    budget : continuation.Budget, optional

    References
    ----------
    Josephy, Math. Research Center Report 1965, Madison 1979.
    """
    expect(isinstance(problem, MixedComplementarity), "problem", "a MixedComplementarity", problem, TypeError)
    check_tolerance(tolerance)
    check_budget(budget)
    homotopy = InteriorHomotopy(problem, x0)
    direct = _josephy(problem, homotopy.x0, tolerance)
    if direct.relative_residual <= tolerance:
        return ComplementaritySolution(True, direct, None, "Solved by Newton's method from the start.")
    path = continuation.trace(homotopy, budget=Budget() if budget is None else budget)
    end = homotopy.x0 if not path.steps else path.endpoint.y[: problem.n]
    polished = _josephy(problem, np.clip(end, problem.lower, problem.upper), tolerance)
    best = min(direct, polished, key=lambda one: one.relative_residual)
    solved = best.relative_residual <= tolerance
    arrived = path.status is Status.REACHED_TARGET
    what = "Solved at the end of" if solved else "Not solved, neither by Newton's method nor along"
    return ComplementaritySolution(
        solved, best, path, f"{what} Wang's path{'' if arrived else ', which did not arrive'}. {path.message}"
    )


def _josephy(problem: MixedComplementarity, x: Array, tolerance: float) -> Certificate:
    with np.errstate(all="ignore"):
        affine = problem.linearized(x)
        best = certify(affine, np.clip(x, problem.lower, problem.upper))
        for _ in range(NEWTON_STEPS):
            found = solve_affine(affine, restarts=0, budget=AFFINE)
            if found.x is None or not found.success:
                break
            try:
                affine = problem.linearized(found.x)
            except ValueError:  # outside the domain of F
                break
            now = certify(affine, found.x)
            stalled = best.relative_residual <= tolerance and now.relative_residual >= best.relative_residual
            best = min(best, now, key=lambda one: one.relative_residual)
            if stalled or best.relative_residual == 0.0:
                break
    return best
