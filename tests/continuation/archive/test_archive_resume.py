"""A resumed path is bit for bit the uninterrupted one, for every part, interrupted at every step in turn."""

import math
from itertools import pairwise

import attrs
import numpy as np
import pytest

import continuation
from continuation import Budget, Monitor, Status, TargetValue, Tracer, from_functions, trace
from continuation.archive import ArchiveError, Limits, PathLog, open_archive, recover, resume
from continuation.archive.checkpoint import Checkpoint, describe_run, pack, unpack
from continuation.metric import Relative
from problems.bifurcation import Circle, ExponentialCosine, FreudensteinRoth

PROBLEMS = {"circle": Circle(), "freudenstein-roth": FreudensteinRoth(), "exponential cosine": ExponentialCosine(3)}


def parts(module, method):
    """An instance of each concrete part that a package exports, so that new ones are tested without a word here."""
    found = [getattr(module, name) for name in module.__all__]
    return [part() for part in found if callable(getattr(part, method, None)) and attrs.has(part)]


WITH = {"SeriesRange": {"predictor": continuation.predictors.Taylor()}}
"""A controller that is made for one predictor is tested with it."""

OPTIONS = [
    *({"predictor": part} for part in parts(continuation.predictors, "prepare")),
    *({"corrector": part} for part in parts(continuation.correctors, "correct")),
    *({"controller": part, **WITH.get(type(part).__name__, {})} for part in parts(continuation.controllers, "update")),
    {"metric": Relative()},
]


def name(options):
    return type(next(iter(options.values()))).__name__


def leaves(value):
    """All numbers and arrays of a state, in order."""
    if attrs.has(type(value)):
        value = tuple(getattr(value, a.name) for a in attrs.fields(type(value)))
    if isinstance(value, tuple):
        return [leaf for item in value for leaf in leaves(item)]
    return [np.asarray(value)]


def identical(a, b):
    a, b = leaves(a), leaves(b)
    return len(a) == len(b) and all(np.array_equal(x, y, equal_nan=True) for x, y in zip(a, b))


class Snapshots:
    """The states along a path, as an archive would hold them."""

    def __init__(self, *, packs=True):
        self.states, self.checkpoints, self.packs = [], [], packs

    def step(self, tracer, step):
        if step.index != tracer.state.index:
            return
        self.states.append(tracer.state)
        if self.packs:
            run = describe_run(tracer, None)
            checkpoint = Checkpoint(1, 0, 1, tracer.state, tracer.counts.as_dict(), 0.0, run)
            self.checkpoints.append(unpack(pack(checkpoint)))

    def event(self, tracer, event):
        pass

    def end(self, tracer):
        pass


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("options", OPTIONS, ids=name)
def test_each_state_leads_to_the_next_exactly(problem, options):
    """By induction from here on: the state that an archive holds gives the next state, bit for bit, at every step."""
    homotopy, seen = PROBLEMS[problem], Snapshots()
    options = {"budget": Budget(steps=20), **options}
    tracer = Tracer(homotopy, observers=(seen,), **options)
    for _ in tracer:
        pass
    if tracer.path.status is Status.REACHED_TARGET:
        assert len(seen.states) > 3
    for (before, after), checkpoint in zip(pairwise(seen.states), seen.checkpoints):
        assert identical(before, checkpoint.state)
        again = Snapshots(packs=False)
        steps = iter(Tracer(homotopy, state=checkpoint.state, observers=(again,), **options))
        next(steps, None)
        steps.close()
        assert identical(again.states[0], after)


def interrupt(file, homotopy, index, **options):
    log = PathLog(file, limits=Limits(rows=5, seconds=3600.0))
    steps = iter(Tracer(homotopy, observers=(log,), **options))
    next(step for step in steps if step.index == index)
    steps.close()


def assert_same_path(found, path):
    assert np.array_equal(found.u, path.u)
    assert np.array_equal(found.arclength, path.arclength)
    assert [step.kind for step in found.steps] == [step.kind for step in path.steps]
    assert (found.status, found.message, found.counts) == (path.status, path.message, path.counts)
    assert [(e.name, e.step, e.monitor, *e.u) for e in found.events] == [
        (e.name, e.step, e.monitor, *e.u) for e in path.events
    ]


WHOLE = {name: trace(PROBLEMS[name]) for name in ("circle", "freudenstein-roth")}
EVERY_STEP = [("circle", k) for k in range(len(WHOLE["circle"]) - 1)]
AT_EVENTS = [("freudenstein-roth", e.step + k) for e in WHOLE["freudenstein-roth"].events for k in (-1, 0)]


@pytest.mark.parametrize(("problem", "k"), EVERY_STEP + AT_EVENTS)
def test_interrupted_at_every_step_through_a_file(tmp_path, problem, k):
    path = WHOLE[problem]
    interrupt(tmp_path / "run.h5", PROBLEMS[problem], k)
    assert_same_path(resume(tmp_path / "run.h5"), path)
    with open_archive(tmp_path / "run.h5") as archive:
        assert len(archive) == 1
        assert archive.closed_by_writer
        assert "resumed" in archive.attributes["history"]
        assert_same_path(archive.path(0), path)


def test_resumed_again_and_again(tmp_path):
    """One more step at a time: many links, and still the same path."""
    path = trace(FreudensteinRoth(), archive=tmp_path / "whole.h5")
    trace(FreudensteinRoth(), archive=tmp_path / "run.h5", budget=Budget(steps=1))
    for steps in range(2, len(path)):
        found = resume(tmp_path / "run.h5", budget=Budget(steps=steps))
    with pytest.raises(ArchiveError, match="has ended"):
        resume(tmp_path / "run.h5", budget=Budget())
    assert_same_path(found, path)
    with open_archive(tmp_path / "run.h5") as archive, open_archive(tmp_path / "whole.h5") as whole:
        for column in whole.points:
            assert np.array_equal(archive.points[column], whole.points[column], equal_nan=True), column


def test_events_and_options_come_from_the_file(tmp_path):
    options = {
        "events": [TargetValue(0.25, terminal=0), TargetValue(-0.5, terminal=2)],
        "predictor": continuation.predictors.Tangent(),
        "tolerance": 1e-10,
        "direction": 1,
        "target": 3.0,
    }
    path = trace(FreudensteinRoth(), **options)
    assert path.status is Status.STOPPED_AT_EVENT
    interrupt(tmp_path / "run.h5", FreudensteinRoth(), len(path) - 3, **options)
    assert_same_path(resume(tmp_path / "run.h5"), path)


def test_resume_into_another_file_leaves_the_first(tmp_path):
    interrupt(tmp_path / "run.h5", FreudensteinRoth(), 7)
    before = (tmp_path / "run.h5").read_bytes()
    resume(tmp_path / "run.h5", archive=tmp_path / "more.h5")
    assert (tmp_path / "run.h5").read_bytes() == before
    with open_archive(tmp_path / "more.h5") as archive:
        assert_same_path(archive.path(0), trace(FreudensteinRoth()))
        assert archive.attributes["parent"].startswith("run.h5 (")


def test_the_last_of_many_paths(tmp_path):
    with PathLog(tmp_path / "run.h5") as log:
        first = trace(ExponentialCosine(3), archive=log)
        log.member = 17
        trace(ExponentialCosine(3, target=0.5), archive=log, budget=Budget(steps=2))
    found = resume(tmp_path / "run.h5", budget=Budget())
    assert_same_path(found, trace(ExponentialCosine(3, target=0.5)))
    with open_archive(tmp_path / "run.h5") as archive:
        assert_same_path(archive.path(0), first)
        assert_same_path(archive.path(1), found)
        assert archive.paths["member"].tolist() == [0, 17]


def _line(y, lam):
    return y - 3.0 * lam


def test_a_homotopy_of_functions_is_stored_by_name_and_arrays(tmp_path):
    homotopy = from_functions(_line, start=(np.array([0.3, 0.6]), 0.1), target=1.0)
    interrupt(tmp_path / "run.h5", homotopy, 1)
    with pytest.raises(ArchiveError, match=r"_line is a function, which is not trusted: pass it in trust="):
        resume(tmp_path / "run.h5")
    assert_same_path(resume(tmp_path / "run.h5", trust=[_line]), trace(homotopy))


class Stateful:
    """The smallest plug-in with a constructor: nothing tells an archive how to make it again."""

    target = 1.0

    def __init__(self, slope):
        self.slope = slope

    def start(self):
        return np.zeros(1), 0.0

    def residual(self, y, lam):
        return y - self.slope * lam**2


class Telling(Stateful):
    """The same, with the capability."""

    def archive_data(self):
        return {"slope": np.array(self.slope), "note": "a parabola"}

    @classmethod
    def from_archive(cls, data):
        return cls(float(data["slope"]))


def test_a_homotopy_that_cannot_be_stored_is_asked_for(tmp_path):
    interrupt(tmp_path / "run.h5", Stateful(2.0), 2)
    with pytest.raises(ArchiveError, match=r"Stateful has neither archive_data nor attrs fields\); pass homotopy="):
        resume(tmp_path / "run.h5")
    with pytest.raises(ValueError, match="homotopy: expected the archive's residual"):
        resume(tmp_path / "run.h5", Stateful(5.0))
    with pytest.raises(ValueError, match="homotopy: expected 1 unknowns"):
        resume(tmp_path / "run.h5", FreudensteinRoth())
    assert_same_path(resume(tmp_path / "run.h5", Stateful(2.0)), trace(Stateful(2.0)))


def test_a_homotopy_that_says_what_to_store(tmp_path):
    interrupt(tmp_path / "run.h5", Telling(2.0), 2)
    with pytest.raises(ArchiveError, match=r"Telling is not registered: pass it in trust=.*pass homotopy="):
        resume(tmp_path / "run.h5")
    assert_same_path(resume(tmp_path / "run.h5", trust=[Telling]), trace(Telling(2.0)))


def test_a_monitor_that_cannot_be_stored_is_asked_for(tmp_path):
    events = [Monitor(lambda u, v: u[0] - 20.0)]
    interrupt(tmp_path / "run.h5", FreudensteinRoth(), 5, events=events)
    with pytest.raises(ArchiveError, match=r"events cannot be made from the file.*lambda.*pass events="):
        resume(tmp_path / "run.h5")
    assert_same_path(resume(tmp_path / "run.h5", events=events), trace(FreudensteinRoth(), events=events))


class Winding(Telling):
    """Events of its own, and an exception in the middle of the path."""

    events = (TargetValue(0.7, component=0, terminal=0),)
    calls_left = math.inf

    def residual(self, y, lam):
        self.calls_left -= 1
        if self.calls_left < 0:
            raise RuntimeError("the licence server is down")
        return super().residual(y, lam)


def test_an_exception_of_the_homotopy_is_an_interruption(tmp_path):
    homotopy = Winding(2.0)
    homotopy.calls_left = trace(Winding(2.0)).counts.residuals // 2
    with pytest.raises(RuntimeError, match="licence"):
        trace(homotopy, archive=tmp_path / "run.h5", events=[TargetValue(0.2, terminal=0)])
    path = trace(Winding(2.0), events=[TargetValue(0.2, terminal=0)])
    assert len(path.events) == 2
    assert_same_path(resume(tmp_path / "run.h5", trust=[Winding]), path)


def test_what_has_ended_or_spent_its_budget_says_so(tmp_path):
    trace(FreudensteinRoth(), archive=tmp_path / "run.h5")
    with pytest.raises(ArchiveError, match=r"path 0 has ended \(REACHED_TARGET\)"):
        resume(tmp_path / "run.h5")
    trace(FreudensteinRoth(), archive=tmp_path / "short.h5", budget=Budget(steps=3))
    with pytest.raises(ArchiveError, match="the budget of path 0 is used up; pass budget="):
        resume(tmp_path / "short.h5")
    with pytest.raises(FileExistsError, match="exists already"):
        resume(tmp_path / "short.h5", archive=tmp_path / "run.h5", budget=Budget())


def test_the_end_itself_is_decided_again(tmp_path):
    """A writer killed between the last point and the decision that it is the last."""
    path = trace(Circle())
    log = PathLog(tmp_path / "run.h5")
    log.end = lambda tracer: log.close()
    for _ in Tracer(Circle(), observers=(log,)):
        pass
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.path(0).status is Status.TRACING
        assert len(archive.path(0)) == len(path)
    recover(tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.path(0).status is Status.INTERRUPTED
    assert_same_path(resume(tmp_path / "run.h5"), path)
