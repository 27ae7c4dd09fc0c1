"""Archives that mean harm: nothing that they name is imported, called or made, whatever is done with them."""

import json
import pickle
import shutil
import sys
import zlib
from pathlib import Path

import attrs
import h5py
import numpy as np
import pytest

from continuation import Budget, trace
from continuation.archive import ArchiveError, open_archive, resume
from continuation.archive.codec import _registered
from continuation.archive.hdf5 import digest
from continuation.archive.provenance import HEAD, pack
from problems.bifurcation import ExponentialCosine

from .test_archive_hostile import claimed
from .util import OPERATIONS, outcome

FIRED = []


def fire(*arguments):
    """What an attack would do."""
    FIRED.append(arguments)


class Gadget:
    """A class that does something when it is made."""

    def __init__(self, *arguments, **options):
        fire(arguments)

    @classmethod
    def from_archive(cls, data):
        fire(data)


@attrs.define
class Held:
    """An attrs class of this module."""

    value: float = fire


class Payload:
    def __reduce__(self):
        return fire, ("pickled",)


PICKLED = np.frombuffer((raw := pickle.dumps(Payload(), protocol=0)) + b"." * (-len(raw) % 8), "<f8")
PLACE = {"number": 0, "dtype": "<f8", "shape": [PICKLED.size]}
UNPICKLED = {
    "class": "problems.nonlinear.fixed_point:FixedPointHomotopy",
    "fields": {"F": {"function": "pickle:loads"}, "a": {"array": PLACE}},
}
TREES = {
    "a class of the library around pickle.loads": UNPICKLED,
    "a function": {"function": f"{__name__}:fire"},
    "a class": {"class": f"{__name__}:Gadget", "fields": {}},
    "from_archive": {"class": f"{__name__}:Gadget", "data": {"dict": {}}},
    "an attrs class": {"class": f"{__name__}:Held", "fields": {"value": {"function": f"{__name__}:fire"}}},
    "a process": {"class": "subprocess:Popen", "fields": {}},
    "a module that is not imported": {"class": "this:X", "fields": {}},
    "a homotopy of functions": {
        "class": "continuation.evaluation.functions:FunctionHomotopy",
        "fields": {"function": {"function": "os:system"}, "y0": {"array": PLACE}, "lam0": 0.0, "target": 1.0},
    },
    "a field of another type": {
        "class": "problems.bifurcation.exponential_cosine:ExponentialCosine",
        "fields": {"N": "three", "target": {"function": "os:system"}},
    },
    "nested without end": json.loads('{"list":[' * 300 + "1" + "]}" * 300),
    "no description at all": [1, 2, 3],
}


@pytest.fixture(scope="module")
def half(tmp_path_factory):
    file = tmp_path_factory.mktemp("half") / "half.h5"
    trace(ExponentialCosine(3), archive=file, budget=Budget(steps=5))
    for name, operation in OPERATIONS.items():
        # What the operations themselves import is not the file's choice.
        operation(Path(shutil.copy(file, file.with_name(f"{name}.h5"))))
    return file


def with_slot(file, raw):
    with h5py.File(file, "r+", libver="latest") as opened:
        slots = opened["resume"]["slots"]
        slots.resize((2, max(slots.shape[1], len(raw))))
        slots[:, : len(raw)] = np.frombuffer(raw, "u1")


def in_state(file, tree):
    head = {"path": 0, "rows": 1, "counts": {}, "seconds": 0.0, "state": tree}
    body = b"\n".join([json.dumps(head).encode(), b"{}", PICKLED.tobytes()])
    with_slot(file, HEAD.pack(10**6, len(body), zlib.crc32(body)) + body)


def in_run(file, **changed):
    with open_archive(file) as archive:
        checkpoint = archive.checkpoint()
    with_slot(file, pack(attrs.evolve(checkpoint, run={**checkpoint.run, **changed})))


def in_homotopy(file, tree):
    in_run(file, homotopy=tree)


def in_problem(file, tree):
    in_run(file, homotopy={"problem": True})
    text = json.dumps(tree).replace(json.dumps(PLACE), '"a"')
    with h5py.File(file, "r+", libver="latest") as opened:
        group = opened["problem"]
        group.attrs.update({"description": text, "checksum": np.uint32(zlib.crc32(text.encode()))})
        stored = group.create_dataset("a", data=PICKLED)
        stored.attrs.update({"order": "C", "checksum": np.uint32(digest(PICKLED))})


def in_options(file, tree):
    with open_archive(file) as archive:
        options = archive.checkpoint().run["options"]
    in_run(file, options={**options, "metric": tree})


@pytest.mark.parametrize("place", [in_state, in_homotopy, in_problem, in_options], ids=lambda f: f.__name__)
@pytest.mark.parametrize("tree", TREES.values(), ids=TREES)
def test_nothing_is_executed(tmp_path, half, place, tree):
    # What installed packages register may be imported: that is not the file's choice.
    _registered("nobody:nothing")
    FIRED.clear()
    refusals = 0
    made = shutil.copy(half, tmp_path / "made.h5")
    place(made, tree)
    for ended in (True, False):
        if not ended:
            # As if the writer had been killed: then opening alone reads the checkpoint.
            with h5py.File(made, "r+") as opened:
                claimed(opened, paths=0, path_blocks=0)
        # Where opening alone reads the checkpoint, what begins by opening is refused there. What reads no checkpoint
        # meets each tree in the problem, and one of them in each place of a checkpoint.
        whole = place is in_problem or tree is TREES["a function"]
        for name in OPERATIONS if ended and whole else ("open", "checkpoint", "recover", "resume"):
            operation = OPERATIONS[name]
            file = shutil.copy(made, tmp_path / f"{name}{ended}.h5")
            known = set(sys.modules)
            complaint, _ = outcome(operation, file)
            refusals += bool(complaint)
            assert complaint == "" or complaint.startswith(f"{file}: ")
            assert "\n" not in complaint
            assert "this" not in sys.modules
            assert not {m for m in set(sys.modules) - known if not m.startswith(("continuation", "numpy"))}
    assert not FIRED
    assert refusals, "the resumes at least are refused"


def test_what_the_caller_trusts_is_made(tmp_path, half):
    shutil.copy(half, tmp_path / "run.h5")
    in_homotopy(tmp_path / "run.h5", {"class": f"{__name__}:Gadget", "fields": {}})
    FIRED.clear()
    with pytest.raises(ArchiveError, match="Gadget is not registered: pass it in trust="):
        resume(tmp_path / "run.h5", budget=Budget())
    assert not FIRED
    with pytest.raises(ArchiveError, match="expected a method `start`"):
        resume(tmp_path / "run.h5", budget=Budget(), trust=[Gadget])
    assert FIRED
