"""The picture of an answer: the face, the residual, the path that led there."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from problems import lcp
from problems.paper import COUNTEREXAMPLES

mpl.use("Agg")


def bars(axes):
    """Of x and of w: their places and heights."""
    up, down = axes.collections
    return [{int(a[0]): float(b[1]) for a, b in part.get_segments()} for part in (up, down)]


def test_a_face_has_one_bar_for_each_pair_and_a_ring_where_both_are_zero():
    # x = (1, 0, 0), w = (0, 2, 0): the last pair is degenerate.
    solution = lcp.solve(lcp.LCP([[2, 0, 0], [0, 1, 0], [-1, 0, 1]], [-2, 2, 1]))
    axes = solution.plot(Figure().subplots())
    up, down = bars(axes)
    assert up == {0: 1.0}
    assert down == {1: -1.0}
    ring = axes.get_lines()[0]
    assert ring.get_xdata().tolist() == [2]
    assert axes.get_title(loc="left") == "SOLVED: residual 0e+00"
    assert axes.get_xlabel() == "i: 1 of 3 off their bounds"


def test_a_traced_path_stands_beside_the_face_and_the_message_above():
    random = np.random.default_rng(1)
    A = random.standard_normal((6, 6))
    solution = lcp.solve(lcp.LCP(A @ A.T, random.standard_normal(6)), path=True)
    figure = solution.plot()
    path, face = figure.axes
    assert path.get_title(loc="left") == "path 1 of 1: REACHED_TARGET"
    assert len(bars(face)) == 2
    assert figure.get_suptitle().replace("\n", " ") == solution.message
    assert path.get_lines()[0].get_ydata()[-1] == pytest.approx(solution.path.endpoint.y[0])


def test_without_a_point_the_picture_says_so():
    (axes,) = lcp.solve(COUNTEREXAMPLES[0].problem).plot().axes
    assert [text.get_text() for text in axes.texts] == ["no point"]
