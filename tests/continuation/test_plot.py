"""Pictures: what is drawn where, checked on the artists; matplotlib's Agg renders each once."""

from itertools import pairwise

import matplotlib as mpl
import numpy as np
import pytest
from attrs import evolve

import continuation
from continuation.plot import plot_bifurcation, plot_components, plot_heat, plot_profiles, plot_steps
from problems.bifurcation import Bratu1D, Circle, Pitchfork

mpl.use("Agg")
from matplotlib.figure import Figure


@pytest.fixture(scope="module")
def path():
    """The fold lam = 1 - y_1^2 with y_2 = y_1^3, from y_1 = -1 to y_1 = 1."""

    def residual(y, lam):
        return np.array([y[0] ** 2 + lam - 1.0, y[1] - y[0] ** 3])

    homotopy = continuation.from_functions(residual, start=([-1.0, -1.0], 0.0), target=None)
    end = continuation.TargetValue(1.0, component=0)
    return continuation.trace(homotopy, direction=1, events=[end])


@pytest.fixture
def axes():
    figure = Figure()
    yield figure.subplots()
    figure.canvas.draw()


def lines(axes):
    return [line for line in axes.get_lines() if line.get_linestyle() != "None"]


def marks(axes):
    return [line for line in axes.get_lines() if line.get_linestyle() == "None"]


def test_components_lie_on_the_path_between_the_points_too(path, axes):
    plot_components(path, axes, names=["first", "second"])
    first, second = lines(axes)
    lam, y = first.get_data()
    assert len(lam) > 3 * len(path)
    np.testing.assert_allclose(lam, 1 - y**2, atol=2e-3)
    np.testing.assert_allclose(second.get_ydata(), y**3, atol=2e-3)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["first", "second"]
    assert axes.get_xlabel() == r"$\lambda$"


def test_turning_points_are_marked_on_every_curve(path, axes):
    plot_components(path, axes)
    mark, _ = marks(axes)
    np.testing.assert_allclose(mark.get_xdata(), [1, 1], atol=1e-9)
    np.testing.assert_allclose(mark.get_ydata(), [0, 0], atol=1e-5)


def heads(axes):
    """Arrows, as (from, to)."""
    return [(text.xyann, text.xy) for text in axes.texts if not text.get_text()]


def test_events_are_named_and_arrows_go_where_the_path_goes(path, axes):
    plot_components(path, axes)
    assert {text.get_text() for text in axes.texts} == {"", "turning point", "component 0 = 1"}
    for (_, before), (_, after) in heads(axes):
        # Both unknowns grow along the path.
        assert after > before
    assert len(heads(axes)) == 2
    plot_components(path, bare := Figure().subplots(), legend=False)
    assert not bare.texts


def test_of_events_of_one_name_the_first_is_named_with_their_number(axes):
    plot_components(continuation.trace(Circle()), axes)
    assert [text.get_text() for text in axes.texts if text.get_text()] == ["turning point (2)"]


def test_round_off_at_events_does_not_set_the_scale(axes):
    """A trivial branch is a straight line, and its branch points lie on it."""
    path = continuation.trace(continuation.from_functions(lambda y, lam: y * lam, start=([0.0], -1.0), target=1.0))
    path = continuation.Path(path.steps, [evolve(event, u=event.u + np.array([1e-16, 0.0])) for event in path.events])
    assert path.events
    path.plot(axes)
    low, high = axes.get_ylim()
    assert high - low > 0.1
    assert low < 0.0 < high


def test_why_a_path_ended_before_its_end_is_said_where_it_ends(axes):
    path = continuation.trace(Circle(), budget=continuation.Budget(steps=3))
    path.plot(axes)
    (said,) = [text for text in axes.texts if text.get_text() == "budget exhausted"]
    assert said.xy == (path.endpoint.lam, path.endpoint.y[0])


def test_stability_is_said(axes):
    path = continuation.trace(Pitchfork(), observers=[continuation.Stability()])
    path.plot(axes)
    assert axes.get_title(loc="right") == "solid: stable, dashed: not"
    assert {line.get_linestyle() for line in lines(axes)} == {"-", "--"}


def test_against_arclength(path, axes):
    plot_components(path, axes, against="arclength", components=[1])
    (line,) = lines(axes)
    s = line.get_xdata()
    assert s[0] == 0
    assert s[-1] == path.arclength[-1]
    np.testing.assert_allclose(line.get_ydata(), path(s)[:, 1], atol=2e-3)
    mark, _ = marks(axes)
    assert mark.get_xdata()[0] == path.turning_points[0].arclength
    assert axes.get_ylabel() == "$y_{1}$"


def test_colours_and_styles_both_tell_curves_apart(axes):
    n = 12
    slopes = np.arange(1.0, n + 1)
    homotopy = continuation.from_functions(lambda y, lam: y - slopes * lam, start=(slopes, 1.0))
    plot_components(continuation.trace(homotopy), axes, components=range(n))
    looks = [(line.get_color(), line.get_linestyle()) for line in lines(axes)]
    assert len(set(looks)) == n
    assert all(a[0] != b[0] and a[1] != b[1] for a, b in pairwise(looks))


def test_at_most_seven_components_unless_asked(axes):
    homotopy = continuation.from_functions(lambda y, lam: y - lam, start=(np.ones(15), 1.0))
    path = continuation.trace(homotopy)
    plot_components(path, axes)
    assert len(lines(axes)) == 7
    assert axes.get_legend().get_title().get_text() == "7 of 15"
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert (names[0], names[-1]) == ("$y_{0}$", "$y_{14}$")


def test_the_bifurcation_diagram_shows_the_norm_or_a_component(path, axes):
    plot_bifurcation(path, axes)
    (line,) = lines(axes)
    lam, height = line.get_data()
    np.testing.assert_allclose(height**2, 1 - lam, atol=5e-3)
    plot_bifurcation(path, axes, component=1)
    assert lines(axes)[1].get_ydata()[0] == -1
    assert axes.get_ylabel() == "$y_{1}$"


def test_a_stored_path_without_tangents_is_smooth_and_turns_where_the_turning_point_is(path, axes):
    stored = continuation.Path([evolve(step, segment=None) for step in path.steps], path.events)
    plot_components(stored, axes, components=[0])
    lam, y = lines(axes)[0].get_data()
    (turn,) = path.turning_points
    assert len(lam) > 3 * len(path)
    assert lam.max() == turn.lam
    np.testing.assert_allclose(lam, 1 - y**2, atol=2e-2)


def test_a_path_of_many_steps_is_not_sampled_between_them(axes):
    homotopy = continuation.from_functions(lambda y, lam: y - lam, start=(np.ones(1), 1.0))
    path = continuation.trace(homotopy)
    (first, last) = (path.steps[0], path.steps[-1])
    points = [evolve(first, u=u, arclength=s) for s, u in enumerate(np.linspace(first.u, last.u, 2000))]
    plot_components(continuation.Path(points), axes)
    assert len(lines(axes)[0].get_xdata()) == 2000


def test_steps_are_the_differences_of_arclength(path, axes):
    plot_steps(path, axes)
    line = lines(axes)[0]
    np.testing.assert_array_equal(line.get_ydata(), np.diff(path.arclength))
    assert axes.get_yscale() == "log"


def test_components_that_are_nan_throughout_are_left_out(path, axes):
    def padded(step):
        return evolve(step, u=np.array([step.u[0], np.nan, step.u[2]]), segment=None)

    stored = continuation.Path([padded(step) for step in path.steps], [padded_event(e) for e in path.events])
    plot_components(stored, axes)
    assert len(lines(axes)) == 1
    plot_bifurcation(stored, axes)
    assert np.isfinite(lines(axes)[-1].get_ydata()).all()


def test_dense_output_with_nan_of_an_archive_is_drawn(path, axes):
    class Padded:
        def __init__(self, segment):
            self.segment = segment

        def at(self, t):
            return np.where([False, True, False], np.nan, self.segment.at(t))

    steps = [evolve(step, segment=step.segment and Padded(step.segment)) for step in path.steps]
    plot_components(continuation.Path(steps), axes, components=[0], against="arclength")
    (line,) = lines(axes)
    assert np.isfinite(line.get_xydata()).all()
    assert len(line.get_xdata()) > 3 * len(path)


def padded_event(event):
    return evolve(event, u=np.array([event.u[0], np.nan, event.u[2]]))


def test_a_single_point_can_be_drawn(axes):
    homotopy = continuation.from_functions(lambda y, lam: y - lam, start=([1.0], 1.0))
    path = continuation.trace(homotopy, budget=continuation.Budget(steps=1))
    plot_components(continuation.Path(path.steps[:1]), axes)
    (point,) = axes.get_lines()
    assert (list(point.get_xdata()), list(point.get_ydata()), point.get_marker()) == ([1.0], [1.0], ".")
    plot_steps(continuation.Path(path.steps[:1]), axes)
    assert len(axes.get_lines()[1].get_xdata()) == 0


def test_without_axes_a_figure_is_made(path):
    from matplotlib import pyplot

    before = pyplot.get_fignums()
    axes = plot_steps(path)
    assert axes.figure.number not in before
    np.testing.assert_array_equal(axes.get_lines()[0].get_ydata(), np.diff(path.arclength))
    pyplot.close(axes.figure)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"against": "time"}, "against: expected 'lam' or 'arclength', found 'time'"),
        ({"components": [2]}, "components: expected numbers from 0 to 1, found 2"),
        ({"names": ["x"]}, "names: expected 2, one a component drawn, found 1"),
    ],
)
def test_bad_options_are_named(path, axes, options, message):
    with pytest.raises(ValueError, match=message):
        plot_components(path, axes, **options)


@pytest.mark.parametrize("plot", [plot_components, plot_bifurcation, plot_steps])
def test_an_empty_path_is_refused(plot, axes):
    with pytest.raises(ValueError, match="path: expected at least one point, found none"):
        plot(continuation.Path(), axes)


@pytest.fixture(scope="module")
def branches():
    """The pitchfork's trivial branch, and the branch that crosses it."""
    pitchfork = Pitchfork()
    trivial = continuation.trace(pitchfork)
    start, _ = continuation.switch_branch(pitchfork, trivial.events[0])
    return trivial, continuation.trace(pitchfork, start=start, target=1.0)


def test_several_branches_with_their_stability_and_their_points(branches, axes):
    def amplitude(y, lam):
        return y[0]

    plot_bifurcation(branches, axes, value=amplitude, stable=lambda y, lam: lam <= 3.0 * y[0] ** 2, names=["0", "x"])
    styles = {(line.get_color(), line.get_linestyle()) for line in lines(axes)}
    assert len({color for color, _ in styles}) == 2
    assert {style for _, style in styles} == {"-", "--"}
    assert {style for color, style in styles if color != lines(axes)[0].get_color()} == {"-"}
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert texts == ["0", "x"]
    assert [text.get_text() for text in axes.texts if text.get_text()] == ["branch point"]
    assert axes.get_ylabel() == "amplitude"
    (mark,) = marks(axes)
    assert mark.get_marker() == "s"


def test_observed_scalars_and_names(axes):
    path = continuation.trace(Bratu1D(10))
    plot_bifurcation(path, axes, value="max_u")
    (line,) = lines(axes)
    np.testing.assert_allclose(line.get_ydata()[-1], 8.0)
    assert axes.get_ylabel() == "max_u"
    assert axes.get_xlabel() == "lambda"
    with pytest.raises(ValueError, match="value: expected one of max_u, found 'nothing'"):
        plot_bifurcation(path, axes, value="nothing")
    with pytest.raises(ValueError, match="stable: expected one of max_u"):
        plot_bifurcation(path, axes, stable="nothing")


def test_an_axis_runs_as_the_path_runs(axes):
    falling = continuation.trace(continuation.from_functions(lambda y, lam: y - lam, start=([1.0], 1.0)))
    falling.plot(axes)
    assert axes.xaxis_inverted()


def test_profiles_and_heat(axes):
    path, x = continuation.trace(Bratu1D(9)), np.linspace(0.1, 0.9, 9)
    plot_profiles(path, axes, profiles=40, x=x)
    assert len(lines(axes)) == 7
    other = Figure().subplots()
    plot_heat(path, other, x)
    assert other.get_ylabel() == "$x$"
    for draw in (plot_profiles, plot_heat):
        with pytest.raises(ValueError, match="x: expected 9 places"):
            draw(path, axes, x=x[1:])


def test_a_path_draws_itself(branches, axes):
    branches[1].plot(axes, value=0)
    assert axes.get_ylabel() == "$y_{0}$"
