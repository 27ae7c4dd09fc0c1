"""The KKT homotopy of Dutta, Das and Jana, in 3n unknowns, solved with n + 1."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import evolve, frozen

from continuation.arrays import Array, Matrix
from continuation.certificate.quadratic import Quadratic
from continuation.linear import BorderedSystem
from continuation.point.linearization import Linearization
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, require_lcp
from problems.lcp.homotopies.interior import RelativeMetric, convolved, longest_step, observed
from problems.lcp.homotopies.kkt_system import KKTSystem, factor_kkt
from problems.lcp.homotopies.quadratics import exact_end, kkt_form
from problems.lcp.homotopies.references import DUTTA_DAS_JANA
from problems.lcp.homotopies.starts import Start, centred, default_start, natural_units, positive_vector, relaxed_w
from problems.options import quiet


@frozen(eq=False, slots=False, init=False)
class KKTHomotopy:
    """The optimality conditions of min x'(A x + q), x >= 0, A x + q >= 0, relaxed by lambda from 1 to 0.

    With y = (x, z1, z2), w = A x + q + lambda rho, rho = w0 - (A x0 + q) and products componentwise::

        H1 = (1 - lambda) [(A + A') x + q - z1 - A' z2] + lambda (x - x0)
        H2 = z1 * x - lambda z1_0 * x0
        H3 = z2 * w - lambda z2_0 * w0

    The path ends at a KKT point. Where A is row sufficient that solves the LCP; elsewhere it may not: check it.

    Parameters
    ----------
    problem : LCP
        Dense, sparse or, as sparse, banded.
    x0 : array_like, shape (n,), optional
        Positive; feasible or not. Default: `default_start`.
    z1, z2 : array_like, shape (n,), optional
        Positive multipliers. Default: ones, as in the paper, where x0 is given and strictly feasible; else such that
        all products x0 z1 and w0 z2 are equal.
    w0 : array_like, shape (n,), optional
        Positive. Default: A x0 + q where that is positive, which is the paper's start; else max(A x0 + q, 0) + max |q|.
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
        If a vector is not positive, not finite, or not of length n; the message names it.

    References
    ----------
    Dutta, Das and Jana, "Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity Problems". The
    start off the feasible set is that of infeasible interior-point methods.
    """

    problem: LCP
    origin: Start
    structure: Structure
    refine: bool = True
    problem_class: ClassVar[str] = "linear complementarity problems"
    target: ClassVar[float | None] = 0.0
    references: ClassVar[tuple[str, ...]] = (DUTTA_DAS_JANA,)
    metric: ClassVar[RelativeMetric] = RelativeMetric()

    def __init__(
        self,
        problem: LCP,
        x0: Any = None,
        z1: Any = None,
        z2: Any = None,
        w0: Any = None,
        *,
        structure: Structure | None = None,
        refine: bool = True,
    ) -> None:
        require_lcp(problem)
        origin = _start(problem, x0, z1, z2, w0)
        self.__attrs_init__(problem, origin, structure if structure is not None else Structure(problem), refine)

    @property
    def n(self) -> int:
        """The order of A: y has 3n components."""
        return self.problem.n

    @cached_property
    def c1(self) -> Array:
        """z1 x at the start, shape (n,)."""
        return self.origin.z1 * self.origin.x0

    @cached_property
    def c2(self) -> Array:
        """z2 w at the start, shape (n,)."""
        return self.origin.z2 * self.origin.w0

    @cached_property
    def rho(self) -> Array:
        """w0 - (A x0 + q), shape (n,): zero for a feasible start."""
        return self.origin.w0 - self.problem.w(self.origin.x0)

    def start(self) -> tuple[Array, float]:
        """(x0, z1, z2) and 1."""
        return np.concatenate([self.origin.x0, self.origin.z1, self.origin.z2]), 1.0

    def split(self, y: Array) -> tuple[Array, Array, Array]:
        """The blocks x, z1, z2 of y, as views of shape (n,).

        Parameters
        ----------
        y : ndarray, shape (3n,)

        Returns
        -------
        x, z1, z2 : ndarray, shape (n,)
        """
        n = self.n
        return y[:n], y[n : 2 * n], y[2 * n :]

    def at_solution(self, x: Array) -> Array:
        """(x, z1, z2) with z1 = w and z2 = x: the zero of H at lambda = 0 that a solution is, shape (3n,).

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        return np.concatenate([x, np.where(x > 0.0, 0.0, np.maximum(self.problem.w(x), 0.0)), x])

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (3n,)."""
        x, z1, z2 = self.split(y)
        w = self.problem.w(x)
        return np.concatenate(
            [
                (1.0 - lam) * self._stationarity(x, z1, z2, w) + lam * (x - self.origin.x0),
                z1 * x - lam * self.c1,
                z2 * (w + lam * self.rho) - lam * self.c2,
            ]
        )

    def _stationarity(self, x: Array, z1: Array, z2: Array, w: Array) -> Array:
        """(A + A') x + q - z1 - A' z2, from w = A x + q."""
        gradient: Array = w + self.structure.transpose @ (x - z2) - z1
        return gradient

    def _system(self, y: Array, lam: float) -> KKTSystem:
        x, z1, z2 = self.split(y)
        w = self.problem.w(x)
        column = x - self.origin.x0 - self._stationarity(x, z1, z2, w)
        return KKTSystem(self.structure, lam, x, z1, z2, w + lam * self.rho, self.c1, self.c2, self.rho, column)

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam) in full, of order 3n, sparse as A is: for reference, the engine uses `bordered`."""
        s, n, mu = self._system(y, lam), self.n, 1.0 - lam
        column = np.concatenate([s.column, -s.c1, s.z2 * s.rho - s.c2])
        if self.problem.sparse:
            eye = sp.eye_array(n)
            rows = [
                [mu * self.structure.symmetrized + lam * eye, -mu * eye, -mu * self.structure.transpose],
                [sp.diags_array(s.z1), sp.diags_array(s.x), None],
                [sp.diags_array(s.z2) @ self.problem.A, None, sp.diags_array(s.w)],
            ]
            return sp.block_array(rows, format="csr"), column
        whole, i = np.zeros((3 * n, 3 * n)), np.arange(n)
        whole[:n, :n] = mu * self.structure.symmetrized
        whole[i, i] += lam
        whole[i, n + i] = -mu
        whole[:n, 2 * n :] = -mu * self.structure.transpose
        whole[n + i, i], whole[n + i, n + i] = s.z1, s.x
        whole[2 * n :, :n] = s.z2[:, None] * self.problem.A
        whole[2 * n + i, 2 * n + i] = s.w
        return whole, column

    @quiet
    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix of order 3n + 1 by way of one of order n + 1; see `factor_kkt`."""
        # Copied, as what is factored must not follow a caller that goes on to change its y in place.
        return factor_kkt(self._system(y.copy(), lam), border.copy(), self.refine)

    @quiet
    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """H' v, shape (3n,)."""
        return self._system(y, lam).apply(v)

    @quiet
    def taylor(self, point: Linearization, order: int) -> Array:
        """Coefficients of the path in the pseudo-arclength of `point`, shape (order + 1, 3n + 1).

        H is quadratic in its unknowns, lambda, w and F, so coefficient k solves H' c_k = -(products of lower ones):
        one solve and two products with A an order (Cochelin's asymptotic numerical method).
        """
        n = self.n
        c = np.zeros((order + 1, 3 * n + 1))
        c[0] = point.u
        c[1:2] = point.tangent
        x, z1, z2, lam = c[:, :n], c[:, n : 2 * n], c[:, 2 * n : -1], c[:, -1:]
        w, pull = np.zeros((order + 1, n)), np.zeros((order + 1, n))
        defect = np.empty(3 * n)
        for k in range(2, order + 1):
            j = k - 1
            slope = self.problem.A @ x[j]
            w[j] = slope + self.rho * lam[j]
            pull[j] = x[j] - (slope + self.structure.transpose @ (x[j] - z2[j]) - z1[j])
            defect[:n] = convolved(lam, pull, k)
            defect[n : 2 * n] = convolved(z1, x, k)
            defect[2 * n :] = convolved(z2, w, k)
            c[k] = point.solve(-defect)
        return c

    def quadratic(self) -> Quadratic:
        """H as affine parts and one product of them, for proofs of paths."""
        return kkt_form(self)

    def certify_end(self, y: Array) -> str:
        """A sentence on the exact solution at x, where there is one.

        Parameters
        ----------
        y : ndarray
            The end of a path.
        """
        return exact_end(self.problem, y[: self.n])

    def max_step(self, u: Array, v: Array) -> float:
        """How far along v until x, z1, z2 or w = A x + q + lambda rho reaches zero; lambda itself is free."""
        n = self.n
        inside = longest_step(u[:-1], v[:-1])
        w = self.problem.w(u[:n]) + u[-1] * self.rho
        return min(inside, longest_step(w, self.problem.A @ v[:n] + v[-1] * self.rho))

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """The natural residual and the gap x'w of the unrelaxed problem at x."""
        return observed(self.problem, y[: self.n])


def _start(problem: LCP, x0: Any, z1: Any, z2: Any, w0: Any) -> Start:
    """The given vectors, checked, with the defaults of `KKTHomotopy` for the others."""
    n = problem.n
    given = {
        name: positive_vector(name, value, n)
        for name, value in (("x0", x0), ("z1", z1), ("z2", z2), ("w0", w0))
        if value is not None
    }
    fallback = default_start(problem) if "x0" not in given else _from_point(problem, given["x0"])
    if "w0" in given:
        fallback = centred(fallback.x0, given["w0"])
    return evolve(fallback, **given)


def _from_point(problem: LCP, x0: Array) -> Start:
    w0 = relaxed_w(problem, x0, natural_units(problem)[1])
    if (problem.w(x0) > 0.0).all():
        return Start(x0, np.ones(problem.n), np.ones(problem.n), w0)
    return centred(x0, w0)
