"""Diagrams: complete, no branch twice, and the same in several processes."""

from collections import Counter
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

from continuation import Budget, Kind, Stability, diagram, from_functions
from continuation.archive import open_archive
from continuation.archive.contents import Contents
from continuation.diagrams import places
from continuation.metric import norm
from continuation.status import Status
from problems.bifurcation import FreudensteinRoth, Pitchfork

from ...util import benchmark
from ..kinks.util import Folded
from .util import ChafeeInfante, Forks


def outline(found):
    return [(b.origin, b.generation, b.path.status, len(b.path), b.path.u.tobytes()) for b in found.branches]


def amplitude(lam):
    """The largest u of the first branch: half a period of u'' + lam (u - u^3) = 0, an elliptic integral, is pi."""
    from scipy.optimize import brentq
    from scipy.special import ellipk

    def half_period(a):
        m = a * a / (2.0 - a * a)
        return 2.0 * ellipk(m) / np.sqrt(lam * (1.0 - 0.5 * a * a)) - np.pi

    return brentq(half_period, 1e-9, 1.0 - 1e-12)


def test_the_diagram_of_a_cubic_equation_has_its_five_branch_points_to_second_order():
    errors = []
    for n in (19, 39):
        homotopy = ChafeeInfante(n)
        found = diagram(homotopy, box={"lam": (0.0, 30.0)}, stability=Stability())
        assert found.complete
        assert len(found) == 6
        assert [point.label for point in found.points] == ["BP1", "BP2", "BP3", "BP4", "BP5"]
        assert [point.branches for point in found.points] == [(0, k) for k in range(1, 6)]
        places = np.array([point.event.lam for point in found.points])
        np.testing.assert_allclose(places, homotopy.crossings(), rtol=0, atol=1e-10)
        errors.append(np.abs(places - np.arange(1, 6) ** 2))
        assert [branch.path.endpoint.observed["unstable"] for branch in found.branches] == [5, 0, 1, 2, 3, 4]
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.05)


def test_the_amplitude_of_the_first_branch_is_that_of_elliptic_integrals():
    errors = []
    for n in (39, 79):
        found = diagram(ChafeeInfante(n), box={"lam": (0.0, 3.0)})
        (first,) = [branch for branch in found.branches if branch.generation]
        assert first.path.endpoint.lam == 3.0
        errors.append(abs(np.abs(first.path.endpoint.y).max() - amplitude(3.0)))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


def test_ten_pitchforks_on_a_trunk_are_eleven_branches():
    found = diagram(Forks(tuple(range(1, 11)), coupled=True), box={"lam": (0.0, 12.0)})
    assert found.complete, found.message
    assert len(found) == 11
    np.testing.assert_allclose([p.event.lam for p in found.points], range(1, 11), rtol=0, atol=1e-10)
    assert [branch.generation for branch in found.branches] == [0, *10 * [1]]
    for k, branch in enumerate(found.branches[1:], start=1):
        # One smooth curve through the branch point, from one end of the box to the other.
        ends = branch.path.y[[0, -1], k - 1]
        np.testing.assert_allclose(sorted(ends), [-np.sqrt(12.0 - k), np.sqrt(12.0 - k)], atol=1e-9)


def test_branches_that_leave_branches_are_all_there_and_none_twice():
    # The k-th unknown leaves each of the 3^(k-1) states of those before it.
    found = diagram(Forks((1.0, 2.0, 3.0, 4.0)), box={"lam": (0.0, 6.0)})
    assert found.complete, found.message
    assert len(found) == 1 + (3**4 - 1) // 2
    assert len(found.of_kind(Kind.BRANCH_POINT)) == (3**4 - 1) // 2 == len(found.points)
    ends = np.vstack([y for branch in found.branches for y in branch.path.y[[0, -1]] if branch.generation])
    states = {tuple(np.sign(np.round(y, 6)).astype(int)) for y in ends}
    assert len(states) == len(ends) == 3**4 - 1
    assert len(found.at(5.5)) == 3**4


def test_the_benchmark_of_pitchforks_runs():
    assert len(benchmark("pitchforks.py").run(3)) == 14


def test_ten_pitchforks_that_leave_each_other_have_an_arm_for_each_and_a_crossing_for_each_later_one():
    # All of them are 29525 branches: the trunk and its arms, by the limit on generations.
    homotopy, asked = Forks(tuple(range(1, 11))), {"box": {"lam": (0.0, 12.0)}, "generations": 1}
    found = diagram(homotopy, **asked)
    assert found.message == "Not complete: 180 rays beyond generation 1 were not followed."
    assert [branch.origin for branch in found.branches] == ["", *(f"BP{k}" for k in range(1, 11))]
    trunk, arms = found.points[:10], found.points[10:]
    np.testing.assert_allclose([p.event.lam for p in trunk], range(1, 11), rtol=0, atol=1e-10)
    assert [p.branches for p in trunk] == [(0, k) for k in range(1, 11)]
    # On the arm of y_k, of either sign, each later one crosses once.
    wanted = sorted((k, sign * np.sqrt(j - k), j) for k in range(1, 11) for j in range(k + 1, 11) for sign in (-1, 1))
    places = sorted((p.branches[0], p.event.y[p.branches[0] - 1], p.event.lam) for p in arms)
    np.testing.assert_allclose(places, wanted, rtol=0, atol=1e-10)
    with ThreadPoolExecutor(3) as workers:
        assert outline(diagram(homotopy, executor=workers, **asked)) == outline(found)


@pytest.mark.parametrize("executor", [ThreadPoolExecutor, ProcessPoolExecutor])
@pytest.mark.parametrize("limits", [{}, {"budget": Budget(steps=12)}], ids=["whole", "box and budget"])
def test_several_workers_find_the_same_branches_in_the_same_order(executor, limits):
    homotopy, box = Forks((1.0, 2.0, 3.0)), {"lam": (0.0, 5.0), **({"y": (-1.6, 1.7)} if limits else {})}
    with executor(2) as workers:
        found = diagram(homotopy, box=box, executor=workers, **limits)
    alone = diagram(homotopy, box=box, **limits)
    assert outline(found) == outline(alone)
    assert [(p.label, p.branches) for p in found.points] == [(p.label, p.branches) for p in alone.points]
    assert found.message == alone.message
    assert found.complete == (not limits)


def test_a_branch_that_meets_another_twice_is_traced_once_whoever_traces_it():
    def slopes(y, lam):
        line, circle = y - 0.5 * lam, y * y + lam * lam - 1.0
        return (circle + 2.0 * y * line)[:, None], -0.5 * circle + 2.0 * lam * line

    homotopy = from_functions(lambda y, lam: (y - 0.5 * lam) * (y * y + lam * lam - 1.0), slopes, start=([-0.75], -1.5))
    alone = diagram(homotopy, box={"lam": (-2.0, 2.0)})
    with ThreadPoolExecutor(4) as workers:
        together = diagram(homotopy, box={"lam": (-2.0, 2.0)}, executor=workers)
    # Four rays leave the line, and all are the circle.
    assert together.counts.accepted > alone.counts.accepted
    assert outline(together) == outline(alone)
    assert [branch.path.status for branch in alone.branches] == [Status.STOPPED_AT_EVENT, Status.CLOSED]
    assert [(p.label, p.branches) for p in alone.points] == [
        ("BP1", (0, 1)), ("BP2", (0, 1)), ("LP1", (1,)), ("LP2", (1,)),
    ]  # fmt: skip


@pytest.mark.parametrize(("ranks", "branches"), [(2, 5), (3, 14)])
def test_all_branches_leave_a_multiple_branch_point(ranks, branches):
    # (lam - 1) y_k = y_k^3: of the 3^ranks - 1 states two are the ends of one curve.
    found = diagram(Forks(ranks * (1.0,)), box={"lam": (0.0, 3.0)})
    assert found.complete, found.message
    assert len(found) == branches
    (point,) = found.points
    assert point.event.kind == Kind.SINGULAR_POINT
    states = {tuple(np.round(y, 6)) for b in found.branches[1:] for y in b.path.y[[0, -1]]}
    assert len(states) == 3**ranks - 1
    assert {abs(x) for state in states for x in state} == {0.0, round(np.sqrt(2.0), 6)}


def test_a_continuum_of_branches_and_too_large_a_kernel_are_said():
    round_about = from_functions(lambda y, lam: lam * y - y * (y[0] * y[0] + y[1] * y[1]), start=(np.zeros(2), -1.0))
    found = diagram(round_about, box={"lam": (-2.0, 2.0)})
    assert not found.complete
    assert "kernel of H' has dimension 3 there" in found.message
    assert "continuum" in found.message
    found = diagram(Forks(4 * (1.0,)), box={"lam": (0.0, 2.0)})
    assert not found.complete
    assert "kernel of H' has dimension 5 there; up to 4 are resolved" in found.message


def test_what_hangs_on_nothing_is_found_by_deflation():
    homotopy, box = Pitchfork(imperfection=0.01), {"lam": (-2.0, 2.0)}
    assert len(diagram(homotopy, box=box)) == 1
    found = diagram(homotopy, box=box, deflate=[1.0])
    assert found.complete
    assert [branch.origin for branch in found.branches] == ["", ""]
    (fold,) = found.points
    # lam y - y^3 + eps has a double root at 27 eps^2 = 4 lam^3.
    assert fold.event.lam == pytest.approx((27.0 * 0.01**2 / 4.0) ** (1.0 / 3.0), abs=1e-10)
    np.testing.assert_allclose(np.sort(found.at(1.0).ravel()), np.sort(np.roots([1.0, 0.0, -1.0, -0.01])), atol=1e-3)


def test_a_start_on_a_known_branch_adds_nothing_and_another_one_its_own():
    homotopy, box = Pitchfork(imperfection=0.01), {"lam": (-2.0, 2.0)}
    assert len(diagram(homotopy, box=box, starts=[([1.0], 1.0)])) == 1
    assert len(diagram(homotopy, box=box, starts=[([-1.0], 1.0), ([0.0], 1.0)])) == 2


def test_a_curve_without_branches_is_one_branch():
    found = diagram(FreudensteinRoth(), box={"lam": (-1.0, 2.0)})
    assert found.complete
    assert [point.label for point in found.points] == ["LP1", "LP2"]
    assert (len(found), found.branches[0].path.lam[[0, -1]].tolist()) == (1, [-1.0, 2.0])


def test_limits_are_kept_and_said():
    homotopy, box = Forks((1.0, 2.0, 3.0)), {"lam": (0.0, 5.0)}
    few = diagram(homotopy, box=box, generations=1)
    assert (len(few), few.complete) == (4, False)
    assert "beyond generation 1" in few.message
    few = diagram(homotopy, box=box, branches=2)
    assert "the limit of 2 branches" in few.message
    short = diagram(homotopy, box=box, budget=Budget(steps=3))
    assert not short.complete
    assert "budget is used up" in short.message


def test_branches_leave_a_kink():
    # |lam| - |y| = 0: from the lower left one branch, and the two others from the kink in the middle.
    crossed = Folded(((0, 0),), ((1, -1),), ((1, 0), (0, 1)), (0,), (0, 0), (-1, 1))
    found = diagram(crossed, box={"lam": (-2.0, 2.0)})
    assert found.complete, found.message
    assert [point.label for point in found.points] == ["KP1"]
    ends = {
        tuple(np.sign(u).astype(int)) for branch in found.branches for u in branch.path.u[[0, -1]] if np.abs(u).all()
    }
    assert ends == {(a, b) for a in (-1, 1) for b in (-1, 1)}


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
    homotopy, asked = Forks((1.0, 2.0, 3.0)), {"box": {"lam": (0.0, 5.0)}}
    whole = diagram(homotopy, **asked)
    assert (len(whole), len(whole.points), whole.complete) == (14, 13, True)
    file = tmp_path / "d.h5"
    few = diagram(homotopy, archive=file, keep="ends", branches=3, **asked)
    assert "2 of them in memory" in repr(few.branches[0].path.steps)
    found = diagram(homotopy, archive=file, keep="ends", resume=True, **asked)
    assert [b.origin for b in found.branches] == [b.origin for b in whole.branches]
    assert [(p.label, p.branches) for p in found.points] == [(p.label, p.branches) for p in whole.points]
    for branch, other in zip(found.branches, whole.branches):
        assert "2 of them in memory" in repr(branch.path.steps)
        # Which of two ends comes first is no matter where a diagram goes on.
        np.testing.assert_allclose(np.abs(branch.path.u[[0, -1]]), np.abs(other.path.u[[0, -1]]), atol=1e-9)
    once = diagram(homotopy, archive=tmp_path / "once.h5", keep="ends", **asked)
    assert outline(once) == outline(whole)
    np.testing.assert_allclose(once.at(4.5), whole.at(4.5), atol=1e-3)


def test_a_diagram_takes_up_as_many_comparisons_as_points(monkeypatch):
    looked = []
    monkeypatch.setattr("continuation.diagrams.places.norm", lambda w, d: looked.append(1) or norm(w, d))
    found = diagram(Forks((1.0, 2.0, 3.0, 4.0)), box={"lam": (0.0, 6.0)})
    # Each of 40 points is met twice while branches are traced, and looked for once more at the end.
    assert len(looked) <= 5 * len(found.points)


def test_a_diagram_goes_on_after_n_log_n_comparisons_and_a_few_reads(monkeypatch, tmp_path):
    counts = Counter()

    def counted(name, function):
        def count(*given):
            counts[name] += 1
            return function(*given)

        return count

    monkeypatch.setattr(places, "_number", counted("probes", places._number))
    monkeypatch.setattr(Contents, "read", counted("reads", Contents.read))
    reads = set()
    for n in (2, 4):
        asked = {"box": {"lam": (0.0, n + 2.0)}, "archive": tmp_path / f"{n}.h5", "keep": "ends"}
        diagram(Forks(tuple(range(1, n + 1))), **asked)
        counts.clear()
        found = diagram(Forks(tuple(range(1, n + 1))), resume=True, **asked)
        reads.add(counts["reads"])
        many, points = (3**n - 1) // 2, sum(map(len, found.paths))
        assert (len(found), len(found.points)) == (1 + many, many)
        # Two for each point of a path and for each of three looks at a branch point, one where it is put in a list.
        bisections = 2 * points + 2 * 3 * many + 2 * many - 2
        assert counts["probes"] <= bisections * many.bit_length()
    assert len(reads) == 1


def test_a_branch_goes_through_the_point_that_it_was_found_at():
    found = diagram(Forks((1.0,)), box={"lam": (0.0, 3.0)})
    path = found.branches[1].path
    assert path.status is Status.STOPPED_AT_EVENT
    assert np.diff(path.arclength).min() > 0.0
    middle = path.u[np.argmin(path.lam)]
    np.testing.assert_allclose(middle, [0.0, 1.0], atol=1e-10)
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
