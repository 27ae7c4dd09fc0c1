"""Bratu's problem by other software: a plain scipy loop, `bice`, and PITCON inside `pysces`.

Needs numpy and scipy, and the rival named; not `continuation`, so another interpreter can run it:
``python rivals.py plain|bice|pitcon interval|square SIZE`` prints one JSON object.
"""

import json
import sys
import time

import numpy as np
import scipy.sparse as sp
from scipy.linalg import solve_banded
from scipy.sparse.linalg import splu

UPPER = {"interval": 1.0, "square": 2.0}
"""Each path ends where lam falls below this on the upper branch."""


class Bratu:
    """Residual and derivative, with counters, and solves with H_y."""

    def __init__(self, kind, m):
        line = sp.diags_array([np.ones(m - 1), np.full(m, -2.0), np.ones(m - 1)], offsets=[-1, 0, 1], format="csc")
        eye = sp.eye_array(m, format="csc")
        self.kind = kind
        self.laplacian = line if kind == "interval" else sp.csc_array(sp.kron(eye, line) + sp.kron(line, eye))
        self.n, self.square = self.laplacian.shape[0], 1.0 / (m + 1.0) ** 2
        self.residuals = self.factorizations = 0

    def residual(self, y, lam):
        self.residuals += 1
        return self.laplacian @ y + lam * self.square * np.exp(y)

    def jacobian(self, y, lam):
        return self.laplacian + sp.diags_array([lam * self.square * np.exp(y)], offsets=[0], format="csc")

    def solve(self, y, lam, rhs):
        """H_y^{-1} rhs, shape (n, k)."""
        self.factorizations += 1
        if self.kind == "square":
            return splu(self.jacobian(y, lam)).solve(rhs)
        bands = np.ones((3, self.n))
        bands[1] = lam * self.square * np.exp(y) - 2.0
        return solve_banded((1, 1), bands, rhs)

    def bordered(self, u, row, r, rho):
        column = self.square * np.exp(u[:-1])
        w, x = self.solve(u[:-1], u[-1], np.column_stack((column, r))).T
        lam = (rho - row[:-1] @ x) / (row[-1] - row[:-1] @ w)
        return np.append(x - lam * w, lam)


def plain(problem, upper):
    """Keller's pseudo-arclength continuation as one writes it in an afternoon."""
    u, v, h, steps, fold = np.zeros(problem.n + 1), np.append(np.zeros(problem.n), 1.0), 0.5, 0, None

    def tangent(u, along):
        t = problem.bordered(u, along, np.zeros(problem.n), 1.0)
        return t / np.linalg.norm(t)

    def correct(u, border):
        for iteration in range(8):
            increment = problem.bordered(u, border, -problem.residual(u[:-1], u[-1]), 0.0)
            u = u + increment
            if np.linalg.norm(increment) <= 1e-9 * (1.0 + np.linalg.norm(u)):
                return u, iteration + 1
        return None, 8

    v = tangent(u, v)
    while not (v[-1] < 0.0 and u[-1] < upper):
        w, iterations = correct(u + h * v, v)
        t = tangent(w, v) if w is not None else None
        if t is None or t @ v < 0.7:
            h *= 0.5
            continue
        if v[-1] * t[-1] < 0.0:
            # The fold: a secant iteration on the tangent's last component.
            (a, ga), (b, gb) = (0.0, v[-1]), (v @ (w - u), t[-1])
            for _ in range(8):
                s = b - gb * (b - a) / (gb - ga)
                p, _ = correct(u + s * v + (w - u - (v @ (w - u)) * v) * (s / (v @ (w - u))) ** 2, v)
                (a, ga), (b, gb) = (b, gb), (s, tangent(p, v)[-1])
                if abs(gb) < 1e-13 or abs(b - a) < 1e-12:
                    break
            fold = p[-1]
        u, v, steps = w, t, steps + 1
        h *= 2.0 if iterations <= 4 else 1.0 if iterations <= 5 else 0.7
    return steps, fold


def bice(problem, upper):
    """Its own arclength stepper, allowed longer steps than by default; the fold is the largest lam of a point."""
    from bice import Equation, Problem

    class Discrete(Equation):
        def __init__(self):
            super().__init__(shape=(problem.n,))
            self.u, self.lam = np.zeros(problem.n), 0.0

        def rhs(self, u):
            return problem.residual(u, self.lam) / problem.square

        def jacobian(self, u):
            problem.factorizations += 1
            return sp.csr_matrix(problem.jacobian(u, self.lam) / problem.square)

    model = Problem()
    equation = Discrete()
    model.add_equation(equation)
    model.continuation_parameter = (equation, "lam")
    model.settings.neigs = 0
    stepper = model.continuation_stepper
    stepper.ds, stepper.ds_max, stepper.ds_increase_factor, stepper.ndesired_newton_steps = 0.5, 1e3, 2.0, 4
    points = [0.0]
    while not (len(points) > 2 and points[-1] < points[-2] and points[-1] < upper):
        model.continuation_step()
        points.append(equation.lam)
        if len(points) > 1000:
            raise RuntimeError("bice did not come round the fold in 1000 steps")
    return len(points) - 1, max(points)


def pitcon(problem, upper):
    """PITCON 6.1 as pysces wraps it: dense matrices only; limit points in lam are sought."""
    from pysces.pitcon import pitcon as wrapper

    N = problem.n + 1

    def fx(x):
        return np.append(problem.residual(x[:-1], x[-1]), 0.0), 0

    def df(x):
        problem.factorizations += 1
        whole = np.zeros((N, N))
        whole[:-1, :-1] = problem.jacobian(x[:-1], x[-1]).toarray()
        whole[:-1, -1] = problem.square * np.exp(x[:-1])
        return whole, 0

    iwork, rwork, x = np.zeros(30 + N, dtype=np.int32), np.zeros(30 + 4 * N + N * N), np.zeros(N)
    # Start on lam, seek limit points in lam, Newton's method with the user's Jacobian.
    iwork[1], iwork[5], iwork[12], iwork[13], iwork[14], iwork[15], iwork[16] = N, N, 30, iwork.size, 30, rwork.size, 10
    iwork[7] = 6
    rwork[:6] = 1e-10, 1e-10, 1e-6, 30.0, 0.5, 1.0
    steps, fold = 0, None
    ipar, fpar = np.zeros(1, dtype=np.int32), np.zeros(1)
    for _ in range(300):
        error, iwork, rwork, x = wrapper.pitcon1(df, fpar, fx, ipar, iwork, rwork, x)
        if error:
            raise RuntimeError(f"PITCON says {error}")
        steps += iwork[0] == 2
        if iwork[0] == 4:
            fold = float(x[-1])
        if fold is not None and x[-1] < upper:
            return int(steps), fold
    raise RuntimeError("PITCON did not come round the fold in 300 calls")


def measure(name, kind, m, repeats=5):
    """The fastest of several runs: seconds, steps, factorisations, residuals, lam at the fold."""
    best = None
    for _ in range(repeats):
        problem = Bratu(kind, m)
        begin = time.process_time()
        steps, fold = {"plain": plain, "bice": bice, "pitcon": pitcon}[name](problem, UPPER[kind])
        seconds = time.process_time() - begin
        if best is None or seconds < best["seconds"]:
            best = {"seconds": seconds, "steps": steps, "factorizations": problem.factorizations}
            best |= {"residuals": problem.residuals, "fold": fold}
    return best


if __name__ == "__main__":
    print(json.dumps(measure(sys.argv[1], sys.argv[2], int(sys.argv[3]))))
