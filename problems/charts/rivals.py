"""Adapters to outside solvers, used if installed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from importlib.machinery import PathFinder
from importlib.metadata import packages_distributions, version
from importlib.util import find_spec, module_from_spec
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.sparse.linalg import splu

from continuation.arrays import Array
from continuation.chart import Answer, Method, Problem, Rung
from continuation.counts import Counts

PITCON = "PITCON (dense)"

STEPS = 1000
"""Limit per path; a successful plain loop needs some hundred."""


@frozen
class _Aim:
    value: float
    direction: float

    @classmethod
    def of(cls, problem: Problem) -> _Aim:
        for event in problem.options.get("events", ()):
            return cls(event.value, event.direction)
        target = problem.subject.target
        return cls(target, math.copysign(1.0, target - problem.subject.start()[1]))

    def crossed(self, before: float, after: float) -> bool:
        return self.direction * (before - self.value) < 0.0 <= self.direction * (after - self.value)


@frozen
class _Counted:
    homotopy: Any
    counts: Counts = field(factory=Counts)

    @property
    def start(self) -> Array:
        y, lam = self.homotopy.start()
        return np.append(y, lam)

    def residual(self, u: Array) -> Array:
        self.counts.residuals += 1
        return np.asarray(self.homotopy.residual(u[:-1], float(u[-1])))

    def jacobian(self, u: Array) -> tuple[Any, Array]:
        self.counts.factorizations += 1
        return self.homotopy.jacobian(u[:-1], float(u[-1]))  # type: ignore[no-any-return]

    def solve(self, u: Array, row: Array, r: Array, rho: float) -> Array:
        """Solve H' x = r, row x = rho; a sparse H_y by block elimination."""
        self.counts.solves += 1
        H_y, H_lam = self.jacobian(u)
        if not sp.issparse(H_y):
            whole = np.block([[np.asarray(H_y), H_lam[:, None]], [row[None, :]]])
            return np.linalg.solve(whole, np.append(r, rho))
        w, x = splu(sp.csc_array(H_y)).solve(np.column_stack((H_lam, r))).T
        lam = (rho - row[:-1] @ x) / (row[-1] - row[:-1] @ w)
        return np.append(x - lam * w, lam)

    def newton(self, u: Array, row: Array, tolerance: float) -> tuple[Array | None, int]:
        """Newton in the plane normal to `row`; returns (point, iterations)."""
        for k in range(8):
            step = self.solve(u, row, -self.residual(u), 0.0)
            u = u + step
            if np.linalg.norm(step) <= tolerance * (1.0 + np.linalg.norm(u)):
                return u, k + 1
        return None, 8

    def land(self, before: Array, after: Array, value: float, tolerance: float) -> Answer:
        guess = before + (value - before[-1]) / (after[-1] - before[-1]) * (after - before)
        end, _ = self.newton(guess, np.eye(1, guess.size, guess.size - 1)[0], tolerance)
        return Answer(self.counts, end=end)


def _loop(problem: Problem, rung: Rung) -> Answer:
    """Plain Keller continuation, without turning points."""
    aim, ours = _Aim.of(problem), _Counted(problem.subject)
    u, counts = ours.start, ours.counts
    zero, h = np.zeros(u.size - 1), 0.1
    v = np.append(zero, 1.0 if aim.value > u[-1] else -1.0)
    v = ours.solve(u, v, zero, 1.0)
    v /= np.linalg.norm(v)
    while counts.accepted < STEPS and h > 1e-9:
        following, iterations = ours.newton(u + h * v, v, rung.value)
        if following is not None and aim.crossed(u[-1], following[-1]):
            answer = ours.land(u, following, aim.value, rung.value)
            if answer.end is not None:
                return answer
            following = None
        if following is None:
            h, counts.rejected = h / 2.0, counts.rejected + 1
            continue
        counts.accepted += 1
        t = ours.solve(following, v, zero, 1.0)
        u, v = following, t / np.linalg.norm(t)
        h *= 2.0 if iterations <= 3 else 1.0 if iterations <= 5 else 0.5
    raise ArithmeticError(f"the plain loop did not arrive in {counts.accepted} steps")


def _pitcon(problem: Problem, rung: Rung) -> Answer:
    """Dense PITCON 6.1 (pysces)."""
    library, aim, ours = _pitcon_library(), _Aim.of(problem), _Counted(problem.subject)
    x = ours.start
    N = x.size

    def residual(x: Array) -> tuple[Array, int]:
        return np.append(ours.residual(x), 0.0), 0

    def jacobian(x: Array) -> tuple[Array, int]:
        H_y, H_lam = ours.jacobian(x)
        whole = np.zeros((N, N))
        whole[:-1] = np.column_stack((H_y.toarray() if sp.issparse(H_y) else H_y, H_lam))
        return whole, 0

    iwork, rwork = np.zeros(30 + N, dtype=np.int32), np.zeros(30 + 4 * N + N * N)
    # N, start and target on lam, full Newton with this Jacobian, work-space offsets.
    iwork[[1, 4, 7, 12, 13, 14, 15, 16]] = N, N, 6, 30, iwork.size, 30, rwork.size, 10
    # Tolerances; least, largest, first step; direction; target.
    rwork[:7] = rung.value, rung.value, 1e-6, 30.0, 0.1, 1.0 if aim.value > x[-1] else -1.0, aim.value
    # PITCON returns a target after the two points around it.
    none, before, after = np.zeros(1, dtype=np.int32), float(x[-1]), float(x[-1])
    for _ in range(STEPS):
        error, iwork, rwork, x = library.pitcon1(jacobian, np.zeros(1), residual, none, iwork, rwork, x)
        if error:
            raise ArithmeticError(f"PITCON ended with error {error}")
        if iwork[0] == 3 and aim.crossed(before, after):
            return Answer(ours.counts, end=x.copy())
        if iwork[0] == 2:
            before, after, ours.counts.accepted = after, float(x[-1]), ours.counts.accepted + 1
    raise ArithmeticError(f"PITCON did not arrive in {STEPS} calls")


def _pitcon_library() -> Any:
    """Load the compiled routine only: importing pysces prints a page and makes folders."""
    package = find_spec("pysces")
    if package is None or package.submodule_search_locations is None:
        raise ImportError("pysces is not installed")
    places = [f"{place}/pitcon" for place in package.submodule_search_locations]
    spec = PathFinder.find_spec("pitcon", places)
    if spec is None or spec.loader is None:
        raise ImportError("this pysces has no PITCON")
    library = module_from_spec(spec)
    spec.loader.exec_module(library)
    return library


def curve_followers(compare: bool) -> list[Method]:
    """The plain loop, and PITCON if requested and installed."""
    found = {"plain scipy loop": _loop, **({PITCON: _pitcon} if compare and installed("pysces") else {})}
    return [Method(name, _quiet(follow), applies=_is_matrix, outside=True) for name, follow in found.items()]


def _is_matrix(problem: Problem) -> bool:
    """Whether H_y is a numpy or scipy matrix."""
    y, lam = problem.subject.start()
    H_y, _ = problem.subject.jacobian(y, lam)
    return isinstance(H_y, np.ndarray) or bool(sp.issparse(H_y))


def _quiet(follow: Callable[[Problem, Rung], Answer]) -> Callable[[Problem, Rung], Answer]:
    def run(problem: Problem, rung: Rung) -> Answer:
        with np.errstate(all="ignore"):
            return follow(problem, rung)

    return run


def notes(modules: Iterable[str], compare: bool) -> list[str]:
    """Versions of packages that take part; names of missing ones."""
    if not compare:
        return []
    modules = list(dict.fromkeys(modules))
    there = [_versioned(module) for module in modules if installed(module)]
    absent = [module for module in modules if not installed(module)]
    return [
        *([f"outside solvers: {', '.join(there)}"] if there else []),
        *([f"outside solvers left out, not installed: {', '.join(absent)}"] if absent else []),
    ]


def _versioned(module: str) -> str:
    distributions = packages_distributions().get(module, [])
    return " ".join([*distributions[:1], *(version(name) for name in distributions[:1])]) or module


def installed(module: str) -> bool:
    """Whether a module can be imported."""
    return find_spec(module) is not None
