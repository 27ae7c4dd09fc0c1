"""Files of `continuation-path-2` of an earlier state of the library, in each state of a file: read, recovered, used.

`old/make.py` of commit bdd6fa3 wrote them by commit 36e65f7f.
"""

import json
import shutil
import tarfile
from pathlib import Path

import numpy as np
import pytest

from continuation import Budget, Status, trace
from continuation.archive import ArchiveError, describe, export, merge, open_archive, recover, resume
from problems.bifurcation import Cusp

OLD = Path(__file__).parent / "old" / "archives.tar.xz"
FILES = (
    "budget.h5", "finished.h5", "gzip.nc", "killed.h5", "killed_early.h5", "killed_sweep.h5", "merged.h5",
    "observed.h5", "sweep.h5",
)  # fmt: skip


@pytest.fixture(scope="module")
def old(tmp_path_factory):
    folder = tmp_path_factory.mktemp("old")
    with tarfile.open(OLD) as archives:
        archives.extractall(folder, filter="data")
    return folder


def found(archive):
    paths = list(archive)
    return {
        "paths": len(paths),
        "points": archive.points.size,
        "statuses": [path.status.name for path in paths],
        "end": [path.steps[-1].lam if path.steps else None for path in paths],
        "sum": float(archive.points["y"].sum()),
    }


@pytest.mark.parametrize("name", FILES)
def test_read_as_its_own_version_read_it_recovered_exported_and_merged(tmp_path, old, name):
    told, file = json.loads((old / "told.json").read_text())[name], Path(shutil.copy(old / name, tmp_path / name))
    with open_archive(file) as archive:
        assert found(archive) == told
        assert str(archive.points.size) in describe(archive)
        for step in archive[0].steps if name == "observed.h5" else ():
            assert step.observed["norm"] == np.abs(step.y).max()
    recover(file)
    told["statuses"] = [{"TRACING": "INTERRUPTED"}.get(status, status) for status in told["statuses"]]
    for target in (file, export(file, tmp_path / "new.nc")[0], merge([file], tmp_path / "new.h5")):
        with open_archive(target) as archive:
            assert found(archive) == told
            assert archive.closed_by_writer
    assert len(export(file, tmp_path / "new.csv")) == 2


def test_a_state_resumes_within_its_major_version_and_a_path_goes_on_in_any(tmp_path, old, monkeypatch):
    file = Path(shutil.copy(old / "budget.h5", tmp_path))
    again = resume(file, archive=tmp_path / "more.h5", budget=Budget())
    assert again.endpoint.lam == trace(Cusp()).endpoint.lam
    monkeypatch.setattr("continuation.archive.provenance.__version__", "1.0.0")
    said = r"no state that version .* resumes .*major version.*trace\(homotopy, start=open_archive\(.*\[0\]\)$"
    with pytest.raises(ArchiveError, match=said):
        resume(file, budget=Budget())
    with open_archive(file) as archive:
        before = archive[0]
    after = trace(Cusp(), start=before)
    assert np.array_equal(after.u[0], before.u[-1])
    # The direction is that in which it came: the path does not turn back.
    assert (after.u[1] - after.u[0]) @ (before.u[-1] - before.u[-2]) > 0.0
    assert (after.status, after.endpoint.lam) == (Status.REACHED_TARGET, trace(Cusp()).endpoint.lam)
