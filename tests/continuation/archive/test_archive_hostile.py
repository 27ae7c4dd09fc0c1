"""Archives made to harm: doors to other files, sizes that are not there, numbers that mean nothing. One line, soon."""

import json
import shutil
from contextlib import suppress

import attrs
import h5py
import numpy as np
import pytest

from continuation import Budget, trace
from continuation.archive import ArchiveError, open_archive, recover
from continuation.archive.contents import _known
from continuation.archive.hdf5 import Committed, of_attributes, seal
from continuation.archive.schema import Layout
from problems.bifurcation import ExponentialCosine

from .util import OPERATIONS, logged, outcome, read


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    file = tmp_path_factory.mktemp("base") / "base.h5"
    trace(ExponentialCosine(3), archive=logged(file), budget=Budget(steps=12))
    return file


def claimed(file, **counts):
    """A commit of so many rows, with a checksum of its own."""
    records = file["checks"]["commits"]
    numbers = max(np.frombuffer(record.tobytes()[:-4], "<u8").tolist() for record in records[:])
    commit = attrs.evolve(Committed(*numbers), **counts)
    records[:] = [commit.pack()] * 4
    return commit


def resealed(file, **counts):
    """Checksums of what is there now, as far as it can be read: who can write a file can write them."""
    commit = claimed(file, point_blocks=1, path_blocks=1, **counts)
    for table, count in {"point": commit.points, "path": commit.paths}.items():
        columns = Layout(1, more=_known(set(file))).columns(table)
        sums = seal({column.name: file[column.name][:count] for column in columns}, 0)
        file["checks"][table].resize((1, len(sums)))
        file["checks"][table][0] = sums
    file["checks"].attrs["attributes"] = np.uint32(of_attributes(dict(file.attrs)))


def replaced(file, name, value):
    del file[name]
    file[name] = value


def other(file, **layout):
    del file["parameter"]
    file.create_dataset("parameter", dtype="f8", **layout)


def virtual(file, secret):
    del file["parameter"]
    layout = h5py.VirtualLayout((13,), "f8")
    layout[:] = h5py.VirtualSource(str(secret), "parameter", (13,))[:13]
    file.create_virtual_dataset("parameter", layout)


HARM = {
    "an external link": lambda f, s: replaced(f, "y", h5py.ExternalLink(str(s), "/y")),
    "a soft link": lambda f, s: replaced(f, "y", h5py.SoftLink("/tangent_y")),
    "a soft link to itself": lambda f, s: replaced(f, "y", h5py.SoftLink("/y")),
    "external storage": lambda f, s: other(f, shape=(13,), external=[(str(s), 0, h5py.h5f.UNLIMITED)]),
    "a virtual dataset": virtual,
    "a group for a column": lambda f, s: (f.pop("y"), f.create_group("y")),
    "a number for a column": lambda f, s: replaced(f, "y", 5.0),
    "text for a column": lambda f, s: replaced(f, "parameter", np.array([b"a"] * 13)),
    "objects for a column": lambda f, s: replaced(f, "parameter", np.array(["a"] * 13, object)),
    "integers for a column": lambda f, s: replaced(f, "parameter", np.arange(13)),
    "another shape": lambda f, s: replaced(f, "parameter", np.zeros((13, 2))),
    "rows that are not there": lambda f, s: [f[n].resize(10**9, axis=0) for n in ("y", "parameter", "path_index")],
    "unknowns that are not there": lambda f, s: (f.pop("y"), f.create_dataset("y", (13, 2**40), "f8", chunks=(1, 99))),
    "large chunks": lambda f, s: other(f, shape=(13,), maxshape=(None,), chunks=(2**26,), compression="gzip"),
    "an end that is none": lambda f, s: f["status"].__setitem__(0, 77),
    "a kind that is none": lambda f, s: f["kind"].__setitem__(slice(None), 99),
    "another path's points": lambda f, s: f["path_index"].__setitem__(slice(None), 55),
    "a long path": lambda f, s: f["n_points"].__setitem__(0, 10**12),
    "a path of less than nothing": lambda f, s: f["n_points"].__setitem__(0, -3),
    "an event without a name": lambda f, s: f["event_index"].__setitem__(slice(None), 30000),
    "names without end": lambda f, s: f["event_name"].resize(10**8, axis=0),
    "settings without end": lambda f, s: f.attrs.__setitem__("settings", '{"a":' * 5000),
    "settings of another kind": lambda f, s: f.attrs.__setitem__("settings", 5),
    "parameters of another kind": lambda f, s: f.attrs.__setitem__("parameters", "[1, 2]"),
    "a schema of another kind": lambda f, s: f.attrs.__setitem__("schema", np.arange(5)),
    "a schema without end": lambda f, s: f.attrs.__setitem__("schema", "continuation-path-" + "9" * 5000),
    "a problem that is not there": lambda f, s: f["problem"].create_dataset("A", (10**5,) * 2, "f8", chunks=(99, 99)),
    "a checkpoint that is not there": lambda f, s: f["resume"]["slots"].resize((2, 4 * 10**9)),
    "no checkpoints": lambda f, s: replaced(f, "resume", 5),
    "a kink without a switch": lambda f, s: (f["role"].__setitem__(5, 2), f["event_index"].__setitem__(4, 0)),
    "a message that is no text": lambda f, s: f["message"].__setitem__(0, b"\xff\xfe"),
    "an event's name with control codes": lambda f, s: f["event_name"].__setitem__(0, b"\xff\x1b[0m"),
    "a column's name that is no text": lambda f, s: f.create_dataset(b"observed_\xff", data=np.zeros(14)),
    "a column's name with control codes": lambda f, s: f.create_dataset("observed_\x1b]0;x\x07", data=np.zeros(14)),
    "a type with control codes": lambda f, s: (f.pop("y"), f.create_dataset("y", (14,), [("\x1b[2J", "f8")])),
    "nested roots": lambda f, s: f.attrs.update(names=json.dumps(["$" + "\\sqrt{" * 300 + "x" + "}" * 300 + "$"])),
    "points that are claimed": lambda f, s: claimed(f, points=10**12),
    "nested names": lambda f, s: f.attrs.update(names="[" * 100_000),
    "a homotopy's name with control codes": lambda f, s: f.attrs.__setitem__("homotopy", "\x1b]0;x\x07"),
}


@pytest.mark.parametrize("sealed", [False, True], ids=["damaged", "sealed"])
@pytest.mark.parametrize("harm", HARM)
def test_one_line_or_nothing_amiss(tmp_path, base, harm, sealed):
    secret, right, refused = shutil.copy(base, tmp_path / "secret.h5"), read(base).u, 0
    harmed = shutil.copy(base, tmp_path / "harmed.h5")
    with h5py.File(harmed, "r+", libver="latest") as opened:
        HARM[harm](opened, secret)
        if sealed:
            with suppress(Exception):
                resealed(opened)
    for name, operation in OPERATIONS.items():
        file = shutil.copy(harmed, tmp_path / f"{name}.h5")
        complaint, found = outcome(operation, file)
        refused += bool(complaint)
        assert "\n" not in complaint
        if not sealed and name == "read" and not complaint:
            assert np.array_equal(found[0], right)
        for said in (complaint, str(found)):
            assert "\x1b" not in said
            said.encode()
    harmless = ("rows that are not there", "names without end", "a checkpoint that is not there")
    assert refused or sealed or harm in harmless


def test_a_closed_archive_says_that_it_is_closed(base):
    archive = open_archive(base)
    assert len(archive.points["arclength"]) == 14
    archive.close()
    archive.close()
    for asked in (
        lambda: archive.points["y"],
        lambda: archive.path(0),
        archive.contents.problem,
        lambda: archive.status(0),
    ):
        with pytest.raises(ArchiveError, match=r"base.h5: the archive was closed; open it again"):
            asked()
    assert repr(archive) == f"<Archive {base}, closed>"


def test_a_damaged_row_is_named_and_the_sound_ones_are_kept(tmp_path, base):
    file = shutil.copy(base, tmp_path / "run.h5")
    with h5py.File(file, "r+", libver="latest") as opened:
        opened["y"][7, 1] += 1e-12
    with open_archive(file) as archive:
        with pytest.raises(ArchiveError, match=r"rows 5 to \d+ of y are not what was .* [89] rows read are sound"):
            _ = archive.points["y"]
        assert len(archive.points["arclength"]) == 14
    damaged = file.read_bytes()
    recover(file)
    with open_archive(file) as archive, open_archive(base) as whole:
        path = archive.path(0)
        assert np.array_equal(path.u, whole.path(0).u[:5])
        assert path.message.endswith("The rest of it was damaged.")
    assert (tmp_path / "run.h5.damaged").read_bytes() == damaged
    assert recover(file) == file


def test_what_is_not_asked_for_may_be_damaged(tmp_path, base):
    file = shutil.copy(base, tmp_path / "run.h5")
    with h5py.File(file, "r+", libver="latest") as opened:
        opened.attrs["title"] = "another"
        opened["n_points"][0] += 1
    with open_archive(file) as archive, open_archive(base) as whole:
        assert np.array_equal(archive.points["y"], whole.points["y"])
        for asked in (lambda: archive.attributes, lambda: len(archive), lambda: archive.paths["status"]):
            with pytest.raises(ArchiveError, match=r"not what was written"):
                asked()
