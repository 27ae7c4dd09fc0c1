"""Starts of paths."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arguments.checks import instance_with
from continuation.arrays import Array
from problems.lcp.data.problem import LCP, MixedLCP, require_lcp, require_problem
from problems.lcp.data.spread import largest_entries
from problems.lcp.homotopies.rows import Rows
from problems.lcp.homotopies.sides import Sides
from problems.lcp.proof.phase1 import strictly_feasible_start
from problems.options import finite_vector

START_DISTANCES = (1.0, 2.5)
"""Decimal exponents of random starts' distances, in natural units or `typical_units`. Of 70 paths of hard problems (n =
100) 17 solve from 1 to 1.5 or further, 11 from 0.5 to 1."""

LOG_DEVIATION = 0.5
"""Standard deviation of the logarithms; with 0 or 1 half as many paths solve."""

BALANCE = (0.05, 0.1)
"""Mean and standard deviation of log10 of w z2 over x z1: with ratios of 4 or 1/4 hardly any path solves."""


@frozen(eq=False)
class Start:
    """A start of the KKT homotopy; for an LCP arrays are positive, of shape (n,).

    Attributes
    ----------
    x0, w0 : Array
        The point, and the values taken for A x0 + q (one per bound).
    z1, z2 : Array
        The multipliers of x >= 0 (one per bound) and Ax + q >= 0.
    """

    x0: Array
    z1: Array
    z2: Array
    w0: Array


def positive_vector(name: str, value: Any, n: int) -> Array:
    """`value` as n positive finite floats, or `ValueError`."""
    array = finite_vector(name, value) if n else np.zeros(0)
    if array.size != n:
        raise ValueError(f"{name}: expected {n} positive numbers, found shape {array.shape}")
    bad = array <= 0.0
    if bad.any():
        i = int(np.argmax(bad))
        raise ValueError(f"{name}: expected positive finite numbers, found {array[i]} at index {i}")
    return array


def inside_vector(name: str, value: Any, problem: MixedLCP, bounds: tuple[Array, Array] | None = None) -> Array:
    """`value` as n finite floats strictly between `bounds`, or `ValueError`."""
    if problem.standard:
        return positive_vector(name, value, problem.n)
    array = finite_vector(name, value, problem.n)
    lower, upper = (problem.lower, problem.upper) if bounds is None else bounds
    bad = ~((array > lower) & (array < upper))
    if bad.any():
        i = int(np.argmax(bad))
        between = f"between {lower[i]} and {upper[i]}"
        raise ValueError(f"{name}: expected a number {between} at index {i}, found {array[i]}")
    return array


def inside_start(problem: MixedLCP, distance: float = 1.0) -> Array:
    """The point nearest to zero at a distance from all bounds, or midway between close ones."""
    if problem.standard:
        return np.full(problem.n, distance)
    # Halves avoid overflow.
    half = np.minimum(0.5 * problem.upper - 0.5 * problem.lower, distance)
    return np.minimum(np.maximum(0.0, problem.lower + half), problem.upper - half)


def natural_units(problem: MixedLCP) -> tuple[float, float]:
    """Sizes of x and w: |q|_inf over A's largest row norm, and |q|_inf; zeros count as one."""
    return _units(problem, np.max)


def typical_units(problem: MixedLCP) -> tuple[float, float]:
    """`natural_units` with the root-mean-square row norm: KKT paths solve 18 of 40 piles of bodies, else 17."""
    return _units(problem, np.mean)


def _units(problem: MixedLCP, of_rows: Callable[[Array], Any]) -> tuple[float, float]:
    # Squares may overflow.
    unit = 2.0 ** (math.frexp(largest_entries(problem)[1])[1] - 1)
    A = problem.A / unit
    row = math.sqrt(of_rows((A * A).sum(axis=1))) * unit
    w = float(np.abs(problem.q).max()) or row or 1.0
    return w / row if 0.0 < row < np.inf else w, w


def centred(problem: MixedLCP, x0: Array, w0: Array) -> Start:
    """The start with equal products x0 z1 and w0 z2; with bounds x0 stands for the distances."""
    gaps = Sides(problem).gaps(x0)
    product = _product(gaps, w0)
    return Start(x0, product / gaps, _row_multipliers(problem, x0, product, w0), w0)


def _product(gaps: Array, w0: Array) -> float:
    return float(np.exp(np.log(gaps).mean() + np.log(w0).mean())) if w0.size else 1.0


def _row_multipliers(problem: MixedLCP, x0: Array, product: float, w0: Array) -> Array:
    if problem.standard:
        return product / w0
    sides, z = Sides(problem), x0.copy()
    s, t = np.zeros(problem.n), np.zeros(problem.n)
    s[sides.low], t[sides.high] = w0[: sides.low.size], w0[sides.low.size :]
    alone, above, both = (s > 0.0) & (t == 0.0), (s == 0.0) & (t > 0.0), (s > 0.0) & (t > 0.0)
    z[alone], z[above] = product / s[alone], -product / t[above]
    z[both] = (0.5 * problem.upper[both] - 0.5 * problem.lower[both]) * (t[both] / (0.5 * s[both] + 0.5 * t[both]))
    return z


def default_start(problem: MixedLCP) -> Start:
    """The centred start, of equal products x_i w_i, at x of a typical size; feasible if possible.

    Parameters
    ----------
    problem : MixedLCP
    """
    require_problem(problem)
    return relaxed_start(problem, inside_start(problem, typical_units(problem)[0]))


def relaxed_start(problem: MixedLCP, x0: Array) -> Start:
    """The centred start at x0, feasible if possible; in boxes z2 = x0 - l."""
    sides = Sides(problem)
    w0, gaps = sides.pull(problem.w(x0)), sides.gaps(x0)
    if not (w0 > 0.0).all():
        w0 = np.maximum(w0, 0.0) + natural_units(problem)[1]
    boxed = (np.isfinite(problem.lower) & np.isfinite(problem.upper))[sides.index]
    return centred(problem, x0, np.where(boxed, _product(gaps, w0) / gaps, w0))


def random_start(problem: MixedLCP, generator: np.random.Generator) -> Start:
    """A start of random scale, balance and components, with equal products x0 z1, and w0 z2.

    The scale is a power of ten in natural units, without bounds in twice typical units: 36 of 100 paths of Gaussian
    problems (n = 100) then solve, 28 in natural units.

    Parameters
    ----------
    problem : MixedLCP
    generator : numpy.random.Generator
        Its state makes restarts repeatable.
    """
    require_problem(problem)
    instance_with("generator", generator, ("uniform", "normal", "standard_normal"), "a numpy.random.Generator")
    scale = 10.0 ** generator.uniform(*START_DISTANCES)
    if not problem.standard:
        x, w = natural_units(problem)
        return _random_inside(problem, generator, scale * x, scale * w)
    x, w = typical_units(problem)
    x *= 2.0
    balance = 10.0 ** generator.normal(*BALANCE)
    x0 = scale * x * np.exp(LOG_DEVIATION * generator.standard_normal(problem.n))
    w0 = np.maximum(problem.w(x0), 0.0) + scale * w * np.exp(LOG_DEVIATION * generator.standard_normal(problem.n))
    product = scale * scale * x * w
    return Start(x0, product / x0, balance * product / w0, w0)


def _random_inside(problem: MixedLCP, generator: np.random.Generator, x: float, w: float) -> Start:
    normal = generator.standard_normal((2, problem.n))
    x0 = inside_start(problem, x) + np.where(np.isinf(problem.lower) & np.isinf(problem.upper), x * normal[0], 0.0)
    rows, forces = problem.w(x0), []
    for sign, finite in ((1.0, problem.lower > -np.inf), (-1.0, problem.upper < np.inf)):
        spread = w * np.exp(LOG_DEVIATION * generator.standard_normal(problem.n))
        forces.append((np.maximum(sign * rows, 0.0) + spread)[finite])
    return centred(problem, x0, np.concatenate(forces))


def kkt_start(problem: MixedLCP, x0: Any, z1: Any, z2: Any, w0: Any) -> Start:
    """The given vectors, checked, with defaults."""
    rows = Rows(problem)
    bounds = rows.sides.index.size
    given = {
        name: positive_vector(name, value, bounds) for name, value in (("z1", z1), ("w0", w0)) if value is not None
    }
    if x0 is not None:
        given["x0"] = inside_vector("x0", x0, problem)
    if z2 is not None:
        given["z2"] = inside_vector("z2", z2, problem, rows.bounds)
    fallback = relaxed_start(problem, given["x0"]) if "x0" in given else default_start(problem)
    if "x0" in given and problem.standard and (problem.w(given["x0"]) > 0.0).all():
        ones = np.ones(problem.n)
        fallback = Start(given["x0"], ones, ones, problem.w(given["x0"]))
    if "w0" in given:
        fallback = centred(problem, fallback.x0, given["w0"])
    return evolve(fallback, **given)


def require_interior(problem: MixedLCP) -> None:
    """Raise unless `problem` is an LCP whose bounds, if any, differ."""
    require_problem(problem)
    if problem.fixed.any():
        i = int(np.argmax(problem.fixed))
        raise ValueError(f"problem: expected lower < upper, found a fixed unknown {i}; lcp.solve eliminates it")


def feasible_start(problem: LCP, x0: Any, y0: Any) -> tuple[Any, Any]:
    """A start (x0, y0) > 0, y0 by default A x0 + q; ValueError if impossible."""
    require_lcp(problem)
    x0 = strictly_feasible_start(problem) if x0 is None else positive_vector("x0", x0, problem.n)
    if y0 is None:
        y0 = problem.w(x0)
        if not (y0 > 0.0).all():
            i = int(np.argmin(y0))
            raise ValueError(f"x0: expected A x0 + q > 0 (or give y0 > 0), found (A x0 + q)[{i}] = {y0[i]}")
    return x0, y0


def given_inside(problem: MixedLCP, x0: Any) -> Array:
    """x0, checked to lie between the bounds, or a default."""
    require_interior(problem)
    return inside_start(problem) if x0 is None else inside_vector("x0", x0, problem)
