"""`lcp.solve` must not depend on units of rows and columns, on a common factor, or on the spread of entries.

    python examples/benchmarks/claims.py [NUMBER] [SEED] [units] [factor] [truth] [bounds]

"units": each problem again in random units; "factor": LCP(s q, s A) for s = 1e-300 .. 1e300; "truth" and "bounds":
every claim against exact enumeration. Units that are not powers of two round the entries, and so can spoil an exact
proof or an exact solution, or give a problem without solution one at 1e16: such answers are counted ("decided
by rounding"), and powers of two are held to the same outcome.
"""

import math
import sys
import warnings
from collections.abc import Callable
from fractions import Fraction

import numpy as np
from campaign import WRONG, Campaign, Verdict, drawn, timed

from continuation import Budget
from continuation.arrays import Array
from problems import lcp
from problems.lcp import Outcome
from problems.lcp.reference.enumeration import exhaust

Data = tuple[Array, Array]

SAME_X = 1e-8
"""Two points closer than this, relative to each component's size in balanced units, are the same."""

FACTORS = tuple(10.0**k for k in (-300, -200, -100, -30, -12, -8, -4, 0, 4, 8, 12, 30, 100, 200, 300))

FARTHEST = 1e-10
"""The relative residual that `solve` allows where it is asked for nothing else."""


def planted(A: Array, r: np.random.Generator) -> Data:
    """A with a q that has a solution."""
    n = len(A)
    support = r.random(n) < 0.5
    x, w = r.integers(1, 17, (2, n)) / 8.0  # so that no rounding spoils what integers plant
    return A, np.where(support, 0.0, w) - A @ np.where(support, x, 0.0)


def monotone(n: int, r: np.random.Generator) -> Data:
    """Positive definite, not symmetric."""
    A, q = KINDS["definite"](n, r)
    S = r.standard_normal((n, n))
    return A + S - S.T, q


def game(n: int, r: np.random.Generator) -> Data:
    """A bimatrix game."""
    m = max(n // 2, 1)
    C, D = r.uniform(0.1, 1.0, (2, m, m))
    return np.block([[np.zeros((m, m)), C], [D.T, np.zeros((m, m))]]), -np.ones(2 * m)


def sparse(n: int, r: np.random.Generator) -> Data:
    """Small integers, most of them zero."""
    A, q = KINDS["integer"](n, r)
    return A * (r.random((n, n)) < 0.4), q


def infeasible(n: int, r: np.random.Generator) -> Data:
    """No feasible point, by a positive combination of rows."""
    A, q = r.standard_normal((n, n)), r.standard_normal(n)
    A[0] = -A[1:].sum(axis=0) - r.random(n)
    q[0] = -q[1:].sum() - 0.1
    return A, q


KINDS: dict[str, Callable[[int, np.random.Generator], Data]] = {
    "definite": lambda n, r: ((M := r.standard_normal((n, n))) @ M.T / n + 0.1 * np.eye(n), r.standard_normal(n)),
    "monotone": monotone,
    # Of half the rank.
    "semidefinite": lambda n, r: planted((M := r.integers(-2, 3, (n, max(n // 2, 1))).astype(float)) @ M.T, r),
    # No positive entry off the diagonal; often infeasible.
    "z_matrix": lambda n, r: (
        np.diag(r.uniform(0.0, n, n)) - r.random((n, n)) * (1 - np.eye(n)), r.standard_normal(n)
    ),
    "game": game,
    "nonmonotone": lambda n, r: planted(r.standard_normal((n, n)), r),
    "anything": lambda n, r: (r.standard_normal((n, n)), r.standard_normal(n)),
    # Much is degenerate.
    "integer": lambda n, r: (r.integers(-2, 3, (n, n)).astype(float), r.integers(-2, 3, n).astype(float)),
    "sparse": sparse,
    "infeasible": infeasible,
}  # fmt: skip

QUICK = ("definite", "monotone", "z_matrix", "game")
"""Kinds that are solved before any path, at any order."""

LARGE = (13, 25)
"""Orders from which on active sets are tried before a problem is put into units of its own."""


def turn(k: int) -> tuple[str, int]:
    """The kind of the k-th problem, and how often it had its turn before."""
    return [*KINDS][k % len(KINDS)], k // len(KINDS)


def solved(A: Array, q: Array) -> lcp.Solution:
    """The answer, with every warning an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return lcp.solve(lcp.LCP(A, q), budget=Budget(seconds=60.0))


def without_solution(found: lcp.Solution) -> bool:
    """Whether it is said that there is no solution, or none that floats can hold."""
    unrepresented = found.outcome is Outcome.NOT_FOUND and found.exhaustion is not None
    return unrepresented or found.outcome in (Outcome.UNSOLVABLE, Outcome.INFEASIBLE_TO_PRECISION)


def by_rounding(one: lcp.Solution, other: lcp.Solution, E: Array) -> bool:
    """Whether only the rounding of its data can tell the other from the one, whose x has units 1 / E there."""
    if without_solution(other) and one.solved:
        return lcp.certify(other.problem, one.x / E).relative_residual <= 4.0 * np.finfo(float).eps
    return (one.solved and other.solved) or (without_solution(one) and without_solution(other))


def compared(one: lcp.Solution, other: lcp.Solution, exact: bool, E: Array) -> str:
    """The difference of two answers, of which the other is for x in units of 1 / E."""
    said = f"{one.outcome.name} and {other.outcome.name}"
    if one.outcome is not other.outcome:
        return f"decided by rounding: {said}" if not exact and by_rounding(one, other, E) else f"{WRONG}: {said}"
    same = not one.solved or np.abs(one.x - other.x * E).max() <= SAME_X * max(float(np.abs(one.x).max()), 1e-300)
    return "" if same else "another solution"


def units(k: int, r: np.random.Generator) -> Verdict:
    """A problem, and the same in units for every row and column, powers of two in every second one."""
    kind, before = turn(k)
    A, q = KINDS[kind](int(r.integers(2, 13)), r)
    D, E = 10.0 ** r.uniform(-8, 8, (2, len(q)))
    if exact := bool(before % 2):
        D, E = np.exp2(np.round(np.log2(D))), np.exp2(np.round(np.log2(E)))
    return compared(solved(A, q), solved(D[:, None] * A * E, D * q), exact, E), math.nan


def factor(k: int, r: np.random.Generator) -> Verdict:
    """A small problem, or every fifth of some kinds one that is not, has the same solutions times any s.

    The power of two next to s rounds nothing, and is to change no digit of the answer. s itself rounds the entries, and
    so may make a singular problem one that is not.
    """
    kind, before = turn(k)
    A, q = KINDS[kind](int(r.integers(*(LARGE if kind in QUICK and before % 5 == 4 else (1, 6)))), r)
    one, said = solved(A, q), {""}
    for s in FACTORS:
        two = 2.0 ** round(math.log2(s))
        other = solved(two * A, two * q)
        if one.outcome is not other.outcome or (one.solved and one.x.tobytes() != other.x.tobytes()):
            return f"{WRONG}: times {two:g} {one.outcome.name} and {other.outcome.name}", math.nan
        said.add(compared(one, solved(s * A, s * q), False, np.ones(len(q))))
    return max(said, key=lambda text: (text.startswith(WRONG), text)), math.nan


def hostile(k: int, r: np.random.Generator) -> Data:
    """A small problem; every third with entries 10^U(-200, 200)."""
    A, q = KINDS[turn(k)[0]](int(r.integers(1, 6)), r)
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


def truth(k: int, r: np.random.Generator) -> Verdict:
    """SOLVED and UNSOLVABLE of small problems against enumeration; no exception, no warning, nothing over 20 s."""
    A, q = hostile(k, r)
    try:
        found, seconds = timed(lambda: solved(A, q))
    except Exception as error:
        return f"{WRONG}: {type(error).__name__}: {error}", math.nan
    exists = lcp.solve_by_enumeration(lcp.LCP(A, q)).solvable
    said = found.outcome.name
    if found.outcome not in (Outcome.SOLVED, Outcome.UNSOLVABLE):
        said += f", {'solvable' if exists else 'not solvable'}"
    elif exists is not found.solved:
        said = f"{WRONG}: {said} is false"
    if found.solved and exactly_off(A, q, found.x) > FARTHEST:
        said = f"{WRONG}: {said}, x is no solution"
    if found.outcome is Outcome.UNSOLVABLE and found.farkas is not None and not proves(A, q, found.farkas.y):
        said = f"{WRONG}: {said}, no Farkas vector"
    return said if seconds <= 20.0 else f"{WRONG}: slow", seconds


def random_problem(rng: np.random.Generator) -> lcp.MixedLCP:
    """Integers, n <= 6, bounds of all kinds mixed; singular and infeasible problems among them."""
    n = int(rng.integers(1, 7))
    A, q = rng.integers(-3, 4, (n, n)).astype(float), rng.integers(-4, 5, n).astype(float)
    change = rng.random(4) < 0.3
    if change[0]:
        A[rng.integers(n)] = A[rng.integers(n)]
    if change[1]:
        A[:, rng.integers(n)] = 0.0
    if change[2]:
        A = A + A.T
    if change[3]:
        A = A @ A.T
    kind = rng.integers(0, 6, n)  # lower, box, upper, free, lower, fixed
    lower = np.where(np.isin(kind, [0, 1, 4, 5]), rng.integers(-2, 3, n), -np.inf)
    width = np.where(kind == 5, 0, rng.integers(0, 4, n))
    upper = np.where(np.isin(kind, [1, 5]), lower + width, np.where(kind == 2, rng.integers(-2, 3, n), np.inf))
    return lcp.MixedLCP(A, q, lower, upper)


def bounds(k: int, r: np.random.Generator) -> Verdict:
    """The outcome of a problem with bounds against all pieces in exact arithmetic: each is decided, to round-off."""
    problem = random_problem(r)
    (found, seconds), solvable = timed(lambda: lcp.solve(problem)), exhaust(problem).solvable
    right = found.outcome is (Outcome.SOLVED if solvable else Outcome.UNSOLVABLE)
    if solvable:
        right &= problem.natural_residual(found.x) <= 1e-12 * problem.scale(found.x)
    return found.outcome.name if right else f"{WRONG}: {found.outcome.name} of {problem!r}", seconds


FAMILIES = {family.__name__: drawn(family) for family in (units, factor, truth, bounds)}
CAMPAIGN = Campaign(FAMILIES, lambda verdict, way: verdict, {"": None}, "seconds")

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(1000))
