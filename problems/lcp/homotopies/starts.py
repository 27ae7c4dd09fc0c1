"""Where the paths begin: checks of given vectors, and default and random starts in the problem's own units.

The KKT homotopy starts from any x0, z1, z2, w0 > 0: with w = A x + q + lambda (w0 - A x0 - q) it need not be feasible.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.checks import instance_with
from problems.lcp.data.problem import LCP, MixedLCP, require_lcp, require_problem
from problems.lcp.proof.phase1 import strictly_feasible_start
from problems.options import finite_vector

FAR = (0.7, 2.5)
"""Ten to a power from this interval is the distance of a random start in natural units.

Measured on random nonmonotone problems (docs/lcp_benchmark.md): paths from so far out solve several times as often as
those from near starts, unless A >= 0.
"""

LOG_DEVIATION = 0.5
"""Standard deviation of the natural logarithms of the components; with 0 or 1 half as many paths solve (measured)."""

BALANCE = (0.05, 0.1)
"""Mean and standard deviation of the decimal logarithm of the products w z2 over the products x z1.

At a point where all x_i w_i are equal, z1 = w and z2 = x satisfy the optimality conditions where the two products are
equal: then a central point of the LCP is one of the path. At a ratio of 4 or 1/4 next to no path solves (measured).
"""


@frozen(eq=False)
class Start:
    """A start of the KKT homotopy; each array has shape (n,) and is positive.

    Attributes
    ----------
    x0, w0 : Array
        The point, and what A x + q is taken for there.
    z1, z2 : Array
        The multipliers of x >= 0 and of A x + q >= 0.
    """

    x0: Array
    z1: Array
    z2: Array
    w0: Array


def positive_vector(name: str, value: Any, n: int) -> Array:
    """A copy of `value` as n positive finite floats.

    Parameters
    ----------
    name : str
        What the message calls it.
    value : array_like
    n : int

    Raises
    ------
    ValueError
        Naming the argument, what it held and what was expected.
    """
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{name}: expected {n} positive numbers, found a masked array with masked entries")
    try:
        array = np.array(value)
    except ValueError as error:
        raise ValueError(f"{name}: expected {n} positive numbers ({error})") from None
    if array.dtype.kind not in "fiu" or array.shape != (n,):
        raise ValueError(f"{name}: expected {n} positive numbers, found shape {array.shape} of dtype {array.dtype}")
    array = array.astype(float)
    bad = ~(np.isfinite(array) & (array > 0.0))
    if bad.any():
        i = int(np.argmax(bad))
        raise ValueError(f"{name}: expected positive finite numbers, found {array[i]} at index {i}")
    return array


def inside_vector(name: str, value: Any, problem: MixedLCP) -> Array:
    """A copy of `value` as n finite floats strictly between the bounds; for an LCP positive ones.

    Parameters
    ----------
    name : str
        What the message calls it.
    value : array_like
    problem : MixedLCP

    Raises
    ------
    ValueError
        Naming the argument, what it held and what was expected.
    """
    if problem.standard:
        return positive_vector(name, value, problem.n)
    array = finite_vector(name, value, problem.n)
    bad = ~((array > problem.lower) & (array < problem.upper))
    if bad.any():
        i = int(np.argmax(bad))
        between = f"between {problem.lower[i]} and {problem.upper[i]}"
        raise ValueError(f"{name}: expected a number {between} at index {i}, found {array[i]}")
    return array


def inside_start(problem: MixedLCP, distance: float = 1.0) -> Array:
    """The point nearest to zero at a distance from all bounds, or in the middle between two that are nearer.

    Parameters
    ----------
    problem : MixedLCP
    distance : float
    """
    if problem.standard:
        return np.full(problem.n, distance)
    # Halves, as the difference of two bounds may overflow.
    half = np.minimum(0.5 * problem.upper - 0.5 * problem.lower, distance)
    return np.minimum(np.maximum(0.0, problem.lower + half), problem.upper - half)


def natural_units(problem: MixedLCP) -> tuple[float, float]:
    """Sizes (of x, of w) at which A x and q balance: |q|_inf over the largest row norm of A, and |q|_inf.

    One where A or q is zero.
    """
    squares = problem.A.multiply(problem.A) if problem.sparse else problem.A * problem.A
    row = float(np.sqrt(np.max(squares.sum(axis=1))))
    w = float(np.abs(problem.q).max()) or row or 1.0
    return w / row if 0.0 < row < np.inf else w, w


def relaxed_w(problem: MixedLCP, x0: Array, margin: float | Array) -> Array:
    """A x0 + q where all of it is positive, else max(A x0 + q, 0) + margin, componentwise."""
    w = problem.w(x0)
    return w if (w > 0.0).all() else np.maximum(w, 0.0) + margin


def centred(x0: Array, w0: Array) -> Start:
    """The start whose products x0 z1 and w0 z2 all equal the geometric mean of the x0_i w0_j.

    Parameters
    ----------
    x0, w0 : Array of shape (n,)
        Positive.
    """
    product = float(np.exp(np.log(x0).mean() + np.log(w0).mean()))
    return Start(x0, product / x0, product / w0, w0)


def default_start(problem: MixedLCP) -> Start:
    """All components of x alike, in natural units; feasible where that is, else relaxed; centred.

    Parameters
    ----------
    problem : MixedLCP
    """
    require_problem(problem)
    x, w = natural_units(problem)
    x0 = np.full(problem.n, x)
    return centred(x0, relaxed_w(problem, x0, w))


def random_start(problem: MixedLCP, generator: np.random.Generator, distance: tuple[float, float] = FAR) -> Start:
    """A relaxed start for another try: scale, balance and components random; all products x0 z1 equal, and all w0 z2.

    Parameters
    ----------
    problem : MixedLCP
    generator : numpy.random.Generator
        Its state decides, so that restarts can be repeated.
    distance : tuple of float
        The scale is ten to a power from this interval, in natural units.
    """
    require_problem(problem)
    instance_with("generator", generator, ("uniform", "normal", "standard_normal"), "a numpy.random.Generator")
    ends = finite_vector("distance", distance, 2)
    if not ends[0] < ends[1]:
        raise ValueError(f"distance: expected (least, most), found {distance}")
    x, w = natural_units(problem)
    scale = 10.0 ** generator.uniform(*distance)
    if not problem.standard:
        return _random_inside(problem, generator, scale * x, scale * w)
    balance = 10.0 ** generator.normal(*BALANCE)
    x0 = scale * x * np.exp(LOG_DEVIATION * generator.standard_normal(problem.n))
    w0 = np.maximum(problem.w(x0), 0.0) + scale * w * np.exp(LOG_DEVIATION * generator.standard_normal(problem.n))
    product = scale * scale * x * w
    return Start(x0, product / x0, balance * product / w0, w0)


def _random_inside(problem: MixedLCP, generator: np.random.Generator, x: float, w: float) -> Start:
    """The same for bounds: x0 about as far from the bounds as x, and one w0 for each of them, for forces."""
    normal = generator.standard_normal((2, problem.n))
    x0 = inside_start(problem, x) + np.where(np.isinf(problem.lower) & np.isinf(problem.upper), x * normal[0], 0.0)
    rows, forces = problem.w(x0), []
    for sign, finite in ((1.0, problem.lower > -np.inf), (-1.0, problem.upper < np.inf)):
        spread = w * np.exp(LOG_DEVIATION * generator.standard_normal(problem.n))
        forces.append((np.maximum(sign * rows, 0.0) + spread)[finite])
    w0 = np.concatenate(forces)
    return Start(x0, w0, w0, w0)


def require_order(problem: LCP) -> int:
    """The order of an LCP; TypeError for anything else."""
    require_lcp(problem)
    return problem.n


def feasible_start(problem: LCP, x0: Any, y0: Any) -> tuple[Any, Any]:
    """A start (x0, y0) > 0 with y0 = A x0 + q unless y0 is given; ValueError where that is not positive."""
    n = require_order(problem)
    x0 = strictly_feasible_start(problem) if x0 is None else positive_vector("x0", x0, n)
    if y0 is None:
        y0 = problem.w(x0)
        if not (y0 > 0.0).all():
            i = int(np.argmin(y0))
            raise ValueError(f"x0: expected A x0 + q > 0 (or give y0 > 0), found (A x0 + q)[{i}] = {y0[i]}")
        made_of_x0(y0)
    return x0, y0


def made_of_x0(y0: Array) -> Array:
    """The other vector of a start, which was computed from x0; ValueError where floats do not hold it."""
    if not np.isfinite(y0).all():
        raise ValueError(f"x0: expected numbers from which a finite y0 comes (or give y0 > 0), found {y0.max()} in it")
    return y0


def given_inside(problem: MixedLCP, x0: Any) -> Array:
    """x0 between the bounds, checked; by default at a distance of one from them."""
    require_problem(problem)
    if problem.fixed.any():
        i = int(np.argmax(problem.fixed))
        raise ValueError(f"problem: expected lower < upper, found a fixed unknown {i}; lcp.solve eliminates it")
    return inside_start(problem) if x0 is None else inside_vector("x0", x0, problem)
