"""A resumed path is bit for bit the uninterrupted one, for every part, interrupted at every step in turn."""

import math
from itertools import pairwise

import attrs
import numpy as np
import pytest

import continuation
from continuation import Budget, Monitor, Status, TargetValue, Tracer, trace
from continuation.archive import ArchiveError, PathLog, open_archive, recover, resume
from continuation.archive.provenance import Checkpoint, describe_run, pack, unpack
from continuation.metric import Relative
from problems.bifurcation import Circle, ExponentialCosine, FreudensteinRoth

from ...util import path_of
from .util import assert_same, interrupted, observer, read

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


def recording():
    """An observer; the states that it sees along a path, and these as an archive holds them."""
    states, checkpoints = [], []

    def step(tracer, step):
        if step.index == tracer.state.index:
            checkpoint = Checkpoint(1, 0, 1, tracer.state, tracer.counts.as_dict(), 0.0, describe_run(tracer))
            states.append(tracer.state)
            checkpoints.append(unpack(pack(checkpoint)))

    return observer(step=step), states, checkpoints


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("options", OPTIONS, ids=name)
def test_each_state_leads_to_the_next_exactly(problem, options):
    """By induction from here on: the state that an archive holds gives the next state, bit for bit, at every step."""
    homotopy, (watching, states, checkpoints) = PROBLEMS[problem], recording()
    options = {"budget": Budget(steps=20), **options}
    path = trace(homotopy, observers=(watching,), **options)
    assert len(states) > 3 or path.status is not Status.REACHED_TARGET
    for (before, after), checkpoint in zip(pairwise(states), checkpoints):
        np.testing.assert_equal(attrs.astuple(checkpoint.state), attrs.astuple(before))
        watching, again, _ = recording()
        steps = iter(Tracer(homotopy, state=checkpoint.state, observers=(watching,), **options))
        next(steps, None)
        steps.close()
        np.testing.assert_equal(attrs.astuple(again[0]), attrs.astuple(after))


def test_resumed_again_and_again(tmp_path):
    """One more step at a time: many links, and still the same path."""
    path = trace(FreudensteinRoth(), archive=tmp_path / "whole.h5")
    trace(FreudensteinRoth(), archive=tmp_path / "run.h5", budget=Budget(steps=1))
    for steps in range(2, len(path)):
        found = resume(tmp_path / "run.h5", budget=Budget(steps=steps))
    assert_same(found, path)
    with open_archive(tmp_path / "run.h5") as archive, open_archive(tmp_path / "whole.h5") as whole:
        assert archive.attributes["history"].count("resumed") == len(path) - 2
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
    path = path_of(FreudensteinRoth(), **options, status=Status.STOPPED_AT_EVENT)
    interrupted(tmp_path / "run.h5", FreudensteinRoth(), len(path) - 3, **options)
    assert_same(resume(tmp_path / "run.h5"), path)


def test_resume_into_another_file_leaves_the_first(tmp_path):
    interrupted(tmp_path / "run.h5", FreudensteinRoth(), 7)
    before = (tmp_path / "run.h5").read_bytes()
    resume(tmp_path / "run.h5", archive=tmp_path / "more.h5")
    assert (tmp_path / "run.h5").read_bytes() == before
    assert_same(read(tmp_path / "more.h5"), trace(FreudensteinRoth()))
    with open_archive(tmp_path / "more.h5") as archive:
        assert archive.attributes["parent"].startswith("run.h5 (")


def test_the_last_of_many_paths(tmp_path):
    with PathLog(tmp_path / "run.h5") as log:
        first = trace(ExponentialCosine(3), archive=log)
        trace(ExponentialCosine(3, target=0.5), archive=log, budget=Budget(steps=2))
    found = resume(tmp_path / "run.h5", budget=Budget())
    assert_same(found, trace(ExponentialCosine(3, target=0.5)))
    with open_archive(tmp_path / "run.h5") as archive:
        assert_same(archive.path(0), first)
        assert_same(archive.path(1), found)
        assert archive.paths["member"].tolist() == [0, 1]


class Stateful:
    """The smallest plug-in with a constructor: nothing tells an archive how to make it again."""

    target = 1.0

    def __init__(self, slope):
        self.slope = slope

    def start(self):
        return np.zeros(1), 0.0

    def residual(self, y, lam):
        return y - self.slope * lam**2


def test_a_homotopy_that_cannot_be_stored_is_asked_for(tmp_path):
    interrupted(tmp_path / "run.h5", Stateful(2.0), 2)
    with pytest.raises(ArchiveError, match=r"Stateful has neither archive_data nor attrs fields\); pass homotopy="):
        resume(tmp_path / "run.h5")
    with pytest.raises(ValueError, match="homotopy: expected the archive's residual"):
        resume(tmp_path / "run.h5", Stateful(5.0))
    with pytest.raises(ValueError, match="homotopy: expected 1 unknowns"):
        resume(tmp_path / "run.h5", FreudensteinRoth())
    assert_same(resume(tmp_path / "run.h5", Stateful(2.0)), trace(Stateful(2.0)))


def test_a_monitor_that_cannot_be_stored_is_asked_for(tmp_path):
    events = [Monitor(lambda u, v: u[0] - 20.0)]
    interrupted(tmp_path / "run.h5", FreudensteinRoth(), 5, events=events)
    with pytest.raises(ArchiveError, match=r"events cannot be made from the file.*lambda.*pass events="):
        resume(tmp_path / "run.h5")
    assert_same(resume(tmp_path / "run.h5", events=events), trace(FreudensteinRoth(), events=events))


class Telling(Stateful):
    """With the capability, events of its own, and an exception in the middle of the path."""

    events = (TargetValue(0.7, component=0, terminal=0),)
    calls_left = math.inf

    def archive_data(self):
        return {"slope": np.array(self.slope), "note": "a parabola"}

    @classmethod
    def from_archive(cls, data):
        return cls(float(data["slope"]))

    def residual(self, y, lam):
        self.calls_left -= 1
        if self.calls_left < 0:
            raise RuntimeError("the licence server is down")
        return super().residual(y, lam)


def test_an_exception_of_a_homotopy_that_says_what_to_store_is_an_interruption(tmp_path):
    homotopy, file, events = Telling(2.0), tmp_path / "run.h5", [TargetValue(0.2, terminal=0)]
    homotopy.calls_left = trace(Telling(2.0)).counts.residuals // 2
    with pytest.raises(RuntimeError, match="licence"):
        trace(homotopy, archive=file, events=events)
    with pytest.raises(ArchiveError, match=r"Telling is not registered: pass it in trust=.*pass homotopy="):
        resume(file)
    path = trace(Telling(2.0), events=events)
    assert len(path.events) == 2
    assert_same(resume(file, trust=[Telling]), path)


def test_the_end_itself_is_decided_again(tmp_path):
    """A writer killed between the last point and the decision that it is the last."""
    path, file = trace(Circle()), tmp_path / "run.h5"
    log = PathLog(file)
    log.end = lambda tracer: log.close()
    trace(Circle(), observers=(log,))
    assert (read(file).status, len(read(file))) == (Status.TRACING, len(path))
    recover(file)
    assert read(file).status is Status.INTERRUPTED
    assert_same(resume(file), path)
