"""What one file may ask for, what is recovered of one that is cut off, and contents that make no sense."""

import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest

from continuation import Budget, trace
from continuation.archive import ArchiveError, open_archive, recover
from continuation.archive.hdf5 import LEAST_BYTES
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import Cusp

from .test_archive_hostile import claimed, resealed
from .util import OPERATIONS, killed, logged, outcome

MOST_BYTES = 500 << 20


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    file = tmp_path_factory.mktemp("small") / "small.h5"
    trace(Cusp(), archive=file, budget=Budget(steps=6))
    return file


@pytest.fixture
def changed(tmp_path, small):
    """A copy in which something is changed."""

    def make(change):
        file = shutil.copy(small, tmp_path / "changed.h5")
        with h5py.File(file, "r+") as opened:
            change(opened)
        return file

    return make


# -- one budget -----------------------------------------------------------------------------------------------


def zeros(file, name, shape, kind="f8"):
    del file[name]
    chunks = (min(shape[0], 1 << 15), *(min(n, 1 << 15) for n in shape[1:]))
    file.create_dataset(name, shape, kind, chunks=chunks, compression="gzip")


def many_rows(file):
    for name in [name for name in file if getattr(file[name], "shape", ())[:1] == (7,) and name != "point"]:
        zeros(file, name, (1_000_000, *file[name].shape[1:]), file[name].dtype)
    file["n_points"][0] = 1_000_000
    resealed(file, points=1_000_000)


BOMBS = {
    "a wide state": lambda file: zeros(file, "controller_state", (1, 30_000_000)),
    "many unknowns": lambda file: [zeros(file, name, (7, 4_000_000)) for name in ("y", "tangent_y")],
    "many rows": many_rows,
    "a large problem": lambda file: file["problem"].create_dataset("A", (10**4, 10**4), "f8", compression="gzip"),
    "many names of events": lambda file: (file["event_name"].resize((10**7,)), claimed(file, names=10**7)),
}
READ = ("describe", "read", "export", "resume")


@pytest.mark.parametrize("bomb", BOMBS)
def test_a_small_file_takes_no_more_than_it_may(changed, bomb):
    file = changed(BOMBS[bomb])
    assert file.stat().st_size < LEAST_BYTES // 100
    complaints = [outcome(OPERATIONS[name], file)[0] for name in READ]
    assert any(complaints)
    assert "\n" not in "".join(complaints)
    code = (
        "import sys\nfrom pathlib import Path\n"
        "from tests.continuation.archive.test_archive_limits import OPERATIONS, READ, outcome\n"
        "for name in READ: outcome(OPERATIONS[name], Path(sys.argv[1]))\n"
        "print(*Path('/proc/self/status').read_text().partition('VmHWM:')[2].split()[:1])"
    )
    for left in (".csv", ".paths.csv", ".more.h5"):
        file.with_suffix(left).unlink(missing_ok=True)
    done = subprocess.run([sys.executable, "-c", code, file], capture_output=True, text=True, check=True)
    if not done.stdout.strip():
        pytest.skip("this kernel does not tell how much memory was held")
    assert int(done.stdout) << 10 < MOST_BYTES


def test_the_caller_may_allow_more_or_less(changed):
    file = changed(BOMBS["a wide state"])
    with pytest.raises(ArchiveError, match=r"more than the limit of 100; say limit=$"):
        open_archive(file, limit=100)
    with pytest.raises(ArchiveError, match=f"of paths claims .* more than the limit of {LEAST_BYTES}; say limit=$"):
        open_archive(file)
    assert len(open_archive(file, limit=1 << 29)) == 1


# -- files that are cut off -----------------------------------------------------------------------------------


HEAD = 45_000
SHARES = (0.3, 0.5, 0.7, 0.9, 0.99, 0.999)
LONG = {"controller": Fixed(bounds=Bounds(initial=0.005)), "budget": Budget(steps=1500), "target": None}


@pytest.fixture(scope="module", params=["closed", "killed"])
def long(request, tmp_path_factory):
    file = tmp_path_factory.mktemp("long") / "long.h5"
    if request.param == "killed":
        return killed(file, Cusp(), 1499, 50, **LONG)
    trace(Cusp(), archive=logged(file, 50), **LONG)
    return file


def test_whole_blocks_before_the_cut_are_recovered(tmp_path, long):
    with open_archive(long) as archive:
        whole, path = archive.points.size, archive.path(0)
    size, kept = long.stat().st_size, []
    for share in SHARES:
        file = shutil.copy(long, tmp_path / f"{share}.h5")
        os.truncate(file, int(share * size))
        with pytest.raises(ArchiveError, match=r"its last \d+ bytes are missing; `recover` keeps the rows"):
            open_archive(file)
        recover(file)
        with open_archive(file) as archive:
            kept.append(archive.points.size)
            assert np.array_equal(archive.path(0).u, path.u[: len(archive.path(0))])
        assert kept[-1] == whole or file.with_name(f"{file.name}.damaged").stat().st_size == int(share * size)
    # The head, in which HDF5 has the places of all columns, holds no row; columns grow by 64 rows, commits by 50.
    before = [max(share * size - HEAD, 0.0) / (size - HEAD) * whole for share in SHARES]
    assert all(k >= rows - 150 for k, rows in zip(kept, before)), (kept, before)
    assert kept == sorted(kept)


def test_of_a_head_that_is_cut_off_nothing_is_left_and_that_is_said(tmp_path, small):
    file = shutil.copy(small, tmp_path / "run.h5")
    os.truncate(file, 20_000)
    with pytest.raises(ArchiveError, match="truncated or damaged"):
        recover(file)
    assert file.stat().st_size == 20_000
