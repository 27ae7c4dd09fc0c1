"""Sweeps whose homotopies exit, hang, die or cannot be sent: each costs its own path."""

import concurrent.futures
import os
import signal
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

from continuation import Status, trace
from continuation.archive import open_archive, trace_many
from problems.bifurcation import Cusp

GOOD = [Cusp(splitting) for splitting in np.linspace(0.5, 2.0, 5)]


class Fatal(Cusp):
    """Does something to its process in the middle of the path."""

    def residual(self, y, lam):
        if lam > 0.0:
            self.act()
        return super().residual(y, lam)


class Exits(Fatal):
    def act(self):
        sys.exit("enough")


class ExitsAtOnce(Fatal):
    def act(self):
        os._exit(3)


class Dies(Fatal):
    def act(self):
        os.kill(os.getpid(), signal.SIGKILL)


class Hangs(Fatal):
    def act(self):
        time.sleep(1000.0)


class Unsendable(Cusp):
    def __reduce__(self):
        raise TypeError("it holds a socket")


@pytest.fixture(scope="module")
def expected():
    return [trace(homotopy) for homotopy in GOOD]


MESSAGES = {
    Exits: "SystemExit: enough",
    ExitsAtOnce: "BrokenProcessPool: ",
    Dies: "BrokenProcessPool: ",
    Hangs: "TimeoutError: took longer than 6 s",
    Unsendable: "TypeError: it holds a socket",
}


def patient(futures, timeout=None, return_when=concurrent.futures.ALL_COMPLETED):
    """`wait`, whose time is up when no other path is on its way: no clock decides which one hangs."""
    if timeout is None or len(futures) > 1:
        return concurrent.futures.wait(futures, return_when=return_when)
    return concurrent.futures.wait(futures, timeout=0.0, return_when=return_when)


@pytest.mark.parametrize("bad", MESSAGES)
@pytest.mark.parametrize("archived", [False, True])
def test_it_costs_its_own_path(tmp_path, monkeypatch, expected, bad, archived):
    monkeypatch.setattr("continuation.archive.sweep.wait", patient)
    tasks, file = [*GOOD[:2], bad(1.0), *GOOD[2:]], tmp_path / "run.h5"
    with ProcessPoolExecutor(2) as executor:
        timeout = 6.0 if bad is Hangs else None
        paths = trace_many(tasks, executor, file if archived else None, timeout=timeout)
    assert len(paths) == 6
    assert paths[2].status is Status.RAISED
    assert paths[2].message.startswith(MESSAGES[bad])
    for found, path in zip([*paths[:2], *paths[3:]], expected):
        assert np.array_equal(found.u, path.u)
        assert found.status is path.status
    if archived:
        assert paths.paths["member"].tolist() == list(range(6))
        paths.close()
        assert os.listdir(tmp_path) == ["run.h5"]


def test_ctrl_c_ends_a_sweep_that_hangs(tmp_path):
    """Within a second or so; the limit here is generous, and far from the thousand seconds that are asked for."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)

    def stop(done, total):
        if done == 3:
            signal.raise_signal(signal.SIGINT)

    begin = time.monotonic()
    try:
        with ProcessPoolExecutor(2) as executor, pytest.raises(KeyboardInterrupt):
            trace_many([*GOOD[:3], Hangs(1.0), Hangs(1.0)], executor, tmp_path / "run.h5", progress=stop)
    finally:
        signal.signal(signal.SIGINT, before)
    assert time.monotonic() - begin < 300.0
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.paths["member"].tolist() == [0, 1, 2]


def test_what_another_sweep_left_is_in_nobodys_way(tmp_path, expected):
    for name in ("run.h5.stop", "run.0001.h5", "run.sweep-00000000.0001.h5", "run.sweep-00000000.stop"):
        (tmp_path / name).write_bytes(b"left behind")
    with ThreadPoolExecutor(2) as executor, trace_many(GOOD, executor, tmp_path / "run.h5") as paths:
        assert [len(path) for path in paths] == [len(path) for path in expected]
    assert (tmp_path / "run.0001.h5").read_bytes() == b"left behind"
