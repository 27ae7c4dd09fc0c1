"""What cannot be meant is refused by the name of the argument; `tests/reliability/hostile.py` has kinds of values."""

from functools import partial
from inspect import signature

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import strategies as st

import continuation
from continuation.archive import PathLog
from problems import lcp, scenes
from problems.charts import families
from problems.lcp import LCP, MixedLCP, classes, strategies
from problems.lcp.reference.enumeration import LARGEST_FACES, exhaust
from problems.literal import run_literally
from problems.nonlinear import MixedComplementarity, NormalMap, bratu_under_obstacle, brown, fixed_point, newton
from problems.orbits import PeriodicOrbit, from_model
from problems.orbits.models import lorenz, normal_form
from problems.scenes.truss import Truss

from .lcp.mixed.util import EVERY_KIND
from .lcp.parametric.util import murty

INF, NAN, ONE = np.inf, np.nan, np.eye(2)
A, Q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])
PAIR, BOX, LARGE = LCP(A, [-1.0, -1.0]), MixedLCP(ONE, [1.0, 1.0], 0, 1), LCP(np.eye(15), -np.ones(15))
TIMES, NOISE = np.arange(50.0), np.random.default_rng(0).normal(size=(50, 3))
ORBIT = {"f": normal_form, "states": np.ones((80, 2)), "period": 1.0, "parameter": 0.0}


def bounded(lower=None, upper=None):
    return MixedComplementarity(lambda x: x[:2], lower=lower, upper=upper)


def normal_map(jacobian=None, **bounds):
    return NormalMap(lambda x, lam: x - lam, jacobian, x0=[0.0], lam0=0.0, **bounds)


def crossing(**place):
    return lcp.along(murty(3), np.ones(3), (INF, -INF))(**place)


def at_the_door(*rows):
    """Of the two homotopies for F(x) = 0: what is wrong, what is said, F, a and the derivative."""
    makers = (fixed_point, newton)
    return {f"{make.__name__}, {name}": (said, partial(make, *given)) for name, said, *given in rows for make in makers}


BOUNDS = {
    "above": (r"lower: expected at most upper, found lower\[1\] = 0.0 > upper\[1\] = -2.0", 0, [1, -2]),
    "nan": ("lower: expected numbers or -inf, found nan at index 1", [0, NAN], 1),
    "infinite lower": ("lower: expected numbers or -inf, found inf at index 0", [INF, 0], INF),
    "infinite upper": ("upper: expected numbers or inf, found -inf at index 1", 0, [1, -INF]),
    "length": (r"lower: expected 2 numbers, one an unknown, found shape \(3,\)", [0, 0, 0], 1),
    "sparse": ("lower: expected a dense vector, found a sparse one", sp.csr_array([[0.0, 1.0]]), 2),
    "text": ("lower: expected real numbers", ["a", "b"], 2),
}
PROGRAMS = {
    "asymmetric": ("P: expected a symmetric matrix", {"P": [[1, 2], [0, 1]]}),
    "rows alone": ("G: expected rows and one side of them", {"G": [[1, 1]]}),
    "equations alone": ("A_eq: expected A_eq and b_eq, or neither", {"b_eq": [1]}),
    "columns": ("G: expected 2 columns", {"G": [[1, 1, 1]], "h": 1}),
    "crossed rows": (
        r"rows_lower: expected at most h, found rows_lower\[0\] = 1.0 > h\[0\] = 0.0",
        {"G": [[1, 1]], "h": [0], "rows_lower": [1]},
    ),
}
STARTS = {
    "x0": (r"x0: expected a number between -inf and 1\.0 at index 1, found 1\.0", {"x0": [1.0, 1.0, 0.0, 2.0]}),
    "z1": ("z1: expected 4 positive numbers", {"z1": [1.0, 1.0]}),
    "z2": (r"z2: expected a number between -inf and 0\.0 at index 1, found 2\.0", {"z2": [1.0, 2.0, 0.5, 0.0]}),
    "z2 of a box": (
        r"z2: expected a number between 0\.0 and 2\.0 at index 2, found 2\.0",
        {"z2": [1.0, -2.0, 2.0, 0.0]},
    ),
    "w0": ("w0: expected positive finite numbers", {"w0": [1.0, 1.0, -1.0, 1.0]}),
}
ORBITS = (
    ("states", np.ones((79, 2))), ("states", [1.0]), ("states", np.full((80, 2), NAN)), ("period", 0.0),
    ("parameter", NAN), ("mesh", 1), ("mesh", [0.0, 0.5, 0.5, 1.0]), ("degree", 1), ("scale", [1.0]),
    ("scale", [1.0, 0.0]), ("jacobian", 3), ("smallest", 0.0), ("f", None), ("f", lambda x, p: x[:1]),
)  # fmt: skip
FIRST = {name: next(iter(signature(scenes.find(name)).parameters)) for name in scenes.available()}
"""Of a scene's parameters the first."""

WRONG_VALUES = {
    **{f"bounds, {name}": (said, partial(MixedLCP, A, Q, *given)) for name, (said, *given) in BOUNDS.items()},
    **{
        f"a program, {name}": (said, partial(lcp.from_qp, **{"P": ONE, "c": [1, 1], **given}))
        for name, (said, given) in PROGRAMS.items()
    },
    **{f"kkt, {name}": (said, partial(lcp.KKTHomotopy, EVERY_KIND, **given)) for name, (said, given) in STARTS.items()},
    "a homotopy without bounds": (
        "homotopy: expected auto or one of kkt, wang, yu, kmm for a problem with", lambda: lcp.solve(BOX, "xu"),
    ),
    "a start at a bound": (
        r"x0: expected a number between 0\.0 and 1\.0 at index 1, found 1\.0", lambda: lcp.solve(BOX, x0=[0.5, 1.0]),
    ),
    "a start outside, beside a fixed unknown": (
        r"x0: expected a number between 0\.0 and 1\.0 at index 0, found 1\.5",
        lambda: lcp.solve(MixedLCP(ONE + 1.0, [-2.0, -2.0], [0.0, 3.0], [1.0, 3.0]), x0=[1.5, 3.0]),
    ),
    "a fixed unknown": (
        "problem: expected lower < upper, found a fixed unknown 1",
        lambda: lcp.WangHomotopy(MixedLCP(ONE, [1.0, 1.0], [0, 1], [1, 1])),
    ),
    **{
        f"15 unknowns, {method.__name__}": (f"problem: expected n <= {LARGEST_FACES}", partial(method, LARGE))
        for method in (lcp.solve_by_enumeration, exhaust)
    },
    "no covering vector": ("expected a covering vector d", lambda: lcp.along(PAIR, [-1.0, 1.0], (INF, 0.0))),
    "no solution": (
        "x: expected a solution for t = 1, found one that is off by",
        lambda: lcp.along(PAIR, [1.0, 1.0], (1.0, 0.0), x=[1.0, 1.0]),
    ),
    "t off the path": ("t: expected a value that the parameter takes", partial(crossing, t=1e6)),
    "neither s nor t": ("s: expected an arclength, or t", crossing),
    "a small dA": (
        "dA: expected finite numbers of shape", lambda: lcp.solve(LCP([[-1.0]], [0.0])).sensitivity().jvp(dA=[1.0]),
    ),
    "drawn, lots": ("kind: .*'lots'", lambda: strategies.planted_lcps("lots")),
    "drawn, many of P": ("cls: .*'P'", lambda: strategies.planted_lcps("many", "P")),
    "drawn, Q": ("cls: expected one of any, P, .*found 'Q'", lambda: strategies.matrices("Q")),
    "drawn, entries of P": (
        "entries: expected none for the class P", lambda: strategies.matrices("P", 3, entries=st.floats(-1.0, 1.0)),
    ),
    "drawn, a family": ("family: expected one of", lambda: families.planted("none", 2, 0)),
    "the paper's start": (
        r"x0: expected a strictly feasible point.*found -1 at 1",
        lambda: run_literally(LCP([[1, 0], [0, 1]], [0, -2]), [1, 1]),
    ),
    "the paper's a0": ("a0: expected a positive number, found 0.0", lambda: run_literally(PAIR, [1, 1], a0=0.0)),
    "Brown, x": (r"x: expected shape \(3,\), found \(2,\)", lambda: brown(3)(np.zeros(2))),
    "Brown, n": ("n: expected at least 1, found 0", lambda: brown(0)),
    "no vector of bounds": ("lower: expected a vector of bounds", bounded),
    "F between bounds, fixed": (
        "lower: expected less than upper, found both 1.0 at index 1", lambda: bounded([0, 1], [2, 1]),
    ),
    "F between bounds, crossed": (r"lower: expected at most upper, found lower\[1\]", lambda: bounded([0, 1], [2, 0])),
    "F between bounds, shape": (
        r"F\(a\): expected shape \(3,\), that of a, found \(2,\)", lambda: bounded(np.zeros(3)),
    ),
    **at_the_door(
        ("empty", r"a: expected a vector of real numbers, found shape \(0,\)", np.cos, []),
        ("shape", r"F\(a\): expected shape \(2,\), that of a, found \(1,\)", lambda x: x[:1], [0.0, 1.0]),
        ("nan", r"F\(a\): expected finite numbers, found nan", lambda x: np.log(x), [-1.0]),
        ("complex", r"F\(a\): expected real numbers.*complex128", lambda x: x + 1j, [0.0]),
        ("derivative", r"jacobian\(a\): expected shape \(4, 4\), found \(2, 2\)", np.cos, np.zeros(4), lambda x: ONE),
    ),
    "a normal map, length": ("lower: expected 1 numbers", lambda: normal_map(lower=[0.0, 1.0])),
    "a normal map, order": ("lower: expected at most upper", lambda: normal_map(lower=1.0, upper=0.0)),
    "a normal map, fixed": ("lower: expected less than upper", lambda: normal_map(lower=1.0, upper=1.0)),
    "a normal map, shape": (
        "jacobian: expected a pair", lambda: normal_map(lambda x, lam: (np.eye(3), np.ones(1))),
    ),
    "a normal map, matrix": (
        "A: expected a square matrix", lambda: NormalMap.affine(ONE, [1.0], [1.0], x0=[0.0], lam0=0.0),
    ),
    "an obstacle": ("psi: expected a positive number", lambda: bratu_under_obstacle(9, -1.0)),
    "a point without an orbit": ("point", lambda: PeriodicOrbit.from_hopf(normal_form, ([0.3, 0.1], 0.4))),
    "noise": ("x: expected a simulation", lambda: PeriodicOrbit.from_solution(lorenz, TIMES, NOISE, 28.0)),
    "no times": ("t:", lambda: PeriodicOrbit.from_solution(lorenz, 0.0 * TIMES, 0.0 * NOISE, 28.0)),
    "no orbit": ("point", lambda: PeriodicOrbit.from_point(normal_form, (np.zeros(31), 0.0), 2)),
    "no model": ("model", lambda: from_model("ross")),
}  # fmt: skip

REFUSED = {
    ValueError: WRONG_VALUES,
    TypeError: {
        **at_the_door(
            ("list", r"F\(a\): expected an array of shape \(1,\), found list", lambda x: [0.0], [0.0]),
            ("number", r"jacobian\(a\): expected a matrix", np.cos, np.zeros(4), lambda x: 1.0),
        ),
        "a log": ("archive: ", lambda: lcp.solve(PAIR, archive=PathLog("a.h5"))),
        "a membership's truth": (r"read \.holds", lambda: bool(classes.is_p(ONE))),
        **{
            f"{name}'s colour": ("colour: expected an option", partial(scenes.make, name, {"colour": 1}))
            for name in FIRST
        },
    },
    ArithmeticError: {
        "a load": (
            "load: the bars bear 2.1 at most, found 2.2",
            lambda: Truss(load=2.2).answer(scenes.solve(Truss(load=2.2))),
        ),
    },
    (TypeError, ValueError): {
        **{f"an orbit's {k}. {name}": (name, partial(PeriodicOrbit, **{**ORBIT, name: value}))
           for k, (name, value) in enumerate(ORBITS)},
        **{f"every = {every}": ("every", lambda every=every: continuation.follow(from_model(), every=every))
           for every in (0, True, 1.5)},
        "no mesh": (
            "homotopy",
            lambda: continuation.follow(continuation.from_functions(lambda y, p: y - p, start=([0.0], 0.0))),
        ),
        **{f"{name}'s {first}": (f"^{first}: expected", partial(scenes.find(name), **{first: "text"}))
           for name, first in FIRST.items()},
    },
}  # fmt: skip
CASES = {name: (error, *row) for error, rows in REFUSED.items() for name, row in rows.items()}


@pytest.mark.parametrize(("error", "message", "call"), CASES.values(), ids=CASES)
def test_it_is_refused_in_a_line_that_says_what_was_expected(tmp_path, monkeypatch, error, message, call):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
