"""Many paths: sweeps, merging, export, and the page."""

import csv
import gzip
import os
import signal
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from threading import Event

import numpy as np
import pytest
import xarray

from continuation import Budget, Status, from_functions, trace
from continuation.archive import ArchiveError, PathLog, describe, export, merge, open_archive, trace_many
from continuation.archive.sweep import Task, traced
from problems.bifurcation import Bratu1D, Circle, ExponentialCosine, FreudensteinRoth, Pitchfork

HOMOTOPIES = [Pitchfork(epsilon) for epsilon in np.linspace(0.01, 0.4, 11)]


class Broken:
    """Cannot even begin."""

    def start(self):
        raise RuntimeError("no start")

    def residual(self, y, lam):
        return y


class Breaking(Pitchfork):
    """Goes wrong on the way."""

    def residual(self, y, lam):
        if lam > 0.0:
            raise RuntimeError("gone")
        return super().residual(y, lam)


class Deadly:
    """Takes its process with it."""

    def start(self):
        os.kill(os.getpid(), signal.SIGKILL)

    def residual(self, y, lam):
        return y


def check(paths, expected):
    assert len(paths) == len(expected)
    for found, path in zip(paths, expected):
        assert np.array_equal(found.u, path.u)
        assert (found.status, found.counts) == (path.status, path.counts)


@pytest.fixture(scope="module")
def expected():
    return [trace(homotopy) for homotopy in HOMOTOPIES]


def executors():
    return [lambda: None, lambda: ThreadPoolExecutor(1), lambda: ProcessPoolExecutor(2)]


@pytest.mark.parametrize("make", executors(), ids=["serial", "thread", "processes"])
@pytest.mark.parametrize("archived", [False, True])
def test_order_is_that_of_the_homotopies(tmp_path, expected, make, archived):
    executor, calls = make(), []
    file = tmp_path / "run.h5" if archived else None
    paths = trace_many(HOMOTOPIES, executor, file, progress=lambda done, total: calls.append((done, total)))
    check(paths, expected)
    assert calls == sorted(calls)
    assert calls[-1] == (11, 11)
    if archived:
        assert [entry.name for entry in tmp_path.iterdir()] == ["run.h5"]
        assert paths.paths["member"].tolist() == list(range(11))
        assert np.array_equal(paths.paths["homotopy_imperfection"], [h.imperfection for h in HOMOTOPIES])
        paths.close()
    if executor is not None:
        executor.shutdown()


@pytest.mark.parametrize("archived", [False, True])
def test_failures_are_kept(tmp_path, expected, archived):
    homotopies = [Broken(), *HOMOTOPIES[:3], Breaking(0.3), *HOMOTOPIES[3:5], Broken()]
    paths = trace_many(homotopies, archive=tmp_path / "run.h5" if archived else None)
    check([paths[i] for i in (1, 2, 3, 5, 6)], expected[:5])
    for i, text in ((0, "RuntimeError: no start"), (4, "RuntimeError: gone"), (7, "RuntimeError: no start")):
        assert (paths[i].status, paths[i].message) == (Status.RAISED, text)
    assert len(paths[4]) > 1
    if archived:
        page = describe(paths)
        assert "path 4 (member 4): RuntimeError: gone" in page
        assert "can be resumed" not in page
        paths.close()


def test_a_worker_that_dies_costs_its_own_paths_only(tmp_path):
    with ProcessPoolExecutor(1) as executor:
        paths = trace_many([*HOMOTOPIES[:3], Deadly()], executor, tmp_path / "run.h5")
    with paths:
        assert paths.paths["member"].tolist() == [0, 1, 2, 3]
        assert paths[3].message.startswith("BrokenProcessPool")
        check([paths[0]], [trace(HOMOTOPIES[0])])
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.h5"]


def test_ctrl_c_keeps_what_is_finished(tmp_path, expected):
    def stop(done, total):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        trace_many(HOMOTOPIES, archive=tmp_path / "serial.h5", progress=stop)
    with open_archive(tmp_path / "serial.h5") as archive:
        check(archive, expected[:4])
    # To this thread: a signal to the process may reach another one first, and be noticed here when all is done.
    # With Python's own handler, since a shell starts what runs in its background with the signal ignored.
    before, file = signal.signal(signal.SIGINT, signal.default_int_handler), tmp_path / "pool.h5"
    try:
        with ThreadPoolExecutor(1) as executor, pytest.raises(KeyboardInterrupt):
            trace_many(HOMOTOPIES, executor, file, progress=lambda *_: signal.raise_signal(signal.SIGINT))
    finally:
        signal.signal(signal.SIGINT, before)
    with open_archive(file) as archive:
        members = archive.paths["member"].tolist()
        assert 0 < len(members) <= 11
        assert members == sorted(members)
        check(archive, [expected[member] for member in members])
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["pool.h5", "serial.h5"]


def test_misspelt_options_are_refused_at_the_door(tmp_path):
    said = r"predicter: expected one of the options box, budget, .*; did you mean predictor\?"
    with pytest.raises(TypeError, match=said):
        trace_many(HOMOTOPIES, archive=tmp_path / "run.h5", predicter=None)
    assert not list(tmp_path.iterdir())


def test_merge(tmp_path):
    files = [tmp_path / f"{i}.h5" for i in range(3)]
    paths = [
        trace(FreudensteinRoth(), archive=files[0]),
        trace(FreudensteinRoth(), archive=PathLog(files[1], tangents=True), budget=Budget(steps=7)),
        trace(ExponentialCosine(2), archive=files[2]),
    ]
    with open_archive(merge(files, tmp_path / "all.h5")) as archive:
        check(archive, paths)
        assert "merged from 3 files: 0.h5, 1.h5, 2.h5" in archive.attributes["history"]
        assert np.array_equal(archive.paths["homotopy_n"], [np.nan, np.nan, 2.0], equal_nan=True)
        assert np.array_equal(archive[1].tangents, paths[1].tangents)
        assert archive[0].events[1].name == "turning point"
    trace(Circle(), archive=tmp_path / "circle.h5")
    with pytest.raises(ArchiveError, match=r"circle.h5: holds paths of 1 unknowns, .*0.h5 of 2; one file holds one"):
        merge([files[0], tmp_path / "circle.h5"], tmp_path / "bad.h5")


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_export_to_netcdf(tmp_path, engine):
    trace(Bratu1D(40), archive=tmp_path / "run.h5", budget=Budget(steps=20))
    (target,) = export(tmp_path / "run.h5", tmp_path / "run.nc", compression=9)
    with (
        xarray.open_dataset(tmp_path / "run.h5", engine=engine) as first,
        xarray.open_dataset(target, engine=engine) as second,
    ):
        assert first.drop_attrs(deep=False).identical(second.drop_attrs(deep=False))
        assert second.y.encoding.get("complevel", second.y.encoding.get("compression_opts")) == 9
        assert "exported from run.h5" in second.attrs["history"]


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_export_to_text(tmp_path, suffix):
    path = trace(FreudensteinRoth(), archive=tmp_path / "run.h5")
    points, paths = export(tmp_path / "run.h5", tmp_path / f"run{suffix}")
    assert paths.name == f"run.paths{suffix}"
    read = gzip.open if suffix.endswith("gz") else open
    with read(points, "rt", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["role"] == "0"]
    assert [float(row["y_1"]) for row in rows] == path.y[:, 1].tolist()
    assert [float(row["arclength"]) for row in rows] == path.arclength.tolist()
    with read(paths, "rt", newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["message"], int(row["solves"])) == (path.message, path.counts.solves)


def test_the_page(tmp_path):
    path = trace(FreudensteinRoth(), archive=PathLog(tmp_path / "run.h5", title="A classic"))
    with open_archive(tmp_path / "run.h5") as archive:
        page = describe(archive)
    for text in (
        "A classic",
        "FreudensteinRoth",
        "Hermite()",
        "AllgowerGeorg(",
        "REACHED_TARGET",
        path.message,
        "0.5875873254",
        "-0.6863527575",
        f"{path.counts.solves} solves",
        "Python 3.",
    ):
        assert text in page
    trace(FreudensteinRoth(), archive=tmp_path / "short.h5", budget=Budget(steps=3))
    with open_archive(tmp_path / "short.h5") as archive:
        assert "can be resumed with more steps: `continuation resume" in describe(archive)


class Wide:
    """Five unknowns where the others have one."""

    target = 1.0

    def start(self):
        return np.zeros(5), 0.0

    def residual(self, y, lam):
        return y - lam


class Leaving(Pitchfork):
    """Raises what is no Exception."""

    def residual(self, y, lam):
        if lam > 0.0:
            raise GeneratorExit
        return super().residual(y, lam)


class Speechless(Pitchfork):
    """Raises what cannot say what it is."""

    def residual(self, y, lam):
        if lam > 0.0:
            raise NoText
        return super().residual(y, lam)


class NoText(Exception):
    def __str__(self):
        raise ValueError("no text")


MIXED = {
    "in the middle": lambda: [Pitchfork(0.1), Pitchfork(0.2), Wide(), Pitchfork(0.3), Wide(), Pitchfork(0.4)],
    "first": lambda: [Wide(), Pitchfork(0.1), Wide(), Pitchfork(0.2)],
    "behind one that cannot begin": lambda: [Broken(), Wide(), Pitchfork(0.1), Pitchfork(0.2), Wide()],
    "with others that end badly": lambda: [Pitchfork(0.1), Leaving(0.1), Wide(), Speechless(0.1), Pitchfork(0.2)],
}


@pytest.mark.parametrize("pool", [ProcessPoolExecutor, ThreadPoolExecutor], ids=["processes", "threads"])
@pytest.mark.parametrize("tasks", MIXED)
def test_a_homotopy_of_another_size_costs_its_own_path_wherever_it_runs(tmp_path, tasks, pool):
    def said(archive):
        with archive:
            paths = list(archive)
            ends = [path.endpoint.u.tolist() if len(path) else [] for path in paths]
            reasons = [path.message.split(" unknowns")[0] for path in paths]
            return [path.status for path in paths], ends, archive.paths["member"].tolist(), reasons

    serial = said(trace_many(MIXED[tasks](), archive=tmp_path / "serial.h5"))
    with pool(2) as executor:
        spread = said(trace_many(MIXED[tasks](), executor, tmp_path / "spread.h5"))
    assert spread == serial
    assert Status.RAISED in serial[0]
    assert Status.REACHED_TARGET in serial[0]
    assert sorted(os.listdir(tmp_path)) == ["serial.h5", "spread.h5"]


def test_no_homotopies(tmp_path):
    assert trace_many([]) == []
    with ThreadPoolExecutor(1) as executor:
        for pool in (None, executor):
            with pytest.raises(ValueError, match="homotopies: expected at least one where there is an archive"):
                trace_many([], pool, tmp_path / "none.h5")
    assert not os.listdir(tmp_path)


def test_what_ends_badly_is_said():
    paths = trace_many([Leaving(0.1), Speechless(0.1), Pitchfork(0.1)])
    assert [path.status for path in paths] == [Status.RAISED, Status.RAISED, Status.REACHED_TARGET]
    assert paths[0].message.startswith("GeneratorExit")
    assert paths[1].message == "NoText: its text cannot be had (ValueError)"


def test_ctrl_c_within_a_path(tmp_path):
    def residual(y, lam):
        if lam > 0.5:
            raise KeyboardInterrupt
        return y - lam

    stopping = from_functions(residual, start=(np.zeros(1), 0.0), target=1.0)
    with pytest.raises(KeyboardInterrupt):
        trace_many([stopping, stopping], archive=tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        assert len(archive) == 1
        assert archive[0].status is Status.INTERRUPTED


def test_an_export_says_who_traced(tmp_path, monkeypatch):
    trace(Circle(), archive=tmp_path / "a.h5")
    monkeypatch.setattr("continuation.archive.provenance.software", lambda: {"host": "another"})
    export(tmp_path / "a.h5", tmp_path / "b.nc")
    with open_archive(tmp_path / "a.h5") as traced, open_archive(tmp_path / "b.nc") as copy:
        assert copy.attributes["host"] == traced.attributes["host"] != "another"
        assert copy.status(-1) is copy.status(0) is Status.CLOSED
        with pytest.raises(IndexError):
            copy.status(1)


def test_ctrl_c_ends_the_paths_of_threads():
    """Which an interrupt does not reach: a task that is told to stop ends at its next step."""
    stop = Event()
    stop.set()
    assert traced(Task(Circle(), 0, False, {}, stop)).status is Status.INTERRUPTED
    assert traced(Task(Circle(), 0, False, {}, Event())).status is Status.CLOSED
