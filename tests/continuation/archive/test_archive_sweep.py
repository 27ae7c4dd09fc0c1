"""Archives as others read them: merged, exported, and as a page."""

import csv
import gzip

import numpy as np
import pytest
import xarray

from continuation import Budget, trace
from continuation.archive import ArchiveError, PathLog, describe, export, merge, open_archive
from problems.bifurcation import Bratu1D, Circle, ExponentialCosine, FreudensteinRoth

from .util import assert_same


def test_merge(tmp_path):
    files = [tmp_path / f"{i}.h5" for i in range(3)]
    paths = [
        trace(FreudensteinRoth(), archive=files[0]),
        trace(FreudensteinRoth(), archive=files[1], budget=Budget(steps=7)),
        trace(ExponentialCosine(2), archive=files[2]),
    ]
    with open_archive(merge(files, tmp_path / "all.h5")) as archive:
        for found, path in zip(archive, paths, strict=True):
            assert_same(found, path)
        assert "merged from 3 files: 0.h5, 1.h5, 2.h5" in archive.attributes["history"]
        assert np.array_equal(archive.paths["homotopy_n"], [np.nan, np.nan, 2.0], equal_nan=True)
    trace(Circle(), archive=tmp_path / "circle.h5")
    with pytest.raises(ArchiveError, match=r"circle.h5: holds paths of 1 unknowns, .*0.h5 of 2; one file holds one"):
        merge([files[0], tmp_path / "circle.h5"], tmp_path / "bad.h5")


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_export_to_netcdf(tmp_path, engine):
    trace(Bratu1D(40), archive=tmp_path / "run.h5", budget=Budget(steps=20))
    (target,) = export(tmp_path / "run.h5", tmp_path / "run.nc")
    with (
        xarray.open_dataset(tmp_path / "run.h5", engine=engine) as first,
        xarray.open_dataset(target, engine=engine) as second,
    ):
        assert first.drop_attrs(deep=False).identical(second.drop_attrs(deep=False))
        assert second.y.encoding.get("complevel", second.y.encoding.get("compression_opts")) == 4
        assert "exported from run.h5" in second.attrs["history"]


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_export_to_text(tmp_path, suffix):
    def rows(file):
        with (gzip.open if suffix.endswith("gz") else open)(file, "rt", newline="") as opened:
            return list(csv.DictReader(opened))

    path = trace(FreudensteinRoth(), archive=tmp_path / "run.h5")
    points, paths = export(tmp_path / "run.h5", tmp_path / f"run{suffix}")
    assert paths.name == f"run.paths{suffix}"
    accepted = [row for row in rows(points) if row["role"] == "0"]
    assert [float(row["y_1"]) for row in accepted] == path.y[:, 1].tolist()
    assert [float(row["arclength"]) for row in accepted] == path.arclength.tolist()
    (row,) = rows(paths)
    assert (row["message"], int(row["solves"])) == (path.message, path.counts.solves)


def test_the_page(tmp_path):
    path = trace(FreudensteinRoth(), archive=PathLog(tmp_path / "run.h5", title="A classic"))
    with open_archive(tmp_path / "run.h5") as archive:
        page = describe(archive)
    for text in (
        "A classic", "FreudensteinRoth", "predictor=Hermite", "AllgowerGeorg", "REACHED_TARGET", path.message,
        "0.5875873254", "-0.6863527575", f"{path.counts.solves} solves", "python 3.",
    ):  # fmt: skip
        assert text in page
    trace(FreudensteinRoth(), archive=tmp_path / "short.h5", budget=Budget(steps=3))
    with open_archive(tmp_path / "short.h5") as archive:
        assert "can be resumed with more steps: `continuation resume" in describe(archive)
