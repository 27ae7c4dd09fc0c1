"""Sweeps: the paths in order, wherever they are traced; what ends badly costs its own path."""

import concurrent.futures
import os
import signal
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext
from functools import partial
from unittest.mock import Mock

import attrs
import numpy as np
import pytest

from continuation import Status, trace
from continuation.archive import describe, open_archive, trace_many
from problems.bifurcation import Cusp

from ...util import interrupt

GOOD = [Cusp(splitting) for splitting in np.linspace(0.5, 2.0, 5)]
POOLS = {
    "serial": nullcontext,
    "thread": partial(ThreadPoolExecutor, 1),
    "threads": partial(ThreadPoolExecutor, 2),
    "processes": partial(ProcessPoolExecutor, 2),
}


@attrs.frozen
class Bad(Cusp):
    """Does something in the middle of its path."""

    act: Callable = None

    def residual(self, y, lam):
        if lam > 0.0:
            self.act()
        return super().residual(y, lam)


class Unsendable(Cusp):
    def __reduce__(self):
        raise TypeError("it holds a socket")


class NoText(Exception):
    def __str__(self):
        raise ValueError("no text")


class Wide:
    """Five unknowns where the others have one."""

    target = 1.0

    def start(self):
        return np.zeros(5), 0.0

    def residual(self, y, lam):
        return y - lam


class Broken(Wide):
    """Cannot even begin."""

    def start(self):
        raise RuntimeError("no start")


def raises(kind, *arguments):
    raise kind(*arguments)


def same(found, path):
    return np.array_equal(found.u, path.u) and (found.status, found.counts) == (path.status, path.counts)


@pytest.fixture(scope="module")
def expected():
    return [trace(homotopy) for homotopy in GOOD]


@pytest.mark.parametrize(
    ("archived", "link"),
    [(False, os.link), (True, os.link), (True, Mock(side_effect=PermissionError(1, "no links here")))],
)
@pytest.mark.parametrize("pool", POOLS)
def test_order_is_that_of_the_homotopies(tmp_path, monkeypatch, expected, pool, archived, link):
    monkeypatch.setattr(os, "link", link)
    calls, file = [], tmp_path / "run.h5" if archived else None
    with POOLS[pool]() as executor:
        paths = trace_many(GOOD, executor, file, progress=lambda done, total: calls.append((done, total)))
    assert [same(*pair) for pair in zip(paths, expected, strict=True)] == [True] * 5
    assert calls[-1] == (5, 5)
    assert calls == [(done, 5) for done in range(6)][-len(calls) :]
    if archived:
        assert paths.paths["member"].tolist() == list(range(5))
        assert paths.paths["homotopy_splitting"].tolist() == [homotopy.splitting for homotopy in GOOD]
        sources = [source.split() for source in paths.paths["source"]]
        assert sorted((int(number), name) for _, number, name in sources) == [(k, b"run.h5") for k in range(5)]
        paths.close()
        assert os.listdir(tmp_path) == ["run.h5"]


def patient(futures, timeout=None, return_when=concurrent.futures.ALL_COMPLETED):
    """`wait`, whose time is up when no other path is on its way: no clock decides which one hangs."""
    alone = timeout is not None and len(futures) == 1
    return concurrent.futures.wait(futures, timeout=0.0 if alone else None, return_when=return_when)


ANYWHERE = {
    "exits": (Bad(1.0, act=partial(sys.exit, "enough")), "SystemExit: enough"),
    "raises": (Bad(1.0, act=partial(raises, RuntimeError, "gone")), "RuntimeError: gone"),
    "raises what is no Exception": (Bad(1.0, act=partial(raises, GeneratorExit)), "GeneratorExit"),
    "raises what has no text": (Bad(1.0, act=partial(raises, NoText)), "NoText: its text cannot be had (ValueError)"),
    "does not begin": (Broken(), "RuntimeError: no start"),
}
IN_PROCESSES = {
    **ANYWHERE,
    "ends its process": (Bad(1.0, act=partial(os._exit, 3)), "BrokenProcessPool: "),
    "kills its process": (Bad(1.0, act=partial(signal.raise_signal, signal.SIGKILL)), "BrokenProcessPool: "),
    "hangs": (Bad(1.0, act=partial(time.sleep, 1000.0)), "TimeoutError: took longer than 6 s"),
    "cannot be sent": (Unsendable(1.0), "TypeError: it holds a socket"),
}
CASES = [*(("serial", what) for what in ANYWHERE), *(("processes", what) for what in IN_PROCESSES)]


@pytest.mark.parametrize("archived", [False, True])
@pytest.mark.parametrize(("pool", "what"), CASES)
def test_what_ends_badly_costs_its_own_path(tmp_path, monkeypatch, expected, pool, what, archived):
    monkeypatch.setattr("continuation.archive.sweep.wait", patient)
    bad, message = IN_PROCESSES[what]
    with POOLS[pool]() as executor:
        timeout, file = 6.0 if what == "hangs" else None, tmp_path / "run.h5" if archived else None
        paths = trace_many([*GOOD[:2], bad, *GOOD[2:]], executor, file, timeout=timeout)
    assert paths[2].status is Status.RAISED
    assert paths[2].message.startswith(message)
    assert [same(*pair) for pair in zip([*paths[:2], *paths[3:]], expected, strict=True)] == [True] * 5
    if archived:
        assert paths.paths["member"].tolist() == list(range(6))
        page = describe(paths)
        assert f"path 2 (member 2): {message}" in page
        assert "can be resumed" not in page
        paths.close()
        assert os.listdir(tmp_path) == ["run.h5"]


MIXED = {
    "in the middle": [*GOOD[:2], Wide(), GOOD[2], Wide(), GOOD[3]],
    "first": [Wide(), GOOD[0], Wide(), GOOD[1]],
    "behind one that cannot begin": [Broken(), Wide(), *GOOD[:2], Wide()],
}


@pytest.mark.parametrize("pool", ["processes", "threads"])
@pytest.mark.parametrize("tasks", MIXED)
def test_a_homotopy_of_another_size_costs_its_own_path_wherever_it_runs(tmp_path, tasks, pool):
    def said(executor, file):
        with trace_many(MIXED[tasks], executor, file) as paths:
            ends = [path.endpoint.u.tolist() if len(path) else [] for path in paths]
            reasons = [path.message.split(" unknowns")[0] for path in paths]
            return [path.status for path in paths], ends, paths.paths["member"].tolist(), reasons

    serial = said(None, tmp_path / "serial.h5")
    with POOLS[pool]() as executor:
        assert said(executor, tmp_path / "spread.h5") == serial
    assert {Status.RAISED, Status.REACHED_TARGET} == set(serial[0])
    assert sorted(os.listdir(tmp_path)) == ["serial.h5", "spread.h5"]


def test_what_cannot_be_swept_is_refused_and_nothing_may_be_swept(tmp_path):
    assert trace_many([]) == []
    with POOLS["threads"]() as executor, pytest.raises(ValueError, match="homotopies: expected at least one where"):
        trace_many([], executor, tmp_path / "none.h5")
    with pytest.raises(TypeError, match=r"predicter: expected one of the options box, .*; did you mean predictor\?"):
        trace_many(GOOD, archive=tmp_path / "run.h5", predicter=None)
    assert not os.listdir(tmp_path)


@pytest.mark.parametrize(
    ("pool", "tasks", "after", "kept"),
    [
        ("serial", GOOD, 3, [0, 1, 2]),
        ("thread", GOOD, 1, None),
        ("processes", [*GOOD[:3], *2 * [Bad(1.0, act=partial(time.sleep, 1000.0))]], 3, [0, 1, 2]),
    ],
)
def test_ctrl_c_keeps_what_is_finished(tmp_path, expected, pool, tasks, after, kept):
    """In a pool that hangs, too: the limit here is generous, and far from the thousand seconds that are asked for."""

    def stop(done, total):
        if done >= after:
            interrupt()

    begin = time.monotonic()
    with POOLS[pool]() as executor, pytest.raises(KeyboardInterrupt):
        trace_many(tasks, executor, tmp_path / "run.h5", progress=stop)
    assert time.monotonic() - begin < 300.0
    with open_archive(tmp_path / "run.h5") as archive:
        members = archive.paths["member"].tolist()
        assert members == kept or (kept is None and 0 < len(members) <= 5 and members == sorted(members))
        assert all(same(path, expected[member]) for path, member in zip(archive, members))
    assert os.listdir(tmp_path) == ["run.h5"]


def test_ctrl_c_within_a_path(tmp_path):
    with pytest.raises(KeyboardInterrupt):
        trace_many(2 * [Bad(1.0, act=partial(raises, KeyboardInterrupt))], archive=tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        assert [path.status for path in archive] == [Status.INTERRUPTED]
