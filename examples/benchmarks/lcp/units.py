"""What must not matter: the units of rows and columns, a common factor, and how far apart the entries are.

    python examples/benchmarks/lcp/units.py units  [NUMBER] [SEED]   each problem again in random units
    python examples/benchmarks/lcp/units.py factor [NUMBER] [SEED]   LCP(s q, s A) for s = 1e-300 .. 1e300
    python examples/benchmarks/lcp/units.py truth  [NUMBER] [SEED]   every claim against exact enumeration

Prints what was claimed, and everything that is wrong; the exit status is 1 if anything is. Units that are not powers of
two round the entries, and so can spoil an exact proof or an exact solution, or give a problem without solution one at
1e16: such answers are counted by themselves ("decided by rounding"), and powers of two are held to the same outcome.
"""

import math
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable
from fractions import Fraction

import numpy as np

from continuation import Budget
from continuation.arrays import Array
from problems import lcp

Data = tuple[Array, Array]
Outcome = lcp.Outcome

SAME_X = 1e-8
"""Two points closer than this, relative to each component's size in balanced units, are the same."""

FACTORS = tuple(10.0**k for k in (-300, -200, -100, -30, -12, -8, -4, 0, 4, 8, 12, 30, 100, 200, 300))

SLOW = 20.0
"""Seconds of a solve that count as a failure."""

FARTHEST = 1e-10
"""The relative residual that `solve` allows where it is asked for nothing else."""

BUDGET = Budget(seconds=60.0)


def planted(A: Array, r: np.random.Generator) -> Array:
    """A q with a solution."""
    n = len(A)
    support = r.random(n) < 0.5
    x, w = r.integers(1, 17, (2, n)) / 8.0  # so that no rounding spoils what integers plant
    q: Array = np.where(support, 0.0, w) - A @ np.where(support, x, 0.0)
    return q


def definite(n: int, r: np.random.Generator) -> Data:
    """Symmetric positive definite."""
    M = r.standard_normal((n, n))
    return M @ M.T / n + 0.1 * np.eye(n), r.standard_normal(n)


def monotone(n: int, r: np.random.Generator) -> Data:
    """Positive definite, not symmetric."""
    A, q = definite(n, r)
    S = r.standard_normal((n, n))
    return A + S - S.T, q


def semidefinite(n: int, r: np.random.Generator) -> Data:
    """Symmetric, of half the rank, with a planted solution."""
    M = r.integers(-2, 3, (n, max(n // 2, 1))).astype(float)
    A = M @ M.T
    return A, planted(A, r)


def z_matrix(n: int, r: np.random.Generator) -> Data:
    """No positive entry off the diagonal; often infeasible."""
    return np.diag(r.uniform(0.0, n, n)) - r.random((n, n)) * (1 - np.eye(n)), r.standard_normal(n)


def game(n: int, r: np.random.Generator) -> Data:
    """A bimatrix game."""
    m = max(n // 2, 1)
    C, D = r.uniform(0.1, 1.0, (2, m, m))
    return np.block([[np.zeros((m, m)), C], [D.T, np.zeros((m, m))]]), -np.ones(2 * m)


def nonmonotone(n: int, r: np.random.Generator) -> Data:
    """Of no class, with a planted solution."""
    A = r.standard_normal((n, n))
    return A, planted(A, r)


def anything(n: int, r: np.random.Generator) -> Data:
    """Of no class; solvable, unsolvable or infeasible."""
    return r.standard_normal((n, n)), r.standard_normal(n)


def integer(n: int, r: np.random.Generator) -> Data:
    """Small integers, so that much is degenerate."""
    return r.integers(-2, 3, (n, n)).astype(float), r.integers(-2, 3, n).astype(float)


def sparse(n: int, r: np.random.Generator) -> Data:
    """Small integers, most of them zero."""
    A, q = integer(n, r)
    return A * (r.random((n, n)) < 0.4), q


def infeasible(n: int, r: np.random.Generator) -> Data:
    """No feasible point, by a positive combination of rows."""
    A, q = r.standard_normal((n, n)), r.standard_normal(n)
    A[0] = -A[1:].sum(axis=0) - r.random(n)
    q[0] = -q[1:].sum() - 0.1
    return A, q


KINDS: tuple[Callable[[int, np.random.Generator], Data], ...] = (
    definite, monotone, semidefinite, z_matrix, game, nonmonotone, anything, integer, sparse, infeasible,
)  # fmt: skip


QUICK = (definite, monotone, z_matrix, game)
"""Kinds that are solved before any path, at any order."""

LARGE = (13, 25)
"""Orders from which on active sets are tried before a problem is put into units of its own."""


def solved(A: Array, q: Array) -> lcp.Solution:
    """The answer, with every warning an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return lcp.solve(lcp.LCP(A, q), budget=BUDGET)


def same_outcome(one: lcp.Solution, other: lcp.Solution, exact: bool) -> bool:
    """Whether both say the same, or, of data that were rounded, what only rounding can tell apart."""
    if exact or one.outcome is other.outcome:
        return one.outcome is other.outcome
    return all(map(without_solution, (one, other))) or (one.solved and other.solved)


def lost_in_rounding(one: lcp.Solution, other: lcp.Solution, E: Array) -> bool:
    """Whether the solution of the one solves the other to the rounding of its entries, which exactly has none."""
    return (
        one.solved
        and without_solution(other)
        and lcp.certify(other.problem, one.x / E).relative_residual <= 4.0 * np.finfo(float).eps
    )


def without_solution(found: lcp.Solution) -> bool:
    """Whether it is said that there is no solution, or none that floats can hold."""
    unrepresented = found.outcome is Outcome.NOT_FOUND and found.exhaustion is not None
    return unrepresented or found.outcome in (Outcome.UNSOLVABLE, Outcome.INFEASIBLE_TO_PRECISION)


def same_point(one: Array, other: Array) -> bool:
    """Whether two points of one problem agree to round-off and its condition."""
    size = max(float(np.abs(one).max()), 1e-300)
    return bool(np.abs(one - other).max() <= SAME_X * size)


def units(number: int, seed: int) -> int:
    """Each problem and the same in other units, powers of two in every second one."""
    seen: Counter[str] = Counter()
    for k in range(number):
        r = np.random.default_rng([seed, k])
        kind = KINDS[k % len(KINDS)]
        A, q = kind(int(r.integers(2, 13)), r)
        n = len(q)
        D, E = 10.0 ** r.uniform(-8, 8, n), 10.0 ** r.uniform(-8, 8, n)
        exact = bool(k // len(KINDS) % 2)
        if exact:
            D, E = np.exp2(np.round(np.log2(D))), np.exp2(np.round(np.log2(E)))
        name = f"{kind.__name__}, powers of two" if exact else kind.__name__
        one, other = solved(A, q), solved(D[:, None] * A * E, D * q)
        seen[one.outcome.name] += 1
        if not (same_outcome(one, other, exact) or (not exact and lost_in_rounding(one, other, E))):
            seen[f"DIFFERS: {name}: {one.outcome.name} and {other.outcome.name}"] += 1
        elif one.outcome is not other.outcome:
            seen[f"decided by rounding: {name}: {one.outcome.name} and {other.outcome.name}"] += 1
        elif one.x is not None and other.x is not None and one.solved and not same_point(one.x, other.x * E):
            seen[f"another solution: {name}"] += 1
    return report(f"{number} problems in other units, seed {seed}", seen)


def factor(number: int, seed: int) -> int:
    """LCP(s q, s A) has the same solutions for all s.

    The power of two next to s rounds nothing, and is to change no digit of the answer. s itself rounds the entries, and
    so may make a singular problem one that is not.
    """
    seen: Counter[str] = Counter()
    for k in range(number):
        r = np.random.default_rng([seed, k])
        kind = KINDS[k % len(KINDS)]
        large = kind in QUICK and k // len(KINDS) % 5 == 4
        A, q = kind(int(r.integers(*(LARGE if large else (1, 6)))), r)
        one = solved(A, q)
        seen[one.outcome.name] += 1
        for s in FACTORS:
            two = 2.0 ** round(math.log2(s))
            other = solved(two * A, two * q)
            if one.outcome is not other.outcome or (one.solved and one.x.tobytes() != other.x.tobytes()):
                seen[f"DIFFERS: {two:g}: {kind.__name__}: {one.outcome.name} and {other.outcome.name}"] += 1
            else:
                seen["the same to the last digit, times a power of two"] += 1
            other = solved(s * A, s * q)
            if not same_outcome(one, other, exact=False):
                seen[f"DIFFERS: {s:g}: {kind.__name__}: {one.outcome.name} and {other.outcome.name}"] += 1
            elif one.outcome is not other.outcome:
                seen[f"decided by rounding: {kind.__name__}: {one.outcome.name} and {other.outcome.name}"] += 1
            elif one.solved and not same_point(one.x, other.x):
                seen[f"another point: {kind.__name__}"] += 1
            else:
                seen["the same, times a power of ten"] += 1
    return report(f"{number} problems times {len(FACTORS)} factors, seed {seed}", seen)


def hostile(k: int, r: np.random.Generator) -> Data:
    """A small problem; every third with entries 10^U(-200, 200)."""
    A, q = KINDS[k % len(KINDS)](int(r.integers(1, 6)), r)
    if k % 3 == 0:
        A, q = A * 10.0 ** r.uniform(-200, 200, A.shape), q * 10.0 ** r.uniform(-200, 200, q.shape)
    return A, q


def exactly_off(A: Array, q: Array, x: Array) -> float:
    """The relative residual of x >= 0 in rational arithmetic: see `lcp.Certificate`.

    A row is satisfied where entries of x that no float holds can make up for what it is off.
    """
    terms = [[Fraction(a) * Fraction(b) for a, b in zip(row, x.tolist())] for row in A.tolist()]
    sizes = [sum(map(abs, row), abs(Fraction(c))) for row, c in zip(terms, q.tolist())]
    w = [sum(row, Fraction(c)) / (size or 1) for row, c, size in zip(terms, q.tolist(), sizes)]
    least = np.finfo(float).smallest_normal
    held = [float(value) > FARTHEST if b == 0.0 else b >= least for b, value in zip(x.tolist(), w)]
    spacing = Fraction(math.ulp(0.0))
    made_up = [spacing * sum(abs(Fraction(a)) for a, there in zip(row, held) if not there) for row in A.tolist()]
    w = [Fraction(0) if abs(value) * size <= most else value for value, size, most in zip(w, sizes, made_up)]
    shares = [max(abs(row[j]) / (size or 1) for row, size in zip(terms, sizes)) for j in range(len(q))]
    return max(float(abs(min(share, value))) if value > 0 else float(-value) for share, value in zip(shares, w))


def proves(A: Array, q: Array, y: tuple[int, ...]) -> bool:
    """Whether y >= 0, A'y <= 0 and q'y < 0 in rational arithmetic, so that there is no feasible point."""
    columns = ([Fraction(a) for a in column] for column in A.T.tolist())
    below = all(sum(a * b for a, b in zip(column, y)) <= 0 for column in columns)
    return min(y) >= 0 and below and sum(Fraction(a) * b for a, b in zip(q.tolist(), y)) < 0


def truth(number: int, seed: int) -> int:
    """SOLVED and UNSOLVABLE against enumeration; no exception, no warning, nothing slow."""
    seen: Counter[str] = Counter()
    slowest = 0.0
    for k in range(number):
        A, q = hostile(k, np.random.default_rng([seed, k]))
        began = time.process_time()
        try:
            found = solved(A, q)
        except Exception as error:
            seen[f"DIFFERS: {type(error).__name__}"] += 1
            print(f"{type(error).__name__} at {k}: {error}")
            continue
        seconds = time.process_time() - began
        slowest = max(slowest, seconds)
        if seconds > SLOW:
            seen["DIFFERS: slow"] += 1
            print(f"{seconds:.1f} s at {k}")
        seen[found.outcome.name] += 1
        exists = lcp.solve_by_enumeration(lcp.LCP(A, q)).solvable
        if found.outcome in (Outcome.SOLVED, Outcome.UNSOLVABLE) and exists is not found.solved:
            seen["DIFFERS: false claim"] += 1
            print(f"FALSE {found.outcome.name} at {k}, off by {found.relative_residual:.1e}: {found.message}")
        if found.solved and exactly_off(A, q, found.x) > FARTHEST:
            seen["DIFFERS: x is no solution"] += 1
            print(f"OFF by {exactly_off(A, q, found.x):.1e} at {k}: {found.message}")
        if found.outcome is Outcome.UNSOLVABLE and found.farkas is not None:
            seen["Farkas vectors, exact" if proves(A, q, found.farkas.y) else "DIFFERS: no Farkas vector"] += 1
        if found.outcome not in (Outcome.SOLVED, Outcome.UNSOLVABLE):
            seen[f"undecided, solvable: {exists}: {found.outcome.name}"] += 1
    return report(f"{number} small problems against enumeration, seed {seed}, slowest {slowest:.1f} s", seen)


def report(title: str, seen: Counter[str]) -> int:
    """Print; whether anything differs."""
    print(title)
    for name, count in sorted(seen.items()):
        print(f"{count:8} {name}")
    return sum(count for name, count in seen.items() if name.startswith("DIFFERS"))


MODES = {"units": (units, 2000), "factor": (factor, 1000), "truth": (truth, 100_000)}


if __name__ == "__main__":
    run, default = MODES[sys.argv[1]]
    numbers = [int(a) for a in sys.argv[2:]]
    sys.exit(min(run(*(numbers + [default, 0][len(numbers) :])), 1))
