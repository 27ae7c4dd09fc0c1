"""Diagrams: complete, no branch twice, and the same in several processes."""

import re
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

from continuation import Automatic, Budget, Kind, Stability, diagram, from_functions
from continuation.archive import open_archive
from continuation.status import Status
from problems.bifurcation import FreudensteinRoth, Pitchfork

from .util import CROSSED, Forks, chafee_infante

IMPERFECT, WIDE = Pitchfork(imperfection=0.01), {"lam": (-2.0, 2.0)}
THREE, FIVE = Forks((1.0, 2.0, 3.0)), {"lam": (0.0, 5.0)}
ROUND_ABOUT = from_functions(lambda y, lam: lam * y - y * (y @ y), start=(np.zeros(2), -1.0))
LINE_AND_CIRCLE = from_functions(lambda y, lam: (y - 0.5 * lam) * (y * y + lam * lam - 1.0), start=([-0.75], -1.5))


def outline(found):
    return [(b.origin, b.generation, b.path.status, len(b.path), b.path.u.tobytes()) for b in found.branches]


def labels(found):
    return [(point.label, point.branches) for point in found.points]


@pytest.mark.parametrize(
    ("homotopy", "options", "branches", "points"),
    [
        (FreudensteinRoth(), {"box": {"lam": (-1.0, 2.0)}}, 1, ["LP1", "LP2"]),
        (CROSSED, {"box": WIDE}, 3, ["KP1"]),
        (Forks((1.0,)), {"box": FIVE}, 2, ["BP1"]),
        (Forks(2 * (1.0,)), {"box": FIVE}, 5, ["BP1"]),
        # What hangs on nothing is found by deflation or from starts, of which those on known branches add nothing.
        (IMPERFECT, {"box": WIDE}, 1, []),
        (IMPERFECT, {"box": WIDE, "deflate": [1.0]}, 2, ["LP1"]),
        (IMPERFECT, {"box": WIDE, "starts": [([1.0], 1.0)]}, 1, []),
        (IMPERFECT, {"box": WIDE, "starts": [([-1.0], 1.0), ([0.0], 1.0)]}, 2, ["LP1"]),
    ],
    ids=["folds", "kink", "fork", "double fork", "alone", "deflated", "known start", "other starts"],
)
def test_a_small_diagram_is_complete_and_has_no_branch_twice(homotopy, options, branches, points):
    found = diagram(homotopy, **options)
    assert found.complete, found.message
    assert len(found) == branches
    assert [point.label for point in found.points] == points


def test_the_solutions_at_a_value_are_those_of_all_branches():
    found = diagram(IMPERFECT, box=WIDE, deflate=[1.0])
    (fold,) = found.points
    # lam y - y^3 + eps has a double root at 27 eps^2 = 4 lam^3.
    assert fold.event.lam == pytest.approx((27.0 * 0.01**2 / 4.0) ** (1.0 / 3.0), abs=1e-10)
    np.testing.assert_allclose(np.sort(found.at(1.0).ravel()), np.sort(np.roots([1.0, 0.0, -1.0, -0.01])), atol=1e-3)


def test_the_diagram_of_a_cubic_equation_has_its_five_branch_points_to_second_order():
    errors = []
    for n in (19, 39):
        homotopy, crossings = chafee_infante(n)
        found = diagram(homotopy, box={"lam": (0.0, 30.0)}, stability=Stability())
        assert found.complete
        assert labels(found) == [(f"BP{k}", (0, k)) for k in range(1, 6)]
        places = np.array([point.event.lam for point in found.points])
        np.testing.assert_allclose(places, crossings, rtol=0, atol=1e-10)
        errors.append(np.abs(places - np.arange(1, 6) ** 2))
        assert [branch.path.endpoint.observed["unstable"] for branch in found.branches] == [5, 0, 1, 2, 3, 4]
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.05)


def test_branches_that_leave_branches_are_all_there_and_none_twice():
    # The k-th unknown leaves each of the 3^(k-1) states of those before it.
    found = diagram(Forks((1.0, 2.0, 3.0, 4.0)), box={"lam": (0.0, 6.0)})
    assert found.complete, found.message
    assert len(found) == 1 + (3**4 - 1) // 2
    assert len(found.of_kind(Kind.BRANCH_POINT)) == (3**4 - 1) // 2 == len(found.points)
    ends = np.vstack([y for branch in found.branches for y in branch.path.y[[0, -1]] if branch.generation])
    assert len({tuple(np.sign(np.round(y, 6))) for y in ends}) == len(ends) == 3**4 - 1
    assert len(found.at(5.5)) == 3**4


@pytest.mark.parametrize(
    ("executor", "options"),
    [
        (ThreadPoolExecutor, {"box": FIVE}),
        (ProcessPoolExecutor, {"box": {**FIVE, "y": (-1.6, 1.7)}, "budget": Budget(steps=12)}),
    ],
    ids=["whole", "box and budget"],
)
def test_several_workers_find_the_same_branches_in_the_same_order(executor, options):
    with executor(2) as workers:
        found = diagram(THREE, executor=workers, **options)
    alone = diagram(THREE, **options)
    assert outline(found) == outline(alone)
    assert (labels(found), found.message) == (labels(alone), alone.message)
    assert found.complete == ("budget" not in options)


def test_a_branch_that_meets_another_twice_is_traced_once_whoever_traces_it():
    alone = diagram(LINE_AND_CIRCLE, box=WIDE)
    with ThreadPoolExecutor(4) as workers:
        together = diagram(LINE_AND_CIRCLE, box=WIDE, executor=workers)
    # Four rays leave the line, and all are the circle.
    assert together.counts.accepted > alone.counts.accepted
    assert outline(together) == outline(alone)
    assert [branch.path.status for branch in alone.branches] == [Status.STOPPED_AT_EVENT, Status.CLOSED]
    assert labels(alone) == [("BP1", (0, 1)), ("BP2", (0, 1)), ("LP1", (1,)), ("LP2", (1,))]


@pytest.mark.parametrize(
    ("homotopy", "options", "words"),
    [
        (ROUND_ABOUT, {"box": WIDE}, "kernel of H' has dimension 3 there, and its branches do .* continuum"),
        (Forks(4 * (1.0,)), {"box": FIVE}, "kernel of H' has dimension 5 there; up to 4 are resolved"),
        (THREE, {"box": FIVE, "generations": 1}, "beyond generation 1"),
        (THREE, {"box": FIVE, "branches": 2}, "the limit of 2 branches"),
        (THREE, {"box": FIVE, "budget": Budget(steps=3)}, "budget is used up"),
    ],
    ids=["continuum", "too large a kernel", "generations", "branches", "budget"],
)
def test_what_is_not_complete_says_why(homotopy, options, words):
    found = diagram(homotopy, **options)
    assert not found.complete
    assert re.search(words, found.message)


def test_one_archive_holds_all_branches_and_the_picture_names_the_points(tmp_path):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    homotopy = Forks((1.0, 2.0), coupled=True)
    found = diagram(homotopy, box={"lam": (0.0, 3.0)}, stability=Stability(), archive=tmp_path / "branches.h5")
    with open_archive(tmp_path / "branches.h5") as archive:
        assert len(archive) == 3
        for branch, stored in zip(found.branches, archive):
            np.testing.assert_array_equal(stored.u, branch.path.u)
            assert [s.observed["unstable"] for s in stored.steps] == [s.observed["unstable"] for s in branch.path.steps]
            assert [(e.kind, e.lam) for e in stored.events] == [(e.kind, e.lam) for e in branch.path.events]
    axes = found.plot(value=0)
    assert [text.get_text() for text in axes.texts] == ["BP1", "BP2"]
    assert {line.get_linestyle() for line in axes.lines} >= {"-", "--"}
    assert found.plot(value=0, labels=False).texts[:] == []
    pyplot.close("all")


def test_points_that_are_not_kept_are_read_from_the_file_and_the_diagram_goes_on_from_it(tmp_path):
    whole, file = diagram(THREE, box=FIVE), tmp_path / "d.h5"
    few = diagram(THREE, archive=file, keep="ends", branches=3, box=FIVE)
    assert "steps in" in repr(few.branches[0].path.steps)
    found = diagram(THREE, archive=file, keep="ends", resume=True, box=FIVE)
    assert [b.origin for b in found.branches] == [b.origin for b in whole.branches]
    assert labels(found) == labels(whole)
    for branch, other in zip(found.branches, whole.branches):
        # Which of two ends comes first is no matter where a diagram goes on.
        np.testing.assert_allclose(np.abs(branch.path.u[[0, -1]]), np.abs(other.path.u[[0, -1]]), atol=1e-9)
    np.testing.assert_allclose(np.sort(found.at(4.5), axis=0), np.sort(whole.at(4.5), axis=0), atol=1e-3)


def test_a_branch_goes_through_the_point_that_it_was_found_at():
    path = diagram(Forks((1.0,)), box={"lam": (0.0, 3.0)}).branches[1].path
    assert path.status is Status.STOPPED_AT_EVENT
    assert np.diff(path.arclength).min() > 0.0
    np.testing.assert_allclose(path.u[np.argmin(path.lam)], [0.0, 1.0], atol=1e-10)
    np.testing.assert_allclose(path.y[:, 0] ** 2, path.lam - 1.0, atol=1e-9)
    # The curve between the points, the branch point among them, is the parabola too.
    between = path(np.linspace(0.0, path.arclength[-1], 50))
    np.testing.assert_allclose(between[:, 0] ** 2, between[:, 1] - 1.0, atol=2e-2)


@pytest.mark.parametrize(
    ("options", "message"),
    [({}, "box: expected one"), ({"box": {"lam": (0.5, 2.0)}}, "box: expected each start inside")],
)
def test_a_box_that_holds_no_start_is_refused(options, message):
    with pytest.raises((TypeError, ValueError), match=message):
        diagram(Forks((1.0,)), **options)


def test_no_scale_of_a_branch_is_below_a_tenth_of_the_scale_before():
    before = Automatic().of_extent(np.array([1.0, 1.0, 2.0]))
    short = np.array([1e-4, 3.0, 1e-4])
    on_branch = Automatic(before=before).of_extent(short)
    np.testing.assert_allclose(on_branch, np.minimum(Automatic().of_extent(short), 100.0 * before))
    assert (on_branch < Automatic().of_extent(short)).tolist() == [True, False, True]
