"""Kinks in archives: their switches and rays come back, and windows of rows do not tear them apart."""

import attrs
import numpy as np

from continuation import Budget, Kind, LocatedEvent, Status, Tracer
from continuation.archive import Limits, PathLog, open_archive
from continuation.archive.schema import KINK_PART


@attrs.frozen
class Line:
    """Straight, with a switch that nobody looks at here."""

    target: None = None

    def start(self):
        return np.zeros(1), 0.0

    def residual(self, y, lam):
        return y - lam

    def switches(self, y, lam):
        return y + 1.0

    def piece(self, signs):
        return self


def kink_at(step, rays):
    """A kink on the step."""
    return LocatedEvent(
        "kink", Kind.KINK, step.arclength, step.u, step.tangent, 0.0, 0.0, 1, step.index, True, (3, 5), np.array(rays)
    )


def written(file, keep="all", steps=6):
    """A path whose every other step is said to be a kink: the tracer, its file closed."""
    rays = [[-0.6, -0.8], [1.0, 0.0], [0.0, 1.0]]

    class Said(PathLog):
        def step(self, tracer, step):
            if step.index % 2:
                step = tracer.path.steps[step.index] if keep == "all" else step
                event = kink_at(step, rays[: 1 + step.index % 3])
                tracer.path.events.append(event)
                step = attrs.evolve(step, kind=Kind.KINK)
            super().step(tracer, step)

    tracer = Tracer(
        Line(), observers=(Said(file, keep=keep, limits=Limits(rows=4, seconds=3600.0)),), budget=Budget(steps=steps)
    )
    for _ in tracer:
        pass
    return tracer


def test_switches_and_rays_come_back(tmp_path):
    tracer = written(tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        path = archive.path(0)
        assert archive.points.size == 7 + 3 * 2 + 1
        kinks = (archive.points["kind"] == Kind.KINK) & (archive.points["role"] != KINK_PART)
        assert kinks.sum() == 3
        ends = archive.path(0, keep="ends")
    for found in (path, ends):
        assert [len(found), len(found.kinks)] == [7, 3]
        assert [event.switches for event in found.kinks] == [(3, 5)] * 3
        assert [len(event.rays) for event in found.kinks] == [2, 1, 3]
        for event, told in zip(found.kinks, tracer.path.kinks):
            assert np.array_equal(event.rays, told.rays)
            assert (event.ends_step, event.step) == (True, told.step)
    assert np.array_equal(np.array([step.u for step in ends.steps]), tracer.path.u)
    assert path.status is Status.BUDGET_EXHAUSTED


def test_windows_do_not_tear_a_kink_apart(tmp_path, monkeypatch):
    written(tmp_path / "run.h5", steps=12)
    monkeypatch.setattr("continuation.archive.reader.ROWS_AT_ONCE", 3)
    with open_archive(tmp_path / "run.h5") as archive:
        whole, ends = archive.path(0), archive.path(0, keep="ends")
        assert [len(event.rays) for event in ends.events] == [len(event.rays) for event in whole.events]
        assert np.array_equal(ends.u, whole.u)


def test_the_curve_leaves_a_kink_along_its_second_ray(tmp_path):
    written(tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        path = archive.path(0)
    after = path.steps[2].segment
    assert len(path.kinks[0].rays) == 2
    assert abs(after.derivative(0.0)[1]) < 1e-15
