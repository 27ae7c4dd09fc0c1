"""Pictures: what is drawn where, checked on the artists; matplotlib's Agg renders each once."""

import math
from itertools import pairwise

import matplotlib as mpl
import numpy as np
import pytest
from attrs import evolve

from continuation import Budget, Path, TargetValue, from_functions, switch_branch, trace
from continuation.plot import plot_bifurcation, plot_components, plot_profiles, plot_steps
from problems.bifurcation import Bratu1D, Pitchfork

mpl.use("Agg")
from matplotlib.figure import Figure


@pytest.fixture(scope="module")
def path():
    """The fold lam = 1 - y_1^2 with y_2 = y_1^3, from y_1 = -1 to y_1 = 1."""
    homotopy = from_functions(
        lambda y, lam: np.array([y[0] ** 2 + lam - 1.0, y[1] - y[0] ** 3]), start=([-1.0, -1.0], 0.0), target=None
    )
    return trace(homotopy, direction=1, events=[TargetValue(1.0, component=0)])


@pytest.fixture
def axes():
    figure = Figure()
    yield figure.subplots()
    figure.canvas.draw()


def lines(axes):
    return [line for line in axes.get_lines() if line.get_linestyle() != "None"]


def marks(axes):
    return [line for line in axes.get_lines() if line.get_linestyle() == "None"]


def texts(axes):
    """Names, without the arrows."""
    return [text.get_text() for text in axes.texts if text.get_text()]


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_components_lie_on_the_path_between_the_points_too(path, axes):
    plot_components(path, axes, names=["first", "second"])
    first, second = lines(axes)
    lam, y = first.get_data()
    assert len(lam) > 3 * len(path)
    np.testing.assert_allclose(lam, 1 - y**2, atol=2e-3)
    np.testing.assert_allclose(second.get_ydata(), y**3, atol=2e-3)
    assert legend(axes) == ["first", "second"]
    assert axes.get_xlabel() == r"$\lambda$"
    # Turning points are marked on every curve, and events named.
    assert marks(axes)[0].get_xdata() == pytest.approx([1, 1], abs=1e-9)
    assert set(texts(axes)) == {"turning point", "component 0 = 1"}
    # Both unknowns grow along the path, and so do the two arrows.
    arrows = [text for text in axes.texts if not text.get_text()]
    assert [arrow.xy[1] > arrow.xyann[1] for arrow in arrows] == [True, True]
    plot_components(path, bare := Figure().subplots(), legend=False)
    assert not bare.texts


@pytest.mark.parametrize(("asked", "drawn"), [({}, 7), ({"components": range(12)}, 12)])
def test_colours_and_styles_both_tell_curves_apart_of_which_there_are_seven_unless_asked(axes, asked, drawn):
    # y_k = k lam, from lam = 1 to 0.
    slopes = np.arange(1.0, 16.0)
    plot_components(trace(from_functions(lambda y, lam: y - slopes * lam, start=(slopes, 1.0))), axes, **asked)
    looks = [(line.get_color(), line.get_linestyle()) for line in lines(axes)]
    assert len(looks) == len(set(looks)) == drawn
    assert all(a[0] != b[0] and a[1] != b[1] for a, b in pairwise(looks))
    assert legend(axes)[:: drawn - 1] == ["$y_{0}$", "$y_{11}$" if asked else "$y_{14}$"]
    # An axis runs as the path runs.
    assert axes.xaxis_inverted()


def test_a_stored_path_without_tangents_is_smooth_and_turns_where_the_turning_point_is(path, axes):
    stored = Path([evolve(step, segment=None) for step in path.steps], path.events)
    plot_components(stored, axes, components=[0])
    lam, y = lines(axes)[0].get_data()
    assert len(lam) > 3 * len(path)
    assert lam.max() == path.turning_points[0].lam
    np.testing.assert_allclose(lam, 1 - y**2, atol=2e-2)


def test_a_path_of_many_steps_is_not_sampled_between_them_and_one_of_a_single_point_is_drawn(path, axes):
    first, last = path.steps[0], path.steps[-1]
    points = [evolve(first, u=u, arclength=s) for s, u in enumerate(np.linspace(first.u, last.u, 2000))]
    plot_components(Path(points), axes, components=[0])
    assert len(lines(axes)[0].get_xdata()) == 2000
    plot_components(Path(path.steps[:1]), alone := Figure().subplots(), components=[0])
    (point,) = alone.get_lines()
    assert (list(point.get_xdata()), list(point.get_ydata()), point.get_marker()) == ([0.0], [-1.0], ".")


def test_steps_are_the_differences_of_arclength_and_without_axes_a_figure_is_made(path):
    from matplotlib import pyplot

    before = pyplot.get_fignums()
    axes = plot_steps(path)
    assert axes.figure.number not in before
    np.testing.assert_array_equal(lines(axes)[0].get_ydata(), np.diff(path.arclength))
    assert axes.get_yscale() == "log"
    pyplot.close(axes.figure)


def test_components_that_are_nan_throughout_are_left_out(path, axes):
    def padded(of, **options):
        return evolve(of, u=np.array([of.u[0], np.nan, of.u[2]]), **options)

    stored = Path([padded(step, segment=None) for step in path.steps], [padded(event) for event in path.events])
    plot_components(stored, axes)
    assert len(lines(axes)) == 1
    plot_bifurcation(stored, axes)
    assert np.isfinite(lines(axes)[-1].get_ydata()).all()


def test_several_branches_with_their_stability_and_their_points(axes):
    """The pitchfork's trivial branch, and the branch that crosses it."""

    def amplitude(y, lam):
        return y[0]

    trivial = trace(Pitchfork())
    branches = trivial, trace(Pitchfork(), start=switch_branch(Pitchfork(), trivial.events[0])[0], target=1.0)
    plot_bifurcation(branches, axes, value=amplitude, stable=lambda y, lam: lam <= 3.0 * y[0] ** 2, names=["0", "x"])
    first, *others = [(line.get_color(), line.get_linestyle()) for line in lines(axes)]
    assert {style for _, style in (first, *others)} == {"-", "--"}
    assert {look for look in others if look[0] != first[0]} == {(others[-1][0], "-")}
    assert legend(axes) == ["0", "x"]
    assert texts(axes) == ["branch point"]
    assert axes.get_ylabel() == "amplitude"
    assert [mark.get_marker() for mark in marks(axes)] == ["s"]
    branches[1].plot(own := Figure().subplots(), value=0)
    assert own.get_ylabel() == "$y_{0}$"


def test_observed_scalars_and_profiles(axes):
    path, x = trace(Bratu1D(9)), np.linspace(0.1, 0.9, 9)
    plot_bifurcation(path, axes, value="max_u")
    assert lines(axes)[0].get_ydata()[-1] == pytest.approx(8.0)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("lambda", "max_u")
    plot_profiles(path, profiles := Figure().subplots(), profiles=40, x=x)
    assert len(lines(profiles)) == 7


def test_a_scalar_that_is_known_on_a_part_of_the_path_is_drawn_there_alone(axes):
    path = trace(from_functions(lambda y, lam: y - lam, start=([-1.0], -1.0), target=1.0), max_step=0.2)
    steps = [evolve(step, observed={"root": math.sqrt(step.lam) if step.lam > 0.0 else math.nan}) for step in path]
    plot_bifurcation(evolve(path, steps=steps), axes, value="root")
    lam, drawn = (np.asarray(values) for values in lines(axes)[0].get_data())
    assert np.isnan(drawn[lam < 0.0]).all()
    assert drawn[-1] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("draw", "options", "words"),
    [
        (plot_components, {"against": "time"}, "against: expected 'lam' or 'arclength', found 'time'"),
        (plot_components, {"components": [9]}, "components: expected numbers from 0 to 8, found .9."),
        (plot_components, {"components": []}, "components: expected numbers from 0 to 8"),
        (plot_components, {"names": ["x"]}, "names: expected 7, one a component drawn"),
        (plot_bifurcation, {"value": "nothing"}, "value: expected one of max_u, found 'nothing'"),
        (plot_profiles, {"x": np.zeros(8)}, "x: expected 9 places"),
        *((draw, {}, "path: expected at least one point, found")
          for draw in (plot_components, plot_bifurcation, plot_steps)),
    ],
)  # fmt: skip
def test_bad_options_and_empty_paths_are_named(axes, draw, options, words):
    path = trace(Bratu1D(9), budget=Budget(steps=2)) if options else Path()
    with pytest.raises(ValueError, match=words):
        draw(path, axes, **options)
