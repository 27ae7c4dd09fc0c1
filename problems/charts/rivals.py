"""Other ways to follow a curve: a plain loop, and installed packages."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from contextlib import redirect_stdout
from functools import partial
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from continuation.arrays import Array
from continuation.chart import Answer, Method, Problem
from continuation.counts import Counts
from continuation.linear import Banded

STEPS = 1000
"""Limit per path; a successful plain loop needs some hundred."""

LONGEST = 30.0
"""Longest step of PITCON and bice."""


class _Curve:
    """A problem's equations, counted, and where its path ends; `direction` of lam at the start, `last` at the end."""

    def __init__(self, problem: Problem) -> None:
        y, lam = problem.subject.start()
        self.subject, self.counts, self.start = problem.subject, Counts(), np.append(y, lam)
        self.aim = math.nan if problem.truth.end is None else float(problem.truth.end[-1])
        self.direction = math.copysign(1.0, self.aim - lam)
        self.last = self.direction * (-1.0) ** (problem.truth.turns or 0)

    def arrived(self, before: float, after: float) -> bool:
        """Whether lam passes the target in the direction of the path's end."""
        return self.last * (before - self.aim) < 0.0 <= self.last * (after - self.aim)

    def residual(self, u: Array) -> Array:
        self.counts.residuals += 1
        return np.asarray(self.subject.residual(u[:-1], float(u[-1])))

    def jacobian(self, u: Array) -> tuple[Any, Array]:
        self.counts.factorizations += 1
        H_y, H_lam = self.subject.jacobian(u[:-1], float(u[-1]))
        return H_y.tosparse() if isinstance(H_y, Banded) else H_y, H_lam

    def solve(self, u: Array, row: Array, right: Array) -> Array:
        """Solve H' x = right[:-1], row x = right[-1]."""
        self.counts.solves += 1
        H_y, H_lam = self.jacobian(u)
        if sp.issparse(H_y):
            whole = sp.block_array([[H_y, H_lam[:, None]], [row[None, :-1], row[None, -1:]]], format="csc")
            return np.asarray(splu(whole).solve(right))
        return np.linalg.solve(np.vstack([np.column_stack((H_y, H_lam)), row]), right)

    def newton(self, u: Array, row: Array, tolerance: float) -> tuple[Array | None, int]:
        """Newton in the plane normal to `row`; returns (point, iterations)."""
        for k in range(8):
            step = self.solve(u, row, np.append(-self.residual(u), 0.0))
            u = u + step
            if np.linalg.norm(step) <= tolerance * (1.0 + np.linalg.norm(u)):
                return u, k + 1
        return None, 8

    def tangent(self, u: Array, before: Array) -> Array:
        v = self.solve(u, before, np.eye(u.size)[-1])
        return np.asarray(v / np.linalg.norm(v))

    def land(self, before: Array, after: Array, tolerance: float) -> Answer:
        guess = before + (self.aim - before[-1]) / (after[-1] - before[-1]) * (after - before)
        end, _ = self.newton(guess, np.eye(guess.size)[-1], tolerance)
        return Answer(self.counts, end=end)


def _loop(curve: _Curve, tolerance: float) -> Answer:
    u, counts, h = curve.start, curve.counts, 0.1
    v = curve.tangent(u, curve.direction * np.eye(u.size)[-1])
    while counts.accepted < STEPS and h > 1e-9:
        following, iterations = curve.newton(u + h * v, v, tolerance)
        if following is None:
            h, counts.rejected = h / 2.0, counts.rejected + 1
        elif curve.arrived(u[-1], following[-1]):
            return curve.land(u, following, tolerance)
        else:
            h *= 2.0 if iterations <= 3 else 1.0 if iterations <= 5 else 0.5
            u, v, counts.accepted = following, curve.tangent(following, v), counts.accepted + 1
    raise ArithmeticError(f"the plain loop did not arrive in {counts.accepted} steps")


def _pitcon(curve: _Curve, tolerance: float) -> Answer:
    """Dense PITCON 6.1, of pysces."""
    # Importing pysces prints a page and makes folders.
    package: Any = find_spec("pysces")
    (place,) = package.submodule_search_locations
    spec: Any = PathFinder.find_spec("pitcon", [f"{place}/pitcon"])
    spec.loader.exec_module(library := module_from_spec(spec))
    x = curve.start
    N = x.size

    def residual(x: Array) -> tuple[Array, int]:
        return np.append(curve.residual(x), 0.0), 0

    def jacobian(x: Array) -> tuple[Array, int]:
        H_y, H_lam = curve.jacobian(x)
        whole = np.zeros((N, N))
        whole[:-1] = np.column_stack((H_y.toarray() if sp.issparse(H_y) else H_y, H_lam))
        return whole, 0

    iwork, rwork = np.zeros(30 + N, dtype=np.int32), np.zeros(30 + 4 * N + N * N)
    # N, start and target on lam, full Newton with this Jacobian, work-space offsets.
    iwork[[1, 4, 7, 12, 13, 14, 15, 16]] = N, N, 6, 30, iwork.size, 30, rwork.size, 10
    # Tolerances; least, largest, first step; direction; target.
    rwork[:7] = tolerance, tolerance, 1e-6, LONGEST, 0.1, curve.direction, curve.aim
    # PITCON returns a target after the two points around it.
    none, before, after = np.zeros(1, dtype=np.int32), float(x[-1]), float(x[-1])
    for _ in range(STEPS):
        error, iwork, rwork, x = library.pitcon1(jacobian, np.zeros(1), residual, none, iwork, rwork, x)
        if error:
            raise ArithmeticError(f"PITCON ended with error {error}")
        if iwork[0] == 3 and curve.arrived(before, after):
            return Answer(curve.counts, end=x.copy())
        if iwork[0] == 2:
            before, after, curve.counts.accepted = after, float(x[-1]), curve.counts.accepted + 1
    raise ArithmeticError(f"PITCON did not arrive in {STEPS} calls")


def _bice(curve: _Curve, tolerance: float) -> Answer:
    """The package's arclength stepper with its sparse Newton solver; steps may be longer than by default."""
    bice = import_module("bice")
    model, equation, u = bice.Problem(), bice.Equation(shape=(curve.start.size - 1,)), curve.start
    equation.u, equation.lam = u[:-1], u[-1]
    equation.rhs = lambda y: curve.residual(np.append(y, equation.lam))
    equation.jacobian = lambda y: sp.csr_matrix(curve.jacobian(np.append(y, equation.lam))[0])
    model.add_equation(equation)
    model.continuation_parameter = (equation, "lam")
    model.settings.neigs = 0
    stepper = model.continuation_stepper
    stepper.ds, stepper.ds_max, stepper.ds_increase_factor, stepper.ndesired_newton_steps = 0.1, LONGEST, 2.0, 4
    stepper.convergence_tolerance = tolerance
    with redirect_stdout(io.StringIO()):
        for _ in range(STEPS):
            before = u
            model.continuation_step()
            u, curve.counts.accepted = np.append(equation.u, equation.lam), curve.counts.accepted + 1
            if curve.arrived(before[-1], u[-1]):
                return curve.land(before, u, tolerance)
    raise ArithmeticError(f"bice did not arrive in {STEPS} steps")


Follow = Callable[[_Curve, float], Answer]

FOLLOWERS: dict[str, tuple[str, Follow]] = {
    "plain scipy loop": ("", _loop),
    "PITCON (dense)": ("pysces", _pitcon),
    "bice": ("bice", _bice),
}


def curve_followers(compare: bool) -> list[Method]:
    """The plain loop, and installed packages if `compare`."""
    taken = {name: one for name, one in FOLLOWERS.items() if not one[0] or (compare and installed(one[0]))}
    return [Method(name, partial(_follow, follow), outside=True) for name, (_, follow) in taken.items()]


@np.errstate(all="ignore")
def _follow(follow: Follow, problem: Problem, rung: float) -> Answer:
    return follow(_Curve(problem), rung)


def installed(module: str) -> bool:
    """Whether a module can be imported."""
    return find_spec(module) is not None
