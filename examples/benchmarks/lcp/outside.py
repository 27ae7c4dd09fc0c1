"""Families that the solver was not tuned on: what outsiders' problems cost, in processor seconds a problem.

    python examples/benchmarks/lcp/outside.py [FAMILY ...] [--seed S] [--limit S] [--before CHECKOUT] [--write PAGE]
        [--homotopy NAME] [--each K]

Prints how many are decided, the median and the largest time, of another checkout too, and puts the table into a file in
place of the one there. The steps of a stack are solved by `lcp.Solver` where there is one. `--each`: Stacks, arches and
piles of each size, in place of those of `bodies.EACH`.
"""

import argparse
import json
import math
import os
import pickle
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bodies
import numpy as np
import scipy.sparse as sp
from scipy.optimize import linprog

from continuation.arrays import Array
from problems import lcp
from problems.scenes.game import bimatrix
from problems.scenes.planar import Body, free_motion, impulses, time_step

Data = tuple[Array, Array]


def box_qp(seed: int) -> Iterator[Data]:
    """The optimality conditions of min x'Qx/2 + c'x over 0 <= x <= 1, Q with integers up to 50, indefinite."""
    for k in range(20):
        r = np.random.default_rng([seed, k])
        n, density = ((20, 1.0), (30, 0.6), (50, 0.5), (100, 0.25))[k % 4]
        Q = np.triu(r.integers(-50, 51, (n, n)) * (r.random((n, n)) < density)).astype(float)
        Q += np.triu(Q, 1).T
        one = np.eye(n)
        yield np.block([[Q, one], [-one, 0.0 * one]]), np.append(r.integers(-50, 51, n), np.ones(n))


def collapse(seed: int) -> Iterator[Data]:
    """Elastic, perfectly plastic trusses, loaded beyond what they can carry: multipliers of both yield limits."""
    for k in range(30):
        r = np.random.default_rng([seed, k])
        bars = (6, 10, 16, 25)[k % 4]
        B, E = r.standard_normal((bars // 2, bars)), np.diag(r.uniform(1.0, 3.0, bars))
        load, limit = r.standard_normal(bars // 2), r.uniform(0.5, 1.5, bars)
        elastic = E @ B.T @ np.linalg.inv(B @ E @ B.T)
        S = E - elastic @ B @ E
        # The largest multiple of the load with stresses in equilibrium within the limits.
        program = linprog(np.append(np.zeros(bars), -1.0), A_eq=np.column_stack([B, -load]), b_eq=np.zeros(bars // 2),
                          bounds=[*zip(-limit, limit), (0.0, None)])  # fmt: skip
        N = np.column_stack([np.eye(bars), -np.eye(bars)])
        factor = program.x[-1] * (1.02, 1.5)[k % 2]
        yield N.T @ S @ N, np.append(limit, limit) - N.T @ (elastic @ load) * factor


def contact(seed: int) -> Iterator[Data]:
    """A time step of bodies piled at random, with friction, from small velocities."""
    for k in range(100):
        r = np.random.default_rng([seed, k])
        number, mu = (3, 5, 10, 15)[k % 4], (0.3, 0.7, 1.5)[k % 3]
        bodies = [(r.uniform(0.5, 2.0), r.uniform(0.05, 0.3), *r.uniform(0.0, 5.0, 2)) for _ in range(number)]
        contacts = []
        for a in range(number):
            for b in (-1, int(r.integers(number))):
                b = -1 if a == b else b
                angle = r.uniform(0.3 * np.pi, 0.7 * np.pi) if b < 0 else r.uniform(0.0, 2.0 * np.pi)
                n, reach = np.array([np.cos(angle), np.sin(angle)]), r.uniform(0.2, 0.6)
                contacts.append((a, b, *(np.array(bodies[a][2:]) - reach * n), *n))
        A, J, inverse = time_step(bodies, contacts, mu)
        force = np.concatenate([[0.0, -9.81 * m, 0.0] for m, _, _, _ in bodies])
        u = J @ (r.normal(0.0, 0.3, inverse.size) + 0.01 * inverse * force)
        yield A, free_motion(u)


def unsolvable(seed: int) -> Iterator[Data]:
    """Feasible, without a solution, n <= 12: two unknowns that have none beside others that do, in random order."""
    r = np.random.default_rng(seed)
    found: list[Data] = []
    while len(found) < 50:
        A, q = r.integers(-2, 3, (2, 2)).astype(float), r.integers(-2, 3, 2).astype(float)
        feasible = linprog(np.zeros(2), A_ub=-A, b_ub=q).status == 0
        if not feasible or lcp.solve_by_enumeration(lcp.LCP(A, q)).solvable:
            continue
        n = int(r.integers(3, 13))
        G, order = r.standard_normal((n - 2, n - 2)), r.permutation(n)
        whole = np.zeros((n, n))
        whole[:2, :2], whole[2:, 2:] = A, G @ G.T / n + 0.5 * np.eye(n - 2)
        found.append((whole[np.ix_(order, order)], np.append(q, r.standard_normal(n - 2))[order]))
    yield from found


def game(C: Array, D: Array) -> Data:
    """The LCP of a game with these costs."""
    problem = bimatrix(C - C.min() + 1.0, D - D.min() + 1.0)
    return problem.A, problem.q


KINDS = "normal", "0-1", "covariant -.9", "covariant .5", "zero-sum", "unit vectors", "dual cyclic", "uniform"


def game_of(kind: str, m: int, r: np.random.Generator) -> Data:
    """A game with m actions a player, of one of `KINDS`."""
    X, Y = r.standard_normal((2, m, m))
    if kind == "0-1":
        X, Y = (X < 0.0).astype(float), (Y < 0.0).astype(float)
    elif kind.startswith("covariant"):
        rho = float(kind.split()[1])
        Y = rho * X + math.sqrt(1.0 - rho * rho) * Y
    elif kind == "zero-sum":
        Y = -X
    elif kind == "unit vectors":
        X, Y = np.zeros((m, m)), -r.random((m, m))
        X[r.integers(0, m, m), np.arange(m)] = -1.0
    elif kind == "dual cyclic":
        V = np.vander(np.linspace(-1.0, 1.0, 2 * m), m + 1, increasing=True)[:, 1:]
        V = V - V.mean(axis=0)
        X, Y = -V[m:], -V[:m][r.permutation(m)].T
    elif kind == "uniform":
        X, Y = r.random((2, m, m))
    return game(X, Y)


def games(seed: int) -> Iterator[Data]:
    """Seven kinds of games, n = 40, 100, 300: normal, 0-1, covariant, zero-sum, unit vectors, dual cyclic."""
    for k in range(63):
        yield game_of(KINDS[k % 7], (20, 50, 150)[k // 21], np.random.default_rng([seed, k]))


def planted(A: Array, r: np.random.Generator) -> Data:
    """A q with a solution."""
    n = A.shape[0]
    x, w = r.uniform(0.1, 2.0, (2, n))
    support = r.random(n) < 0.5
    q: Array = np.where(support, 0.0, w) - A @ np.where(support, x, 0.0)
    return A, q


def nonmonotone_sparse(seed: int) -> Iterator[Data]:
    """n = 200, one entry in twenty, normal, stored sparse."""
    for k in range(5):
        r = np.random.default_rng([seed, k])
        yield planted(sp.random_array((200, 200), density=0.05, rng=r, data_sampler=r.standard_normal).tocsr(), r)


def nonmonotone_dense(seed: int) -> Iterator[Data]:
    """n = 200, normal."""
    for k in range(5):
        r = np.random.default_rng([seed, k])
        yield planted(r.standard_normal((200, 200)), r)


def monotone(seed: int) -> Iterator[Data]:
    """n = 20 to 200: definite, not symmetric or symmetric, or of half the rank."""
    for k in range(30):
        r = np.random.default_rng([seed, k])
        n = (20, 60, 200)[k % 3]
        M, S = r.standard_normal((2, n, n))
        A = M @ M.T / n + (S - S.T) / math.sqrt(n) if k % 2 else M[:, : n // 2] @ M[:, : n // 2].T / n
        yield planted(A, r)


def small(seed: int) -> Iterator[Data]:
    """n = 1 to 8, integers."""
    for k in range(200):
        r = np.random.default_rng([seed, k])
        n = int(r.integers(1, 9))
        yield r.integers(-5, 6, (n, n)).astype(float), r.integers(-5, 6, n).astype(float)


def grids(seed: int) -> Iterator[Data]:
    """Membranes over an obstacle, 12 x 12 to 30 x 30 points, and strings, sparse."""
    for k in range(12):
        r = np.random.default_rng([seed, k])
        m = (12, 20, 30)[k % 3]
        line = sp.diags_array([-np.ones(m - 1), 2.0 * np.ones(m), -np.ones(m - 1)], offsets=[-1, 0, 1])
        A = sp.kronsum(line, line, format="csr") if k % 2 else line.tocsr()
        yield A, r.normal(0.0, 0.1, A.shape[0]) - A @ r.uniform(0.0, 1.0, A.shape[0])


def stack(seed: int) -> Iterator[Data]:
    """100 steps of 25 boxes on each other, n = 200, pushed by a growing force."""
    boxes, h = 25, 0.01
    bodies: list[Body] = [(1.0, 1.0 / 6.0, 0.0, k + 0.5) for k in range(boxes)]
    contacts = [(k, k - 1, side, float(k), 0.0, 1.0) for k in range(boxes) for side in (-0.5, 0.5)]
    A, J, inverse = time_step(bodies, contacts, 0.5)
    solver, v = lcp.Solver(A), np.zeros(inverse.size)
    for k in range(100):
        force = np.tile([0.2 * math.sin(k / 8.0), -9.81, 0.0], boxes)
        force[-3] += (0.08 + 0.001 * (seed % 7)) * k
        free = v + h * inverse * force
        q = free_motion(J @ free)
        yield A, q
        found = solver.solve(q)
        assert found.x is not None
        v = free + inverse * (J.T @ impulses(found.x))


FAMILIES = {
    "indefinite box QPs, n = 40 to 200": box_qp,
    "trusses beyond collapse, n = 12 to 50": collapse,
    "piles with friction, n = 24 to 120": contact,
    "feasible, unsolvable, n = 3 to 12": unsolvable,
    "games of seven kinds, n = 40, 100, 300": games,
    "monotone, n = 20 to 200": monotone,
    "small integers, n = 1 to 8": small,
    "grids, n = 12 to 900": grids,
    "steps of a stack, n = 200": stack,
    "stacks, n = 40 to 480": bodies.stacks,
    "arches, n = 48 to 496": bodies.arches,
    "piles, n = 44 to 520": bodies.piles,
    "nonmonotone, sparse, n = 200": nonmonotone_sparse,
    "nonmonotone, dense, n = 200": nonmonotone_dense,
}
"""All but the last two are tried where none is named."""


def timed(problems: list[Data], limit: float, homotopy: str, checkout: str) -> list[Any]:
    """(outcome, seconds) of each, in a process that has the package of a checkout."""
    with tempfile.NamedTemporaryFile(suffix=".pickle") as file:
        pickle.dump(problems, file)
        file.flush()
        child = [sys.executable, str(Path(__file__).with_name("timed.py")), file.name, str(limit), homotopy]
        environment = {**os.environ, "PYTHONPATH": checkout}
        done = subprocess.run(
            child, env=environment, check=True, capture_output=True, text=True, cwd=tempfile.gettempdir()
        )
    found: list[Any] = json.loads(done.stdout)
    return found


def cell(found: list[Any]) -> str:
    """How many are decided, and the median and the largest time in milliseconds."""
    decided = sum(outcome not in ("NOT_FOUND", "STATIONARY") for outcome, _ in found)
    taken = 1e3 * np.array([seconds for _, seconds in found])
    return f"{decided}, {_digits(float(np.median(taken)))} ms, {_digits(taken.max())} ms"


def _digits(value: float) -> str:
    return f"{value:.2g}" if value < 99.5 else f"{value:.0f}"


def main() -> None:
    """Run the families asked for."""
    parser = argparse.ArgumentParser()
    parser.add_argument("families", nargs="*", default=[])
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--limit", type=float, default=10.0)
    parser.add_argument("--homotopy", default="auto")
    parser.add_argument("--each", type=int)
    parser.add_argument("--before")
    parser.add_argument("--write")
    arguments = parser.parse_args()
    bodies.EACH = (arguments.each,) * 3 if arguments.each else bodies.EACH
    here = str(Path(__file__).parents[3])
    lines = ["| family | before | now | ratio of medians |", "|---|---|---|---|"]
    for title, family in list(FAMILIES.items()):
        if arguments.families and family.__name__ not in arguments.families:
            continue
        if not arguments.families and family in (nonmonotone_sparse, nonmonotone_dense):
            continue
        problems = list(family(arguments.seed))
        now = timed(problems, arguments.limit, arguments.homotopy, here)
        before = timed(problems, arguments.limit, arguments.homotopy, arguments.before) if arguments.before else []
        ratio = np.median([s for _, s in now]) / np.median([s for _, s in before]) if before else math.nan
        lines.append(f"| {len(problems)} {title} | {cell(before) if before else '-'} | {cell(now)} | {ratio:.2g} |")
        print(lines[-1], flush=True)
    if arguments.write:
        page = Path(arguments.write)
        table = "\n".join(lines) + "\n"
        page.write_text(re.sub(r"\| family \|.*\n(\|.*\n)*", lambda _: table, page.read_text(), count=1))


if __name__ == "__main__":
    main()
