"""The homotopies in (x, y): Yu, Zhao, Xu, Wang, and Kojima, Megiddo and Mizuno; one system, five sets of data.

Those of Yu, Wang, and Kojima, Megiddo and Mizuno take bounds of any kind.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.linear import BorderedSystem
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.homotopies import interior, references
from problems.lcp.homotopies.elimination import factor_pairs
from problems.lcp.homotopies.interior import OwnMetric, Parts, Recent, RelativeMetric, System
from problems.lcp.homotopies.sides import Sides
from problems.lcp.homotopies.starts import feasible_start, given_inside, made_of_x0, natural_units, positive_vector
from problems.options import quiet


@frozen(kw_only=True)
class Blend:
    """``sign [(1 - lam) (A x + q - y) + lam (x_ (x - x0) + y_ (y0 - y) + A_ A (x - x0))]`` with these x_, y_, A_.

    For y read s - t, the forces at lower and at upper bounds; x_ may differ from index to index.
    """

    sign: int
    x: int | Array = 0
    y: int = 0
    A: int = 0

    def slopes(self, lam: float) -> tuple[float, float | Array, float]:
        """Alpha, beta and gamma of the derivatives of [...], alpha A + beta I by x and -gamma I by y."""
        return 1.0 - lam + lam * self.A, lam * self.x, 1.0 - lam + lam * self.y


@frozen(eq=False, slots=False)
class TwoVectorHomotopy:
    """A blend of ``A x + q = y`` with equations that the start satisfies, and ``x y = lambda x0 y0`` componentwise.

    With bounds l and u, y stands for s - t, and the second equations are ``s (x - l) = lambda s0 (x0 - l)`` where l is
    finite, ``t (u - x) = lambda t0 (u - x0)`` where u is; the unknowns are (x, s, t).

    Made by `YuHomotopy`, `ZhaoHomotopy`, `XuHomotopy`, `WangHomotopy` and `KojimaMegiddoMizunoHomotopy`, which see to
    the start. Where such a path reaches lambda = 0 its end solves the LCP; where it cannot, it diverges.

    Attributes
    ----------
    name : str
    problem : MixedLCP
    blend : Blend
        What tells the five apart.
    x0, y0 : Array
        The start: x0 between the bounds, shape (n,), and y0 positive, one for each finite bound.
    references : tuple of str
    structure : Structure
    refine : bool
        Whether bordered solves are corrected to round-off; see `KKTHomotopy`.
    """

    name: str
    problem: MixedLCP | LCP
    blend: Blend
    x0: Array
    y0: Array
    references: tuple[str, ...]
    structure: Structure
    refine: bool = True
    problem_class: ClassVar[str] = "linear complementarity problems"
    target: ClassVar[float | None] = 0.0
    signs: ClassVar[float] = 1.0
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

    @property
    def n(self) -> int:
        """The order of A: the unknowns of an LCP are 2n."""
        return self.problem.n

    @cached_property
    def sides(self) -> Sides:
        """The finite bounds."""
        return Sides(self.problem)

    @cached_property
    def own_metric(self) -> RelativeMetric:
        """Relative changes of the forces, and of the distances from the nearest bounds."""
        if self.problem.standard:
            return RelativeMetric()
        unit = natural_units(self.problem)[0]
        return RelativeMetric(lower=self.problem.lower, upper=self.problem.upper, unit=unit)

    @cached_property
    def c(self) -> Array:
        """The distances from the bounds times y at the start; for an LCP X y, shape (n,)."""
        return self.sides.gaps(self.x0) * self.y0

    def start(self) -> tuple[Array, float]:
        """(x0, y0) and 1."""
        return np.concatenate([self.x0, self.y0]), 1.0

    def at_solution(self, x: Array) -> Array:
        """(x, y) with y = w, of bounds their forces: the zero of H at lambda = 0 that a solution is; (2n,) for an LCP.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        forces = np.where(self.sides.gaps(x) > 0.0, 0.0, np.maximum(self.sides.pull(self.problem.w(x)), 0.0))
        return np.concatenate([x, forces])

    def parts(self, y: Array, lam: float, one: float = 1.0) -> Parts:
        """A x + q - y and what the blend puts in its place at lambda = 1; y and the distances: see `interior`."""
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
        """Which end of the rows is exact in floats; of the other sizes of what is summed, by x and for constants."""
        A, blend = self.problem.A.toarray() if self.problem.sparse else self.problem.A, self.blend
        by_x = np.abs(blend.x) * np.eye(self.n) + abs(blend.A) * np.abs(A)
        # The sums of A x0 and of forces have many terms, the error that goes with these is that of eight.
        constants = by_x @ np.abs(self.x0) + abs(blend.y) * np.bincount(self.sides.index, self.y0, self.n)
        return "goal", by_x, constants * (1.0 + (self.n + self.y0.size) / 4.0)

    @quiet
    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix by way of one of order n + 1; see `factor_pairs`."""
        # Copied, as what is factored must not follow a caller that goes on to change it in place.
        return factor_pairs(System.at(self, y, lam), border.copy())


def YuHomotopy(
    problem: MixedLCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Yu et al. 2006, for positive semidefinite A: ``(1-l)(A x + q - y) + l (x - x0)``, ``x y - l x0 y0``.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        Positive; by default ones, and 1/x0, which makes the second equation the published x y = l e. With bounds x0 is
        between them, and y0 has a number for each.
    structure : Structure, optional
        That of the problem, to be shared.

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.
    """
    x0 = given_inside(problem, x0)
    with np.errstate(over="ignore"):
        y0 = made_of_x0(1.0 / Sides(problem).gaps(x0)) if y0 is None else y0
    return _made("Yu", problem, Blend(sign=1, x=1), x0, y0, references.YU, structure)


def ZhaoHomotopy(
    problem: LCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Zhao et al. 2010, for N-matrices: ``(1-l)(y - A x - q) + l (x - x0)``, ``x y - l x0 y0``.

    The reduced matrix (1-l)(A + diag(y/x)) - l I is indefinite even for positive definite A.

    Parameters
    ----------
    problem : LCP
    x0 : array_like, shape (n,), optional
        Strictly feasible where y0 is not given; by default one found by `strictly_feasible_start`.
    y0 : array_like, shape (n,), optional
        Positive; A x0 + q by default. Any one satisfies the equations at l = 1.
    structure : Structure, optional
        That of the problem, to be shared.

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument; `NoStrictlyFeasiblePoint` where a start was to be found and there is none.
    """
    x0, y0 = feasible_start(problem, x0, y0)
    return _made("Zhao", problem, Blend(sign=-1, x=-1), x0, y0, references.ZHAO, structure)


def XuHomotopy(
    problem: LCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Xu et al., for P-matrices: ``(1-l)(y - A x - q) - l (x - x0)``, ``x y - l x0 y0``.

    The first equation is Yu's with the sign changed: the same path if y0 is the same, started at y0 = A x0 + q.

    Parameters
    ----------
    problem : LCP
    x0 : array_like, shape (n,), optional
        Strictly feasible where y0 is not given; by default one found by `strictly_feasible_start`.
    y0 : array_like, shape (n,), optional
        Positive; A x0 + q by default. Any one satisfies the equations at l = 1.
    structure : Structure, optional
        That of the problem, to be shared.

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument; `NoStrictlyFeasiblePoint` where a start was to be found and there is none.
    """
    x0, y0 = feasible_start(problem, x0, y0)
    return _made("Xu", problem, Blend(sign=-1, x=1), x0, y0, references.XU, structure)


def WangHomotopy(
    problem: MixedLCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Wang et al. 2010, for P*-matrices: ``(1-l)(A x + q) - y + l y0``, ``x y - l x0 y0``.

    No feasibility is needed. Not the homotopy of Kojima, Megiddo and Mizuno, whose y - A x - q fades in proportion to
    l: the two differ by l A (x - x0), see `KojimaMegiddoMizunoHomotopy`.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        Positive; by default ones, and max(1, |q|). With bounds x0 is between them, and y0 has a number for each.
    structure : Structure, optional
        That of the problem, to be shared.

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.
    """
    x0, sides = given_inside(problem, x0), Sides(problem)
    y0 = np.maximum(1.0, np.abs(problem.q))[sides.index] if y0 is None else y0
    # Where no force is, x - x0 has to fade in its place, so that the matrix at lambda = 1 is not singular.
    return _made("Wang", problem, Blend(sign=1, x=sides.free, y=1), x0, y0, references.WANG, structure)


def KojimaMegiddoMizunoHomotopy(
    problem: MixedLCP, x0: Any = None, y0: Any = None, *, structure: Structure | None = None
) -> TwoVectorHomotopy:
    """Kojima, Megiddo and Mizuno 1993: ``A x + q - y + l (y0 - A x0 - q)``, ``x y - l x0 y0``.

    The central path of infeasible interior-point methods, which Han carried over to tensors. With a and b of the
    source, (x y, y - A x - q) = l (a, b): for b > 0 they prove convergence for classes up to L*- and copositive-plus
    matrices. For a strictly feasible start with y0 = A x0 + q the path is feasible throughout.

    Parameters
    ----------
    problem : LCP
    x0, y0 : array_like, shape (n,), optional
        Positive; by default ones, and max(A x0 + q, 0) + max(1, |q|), so that b > 0. With bounds x0 is between
        them, and y0 has a number for each.
    structure : Structure, optional
        That of the problem, to be shared.

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.
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
