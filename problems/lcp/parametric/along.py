"""`along`: the piecewise linear path of LCP(q + t d, A)."""

from __future__ import annotations

import math
import time
from os import PathLike
from typing import Any

import numpy as np
from attrs import evolve

from continuation.archive.atomic import new_file
from continuation.archive.growing import save_all
from continuation.arguments.checks import expect
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.path import Path
from continuation.status import Status
from problems.lcp.data.problem import MixedLCP, require_problem
from problems.lcp.data.scaling import Exponents, balanced
from problems.lcp.data.spread import alike
from problems.lcp.parametric.basis import SingularBasisError
from problems.lcp.parametric.start import from_ray, from_solution
from problems.lcp.parametric.trail import Trail
from problems.lcp.parametric.walk import OUTSIDE_LIMITS
from problems.lcp.search.solver import solve
from problems.options import check_budget, expect_nowhere, finite_vector, real_array

CORNERS = 100_000
"""Default budget; Murty's example of order 16 has 65,535 kinks."""


def along(
    problem: MixedLCP,
    d: Any,
    t: tuple[float, float] = (1.0, 0.0),
    *,
    x: Any = None,
    ray: Any = None,
    level: Any = 0.0,
    budget: Budget | None = None,
    archive: str | PathLike[str] | None = None,
) -> Path:
    """Follow the solutions of a problem as q + t d moves with t.

    t may turn back, or stand still while x moves. If up to ten switches vanish at once, all rays are found.

    Parameters
    ----------
    problem : LCP or MixedLCP
        Sparse matrices become dense.
    d : array_like, shape (n,)
    t : (float, float)
        Start and end. From t = inf the path comes along a ray, if the point nearest to zero solves the problem for
        large t, as with d > 0 (Lemke's method). Towards inf or -inf it continues until a ray leads away.
    x : array_like, shape (n,), optional
        A solution for t[0]; default that of `solve`.
    ray : array_like, shape (n + 1,), optional
        Selects the nearest ray at the start, a direction of (x, t); by default t goes towards its end.
    level : array_like, shape (n,), or one number
        If positive, unknowns without bounds pay t level_i |x_i|, t >= 0, as in penalised regression: w_i = -t level_i
        for x_i > 0, t level_i for x_i < 0.
    budget : continuation.Budget, optional
        Default 100,000 kinks.
    archive : path, optional
        New HDF5 file.

    Returns
    -------
    continuation.Path
        Its points are kinks and ends, its parameter t. ``path.kinks`` lists kinks with pairs that switch and rays;
        ``path(t=0.5)`` is the first point with that t, ``path.crossings(t=0)`` gives all.

    Raises
    ------
    TypeError, ValueError
        For bad input, or if x is no solution, or no ray comes from t = inf.

    References
    ----------
    Cottle, Pang and Stone, section 4.5; for levels Osborne, Presnell and
    Turlach, IMA J. Numer. Anal. 20, 2000.
    """
    began = time.perf_counter()
    problem, slope, levels = checked(problem, d, level)
    check_budget(budget)
    first, last = _interval(t)
    file = None if archive is None else new_file("archive", archive)
    n = problem.n
    sign = 1.0 if last > first else -1.0
    towards = None if ray is None else finite_vector("ray", ray, n + 1)
    status, message, walk = Status.TRACING, "", None
    point = np.zeros(n)
    with np.errstate(all="ignore"):
        work, rows, columns = _scaled(problem, slope, levels)
        own = np.ldexp(slope, rows), np.ldexp(levels, rows)
        try:
            if math.isinf(first):
                walk = from_ray(work, *own, sign)
                walk.value = walk.value if (last - walk.value) * sign > 0.0 or math.isinf(last) else last - sign
            else:
                point = _solution(problem, slope, levels, first, x)
                towards = None if towards is None else np.append(np.ldexp(towards[:-1], -columns), towards[-1])
                walk = from_solution(work, *own, np.ldexp(point, -columns), first, sign, towards)
            if walk is None:
                status, message = Status.DEAD_END, "No ray leaves the start on which t goes towards its end."
        except SingularBasisError:
            status, message = Status.SINGULAR_START, str(Status.SINGULAR_START)
        trail = Trail(np.append(np.ldexp(1.0, columns), 1.0))
        if walk is None:
            trail.points, trail.ways = [np.append(point, first)], [np.zeros(n + 1)]
        else:
            status, message = trail.follow(walk, last, budget or Budget(steps=CORNERS))
        off = natural_residuals(problem, slope, levels, np.array(trail.points))
        steps, events = trail.steps(np.abs(off).max(axis=1, initial=0.0))
    counts = Counts(accepted=len(steps))
    path = Path(steps, events, status, message, counts, time.perf_counter() - began, references=_CITED)
    if file is not None:
        save_all([path], file, "A path of LCP(q + t d, A)")
    return path


def natural_residuals(problem: MixedLCP, d: Array, level: Array, u: Array) -> Array:
    """The natural map at points u, shape (m, n + 1) to (m, n); zero on the path.

    x - mid(lower, x - w, upper), w = Ax + q + t d; for a level, w + mid(-t level, x - w, t level).
    """
    x, t = u[:, :-1], u[:, -1:]
    w = x @ problem.A.T + (problem.q + t * d)
    width = t * level
    kept = np.minimum(np.maximum(x - w, -width), width)
    return np.where(level > 0.0, w + kept, problem.natural_map(x, w))


def _scaled(problem: MixedLCP, d: Array, levels: Array) -> tuple[MixedLCP, Exponents, Exponents]:
    scaled = None if alike(problem) else balanced(evolve(problem, q=np.abs(problem.q) + np.abs(d) + levels))
    if scaled is None or not scaled.exact:
        none = np.zeros(problem.n, dtype=np.int64)
        return problem, none, none
    return evolve(scaled.problem, q=np.ldexp(problem.q, scaled.rows)), scaled.rows, scaled.columns


_CITED = (
    "@book{cottle1992, author = {Cottle, Richard W. and Pang, Jong-Shi and Stone, Richard E.}, title = {The Linear "
    "Complementarity Problem}, publisher = {Academic Press}, year = {1992}}",
)


def checked(problem: MixedLCP, d: Any, level: Any) -> tuple[MixedLCP, Array, Array]:
    """The problem with a dense matrix, d, and the levels, zero at bounds; `ValueError` for others."""
    require_problem(problem)
    slope = finite_vector("d", d, problem.n)
    free = np.isneginf(problem.lower) & np.isposinf(problem.upper)
    if np.ndim(level) == 0:
        level = np.where(free | ~free.any(), real_array("level", level), 0.0)
    found = finite_vector("level", level, problem.n)
    wrong = (found < 0.0) | ((found > 0.0) & ~free)
    expected = "0 where there are bounds, and nowhere negative"
    expect_nowhere(wrong, "level", expected, lambda i: f"{found[i]} at index {i}")
    dense = evolve(problem, A=problem.A.toarray()) if problem.sparse else problem
    return dense, slope, found


def _interval(t: Any) -> tuple[float, float]:
    try:
        first, last = (float(value) for value in t)
    except (TypeError, ValueError):
        raise ValueError(f"t: expected two numbers, where the path begins and where it ends, found {t!r}") from None
    expect(first < last or last < first, "t", "two different numbers", t)
    return first, last


def _solution(problem: MixedLCP, d: Array, levels: Array, t: float, x: Any) -> Array:
    at = evolve(problem, q=problem.q + t * d)
    if x is None:
        if levels.any():
            raise ValueError("x: expected a solution for t[0], which is looked for only where there is no level")
        found = solve(at)
        if not found.solved or found.x is None:
            raise ValueError(f"t: expected a start t[0] with a solution, found none for {t:g}. {found.message}")
        return found.x
    given = finite_vector("x", x, problem.n)
    off = np.abs(natural_residuals(problem, d, levels, np.append(given, t)[None])[0])
    wrong = off > OUTSIDE_LIMITS * at.scale(given)
    expect_nowhere(wrong, "x", f"a solution for t = {t:g}", lambda i: f"one that is off by {off[i]:.1e} at index {i}")
    return given
