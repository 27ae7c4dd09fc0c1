"""The same path in any units, wherever zero is: steps, events, ends and what is said of them."""

import numpy as np
import pytest
from attrs import evolve

from continuation import (
    CONSERVATIVE,
    DEFAULT,
    FAST,
    SERIES,
    Budget,
    Status,
    TargetValue,
    Tracer,
    TurningPoint,
    from_functions,
    trace,
)
from problems.bifurcation import Bratu1D, Circle, ExponentialCosine

from ..util import benchmark, by_preset, path_of

bends, run = benchmark("bends.py"), benchmark("units.py")

every_preset = by_preset(FAST, DEFAULT, CONSERVATIVE, SERIES)


# -- units and shifts ---------------------------------------------------------------------------------------------


SMOOTH = ("cusp", "Freudenstein-Roth", "Bratu 1D", "aircraft", "Brown", "exponential-cosine 3")
CHANGES = [
    # Small numbers of factorisations differ by one or two: shifts by 1e6 leave ten digits, so that one more is needed.
    *((preset, name, 2, 11, 3.0) for preset in (FAST, DEFAULT, CONSERVATIVE, SERIES) for name in SMOOTH),
    # On the symmetric branch on a square two ranks are lost in one point. It took 2.6 times the factorisations while
    # its place depended on where zero is, and while Newton's method for a simple branch point went on, or came to a
    # halt unseen, by its round-off.
    *((preset, "Bratu 2D", *drawn, 0.0) for preset in (FAST, DEFAULT) for drawn in ((3, 0), (9, 9))),
]


@pytest.mark.parametrize(("preset", "name", "number", "seed", "more"), CHANGES)
def test_random_units_change_nothing(preset, name, number, seed, more):
    """D, E and a of 1e-8 .. 1e8, zero up to 1e6 of the path's extent away; `units.py` does this 200 times each."""
    work = run.reference(name, preset).counts.factorizations
    for case in run.cases(name)(number, seed):
        difference, ratio = run.judge(case, preset)
        assert difference == ""
        assert ratio * work <= 1.3 * work + more


@pytest.mark.parametrize("at", [1.7e5, 2.6e6])
def test_a_correction_below_the_last_digit_says_nothing_of_scales(at):
    """At its turning point a circle's first correction was lost in y's rounding: a first step of 4e-7 of its radius."""
    circle, D, a = run.PROBLEMS["circle"], 2.4e5, 2.1e4
    units = run.Rescaled(Circle(), np.array([D]), np.array([D * at]), np.ones(1), a, 1e-3 * a)
    path, plain = circle.trace(units, SERIES), circle.trace(run.Rescaled(Circle()), SERIES)
    assert len(path.steps) == len(plain.steps)


def first_weights(homotopy):
    """The metric at the start."""
    tracer = Tracer(homotopy)
    next(iter(tracer))
    return tracer.state.weights


@pytest.mark.parametrize("offset", [1.0, 1e3])
@pytest.mark.parametrize("name", ["cusp", "Bratu 1D", "exponential-cosine 5"])
def test_the_first_scales_do_not_depend_on_where_zero_is(name, offset):
    """They solve an equation, to 1e-4; by a search that ended nearby they differed by up to a hundredth."""
    here = run.Rescaled(run.PROBLEMS[name].make())
    there = evolve(here, c=offset)
    np.testing.assert_allclose(first_weights(there), first_weights(here), rtol=1e-4)


@pytest.mark.parametrize("n", [2, 5, 10])
def test_the_first_scales_are_found_in_a_few_looks(n):
    """Two residuals a look; on n = 10, where the nonlinearity grows like a square, 40 looks were not enough.

    Noise is measured by two residuals for the last places of the point, and by six at each of three distances at most.
    """
    tracer = Tracer(ExponentialCosine(n))
    next(iter(tracer))
    assert tracer.counts.residuals <= 2 * 8 + 3 + 2 + 3 * 8


@by_preset(FAST, DEFAULT, SERIES)
@pytest.mark.parametrize("offset", [0.0, 273.15, 1e4])
@pytest.mark.parametrize("a", [3.0, 1.5, 1.1])
def test_turning_points_in_celsius_and_in_kelvin(preset, offset, a):
    """lam = x + a sin x turns where cos x = -1 / a, whatever is added to x."""
    homotopy = from_functions(
        lambda y, lam: np.stack([y[0] - offset + a * np.sin(y[0] - offset) - lam]),
        start=([offset], 0.0),
        target=6.0 * np.pi,
    )
    path = path_of(homotopy, preset=preset)
    first = np.arccos(-1.0 / a)
    expected = [x + 2.0 * np.pi * k for k in range(3) for x in (first, 2.0 * np.pi - first)]
    found = [event.y[0] - offset for event in path.turning_points]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8)


@every_preset
@pytest.mark.parametrize("width", bends.WIDTHS)
def test_s_bends_inside_a_step(preset, width):
    """Of widths down to a thousandth of the path; `bends.py` does this 100 times each. FAST may miss one in twelve."""
    found = [bends.judge(case, preset)[0] for kind in bends.KINDS for case in bends.cases(kind, width)(2, 0)]
    assert found.count("") >= (6 if preset is not FAST else 5)


BENDS = [
    # The cubic meets the path in the middle of the S, at 0.31; at 0.77 it is off by less than a landing's correction,
    # which goes along the path, too, and was compared with what goes across it.
    *[(DEFAULT, "tanh", width, seed) for width, seed in ((0.01, 26), (0.003, 1074), (0.003, 1123))],
    # A landing before the target that met it was followed by a step three times as long, whose looks allow more.
    *[(FAST, "curved", 0.001, seed) for seed in (90644, 90821)],
    # What the cubic misses of the curve makes up for the S at 0.31 and 0.77, for most of it and for all.
    *[(DEFAULT, "curved", 0.001, seed) for seed in (6344, 6479)],
    # Folds a sixth of the width behind a point: the monitor of the cubic between that and the next one has one sign.
    (DEFAULT, "curved", 0.003, 6553),
    # What the series was off is made up for by the power of its order, of which nothing is left at 0.77.
    *[(SERIES, "curved", 0.001, seed) for seed in (2027, 2051)],
]


@pytest.mark.parametrize(("preset", "kind", "width", "seed"), BENDS)
def test_an_s_bend_that_was_stepped_over(preset, kind, width, seed):
    case = bends.bend(kind, width, seed)
    path = trace(case.homotopy(), preset=preset)
    assert (path.status, len(path.turning_points)) == (Status.REACHED_TARGET, case.folds)


# -- ends ---------------------------------------------------------------------------------------------------------

POLES = [
    (lambda lam: 1.0 / (lam - 0.5), lambda lam: -1.0 / (lam - 0.5) ** 2, "0.5", "1"),
    (lambda lam: np.tan(0.5 * np.pi * lam), lambda lam: 0.5 * np.pi / np.cos(0.5 * np.pi * lam) ** 2, "1", "1"),
    (lambda lam: 1.0 / (1.0 - lam) ** 2, lambda lam: 2.0 / (1.0 - lam) ** 3, "1", "2"),
]


@by_preset(FAST, DEFAULT, SERIES)
@pytest.mark.parametrize(("y", "slope", "pole", "order"), POLES, ids=["simple", "tangent", "double"])
@pytest.mark.parametrize("unit", [1.0, 1e-6, 1e6])
def test_a_pole_is_named_and_no_point_beside_the_path_counts(preset, y, slope, pole, order, unit):
    homotopy = from_functions(lambda u, lam: np.stack([u[0] - unit * y(lam)]), start=([unit * y(0.0)], 0.0), target=1.0)
    path = path_of(homotopy, preset=preset, budget=Budget(steps=500), status=Status.DIVERGED)
    assert f"A pole: the unknowns grow like |lam - {pole}|^-{order}." in path.message
    # The last place of lam, seen through the slope, is what a point can be known to.
    lam = path.lam
    known = unit * (np.abs(slope(lam)) * np.spacing(lam) + np.abs(y(lam)) * np.finfo(float).eps)
    off = np.abs(path.y[:, 0] - unit * y(lam))
    assert (off <= 1e5 * known).all()
    assert (off <= 1e-6 * np.abs(path.y[:, 0]) + unit * 1e-6).all()


@pytest.mark.parametrize(("preset", "steps"), [(FAST, 300), (SERIES, 60)], ids=["FAST", "SERIES"])
def test_the_upper_branch_of_bratu_never_comes_to_zero(preset, steps):
    upper = trace(Bratu1D(20), events=[TargetValue(1.0)])
    start = (upper.endpoint.u, upper.endpoint.tangent)
    path = trace(Bratu1D(20), preset=preset, start=start, target=0.0, budget=Budget(steps=steps))
    # The asymptote is named, or followed until the budget ends.
    assert path.status in (Status.DIVERGED, Status.BUDGET_EXHAUSTED)
    assert 0.0 < path.endpoint.lam < 1e-9


# -- noise --------------------------------------------------------------------------------------------------------


@every_preset
def test_a_component_that_is_zero_has_no_turning_points(preset):
    def residual(y, lam):
        a, b = y
        return np.stack(
            [a**3 - 6.0 * a**2 + 8.0 * a + a * b**2 - 2.0 * b**2 - lam, a**2 * b - 4.0 * a * b + b**3 + 2.0 * b]
        )

    events = [TurningPoint(1), TargetValue(4.0, component=0)]
    path = path_of(
        from_functions(residual, start=([0.0, 0.0], 0.0), target=None),
        preset=preset,
        events=events,
        status=Status.STOPPED_AT_EVENT,
    )
    assert not [event for event in path.events if event.name == "turning point of component 1"]


# -- what is called -----------------------------------------------------------------------------------------------


@every_preset
@pytest.mark.parametrize("n", [1, 10, 300])
def test_every_call_of_the_residual_is_counted(preset, n):
    calls = []

    def residual(y, lam):
        calls.append(lam)
        return y - lam * np.exp(np.cos(y.sum() / n))

    path = path_of(from_functions(residual, start=(np.zeros(n), 0.0), target=1.0), preset=preset)
    assert path.counts.residuals == len(calls)
