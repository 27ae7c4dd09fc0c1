"""Files that are not what they should be: one clear line each, that names the file."""

import h5py
import numpy as np
import pytest

from continuation import trace
from continuation.archive import open_archive, resume, trace_many
from problems.bifurcation import Circle, FreudensteinRoth

from ...util import refused
from .test_archive_workers import Broken
from .util import interrupted, logged, read


def foreign(file, **attributes):
    with h5py.File(file, "w") as opened:
        opened["temperature"] = np.arange(3.0)
        opened.attrs.update(attributes)


def incomplete(file):
    with h5py.File(file, "x") as opened:
        opened.attrs["schema"] = "continuation-path-2"
        opened["y"] = np.zeros((0, 2))


def of_a_newer_version(file):
    trace(Circle(), archive=file)
    with h5py.File(file, "a", libver="latest") as opened:
        opened.attrs.update({"schema": "continuation-path-3", "library_version": "3.1.4"})


FILES = {
    "nothing": (lambda file: None, r"cannot be read \(No such file or directory\)"),
    "a directory": (lambda file: file.mkdir(), "is no regular file"),
    "no bytes": (lambda file: file.touch(), "is empty"),
    "text": (lambda file: file.write_bytes(b"a,b\n1,2\n"), "is not an HDF5 file"),
    "a signature": (lambda file: file.write_bytes(b"\x89HDF\r\n\x1a\n"), "truncated"),
    "half a superblock": (
        lambda file: file.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes([3, 8, 8, 0]) + b"\0" * 40),
        "truncated or damaged, HDF5 cannot open it",
    ),
    "another's HDF5": (foreign, "is an HDF5 file, but not an archive of paths"),
    "another schema": (
        lambda file: foreign(file, schema="weather-2"),
        "has the schema 'weather-2', expected 'continuation-path-2'",
    ),
    "half a structure": (incomplete, "truncated, its writer ended before the structure was complete"),
    "a newer version": (
        of_a_newer_version,
        "has the newer schema continuation-path-3, this library reads up to continuation-path-2; .*3.1.4.*xarray",
    ),
    "no state": (
        lambda file: trace_many([Broken()], archive=file).close(),
        "path 0 has no state to resume from; trace it again",
    ),
}


@pytest.mark.parametrize("kind", FILES)
def test_one_line(tmp_path, kind):
    make, complaint = FILES[kind]
    make(tmp_path / "run.h5")
    function = resume if kind == "no state" else open_archive
    refused(tmp_path / "run.h5", lambda: function(tmp_path / "run.h5"), complaint)


def test_columns_of_a_later_minor_version_are_no_obstacle(tmp_path):
    trace(Circle(), archive=tmp_path / "run.h5")
    with h5py.File(tmp_path / "run.h5", "a", libver="latest") as file:
        file["temperature"] = np.zeros(file["y"].shape[0])
    assert len(read(tmp_path / "run.h5")) > 3


def test_read_only(tmp_path):
    file = tmp_path / "run.h5"
    interrupted(file, FreudensteinRoth(), 0)
    file.chmod(0o444)
    assert len(read(file)) == 1
    refused(file, lambda: resume(file), "is read-only")
    resume(file, archive=tmp_path / "more.h5")


def test_a_file_made_by_another_in_between_is_not_overwritten(tmp_path):
    log = logged(tmp_path / "run.h5")
    (tmp_path / "run.h5").write_bytes(b"somebody else's")
    refused(tmp_path / "run.h5", lambda: trace(Circle(), archive=log), "exists already")
    assert (tmp_path / "run.h5").read_bytes() == b"somebody else's"
