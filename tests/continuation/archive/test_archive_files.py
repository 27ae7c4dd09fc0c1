"""Files that are not what they should be: one clear line each, that names the file."""

import h5py
import numpy as np
import pytest

from continuation import Tracer, trace
from continuation.archive import ArchiveError, Limits, PathLog, export, merge, open_archive, recover, resume, trace_many
from problems.bifurcation import Circle, FreudensteinRoth


@pytest.fixture
def archive(tmp_path):
    trace(Circle(), archive=tmp_path / "good.h5")
    return tmp_path / "good.h5"


def refused(file, function=open_archive):
    with pytest.raises(ArchiveError) as caught:
        function(file)
    message = str(caught.value)
    assert message.startswith(f"{file}: ")
    assert "\n" not in message
    return message.removeprefix(f"{file}: ")


@pytest.mark.parametrize("function", [open_archive, recover, resume], ids=lambda f: f.__name__)
@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (b"", "is empty"),
        (b"a,b\n1,2\n", "is not an HDF5 file"),
        (b"\x89HDF\r\n\x1a\n", "truncated"),
        (b"\x89HDF\r\n\x1a\n" + bytes([3, 8, 8, 0]) + b"\0" * 40, "truncated or damaged, HDF5 cannot open it"),
    ],
)
def test_not_hdf5(tmp_path, function, content, complaint):
    (tmp_path / "run.h5").write_bytes(content)
    assert refused(tmp_path / "run.h5", function).startswith(complaint)


def test_missing_and_directory(tmp_path):
    assert refused(tmp_path / "run.h5") == "there is no such file"
    assert refused(tmp_path).startswith("is a directory")


def test_foreign_hdf5(tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["temperature"] = np.arange(3.0)
    assert refused(tmp_path / "other.h5").startswith("is an HDF5 file, but not an archive of paths")
    with h5py.File(tmp_path / "other.h5", "a") as file:
        file.attrs["schema"] = "weather-2"
    assert refused(tmp_path / "other.h5") == "has the schema 'weather-2', expected 'continuation-path-2'"


def test_newer_version(archive):
    with h5py.File(archive, "a", libver="latest") as file:
        file.attrs["schema"] = "continuation-path-3"
        file.attrs["library_version"] = "3.1.4"
    message = refused(archive)
    assert message.startswith("has the newer schema continuation-path-3, this library reads up to continuation-path-2")
    assert "continuation 3.1.4" in message
    assert "xarray" in message


def test_columns_of_a_later_minor_version_are_no_obstacle(archive):
    with h5py.File(archive, "a", libver="latest") as file:
        file["temperature"] = np.zeros(file["y"].shape[0])
    with open_archive(archive) as found:
        assert len(found.path(0)) > 3


@pytest.mark.parametrize("fraction", [0.1, 0.5, 0.8, 0.95])
def test_truncated_while_growing(tmp_path, fraction):
    """A file that was copied while it grew, and not to its end: said at once, while HDF5 itself would wait for ever."""
    log = PathLog(tmp_path / "live.h5", limits=Limits(rows=3, seconds=3600.0))
    steps = iter(Tracer(FreudensteinRoth(), observers=(log,)))
    next(step for step in steps if step.index == 15)
    raw = (tmp_path / "live.h5").read_bytes()
    steps.close()
    (tmp_path / "run.h5").write_bytes(raw[: int(fraction * len(raw))])
    assert refused(tmp_path / "run.h5").startswith("truncated or damaged, its last")


def test_killed_before_the_structure_was_complete(tmp_path):
    with h5py.File(tmp_path / "run.h5", "x") as file:
        file.attrs["schema"] = "continuation-path-1"
        file["y"] = np.zeros((0, 2))
    assert refused(tmp_path / "run.h5") == "truncated, its writer ended before the structure was complete"


def test_read_only(tmp_path):
    file = tmp_path / "run.h5"
    steps = iter(Tracer(FreudensteinRoth(), observers=(PathLog(file),)))
    next(steps)
    steps.close()
    file.chmod(0o444)
    with open_archive(file) as found:
        assert len(found.path(0)) == 1
    assert refused(file, resume).startswith("is read-only")
    resume(file, archive=tmp_path / "more.h5")


def test_existing_and_impossible_targets(archive, tmp_path):
    raw = archive.read_bytes()
    for write in (PathLog, lambda file: merge([archive], file), lambda file: export(archive, file)):
        assert refused(archive, write).startswith("exists already, and is never overwritten")
        nowhere = tmp_path / "no" / "run.h5"
        assert refused(nowhere, write).startswith("there is no directory")
    with pytest.raises(FileExistsError):
        trace(Circle(), archive=archive)
    assert archive.read_bytes() == raw


def test_a_file_made_by_another_in_between_is_not_overwritten(tmp_path):
    log = PathLog(tmp_path / "run.h5")
    (tmp_path / "run.h5").write_bytes(b"somebody else's")
    assert refused(tmp_path / "run.h5", lambda _: trace(Circle(), archive=log)).startswith("exists already")
    assert (tmp_path / "run.h5").read_bytes() == b"somebody else's"


class Nowhere(Circle):
    def start(self):
        raise RuntimeError("no")


def test_nothing_to_resume(tmp_path):
    trace_many([Nowhere()], archive=tmp_path / "run.h5").close()
    assert refused(tmp_path / "run.h5", resume) == "path 0 has no state to resume from; trace it again"
