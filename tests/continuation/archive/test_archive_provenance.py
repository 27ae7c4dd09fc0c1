"""What an archive says of each path: the homotopy's parameters whatever its class, names and units, and the source."""

import dataclasses
import os
from typing import ClassVar

import attrs
import numpy as np
import pytest

from continuation import Budget, Monitor, trace
from continuation.archive import ArchiveError, PathLog, merge, open_archive, resume, trace_many
from continuation.controllers import Bounds, Fixed
from problems import lcp
from problems.bifurcation import Bratu1D

from .util import logged, read


class Line:
    """y = slope lam, n times."""

    target = 1.0
    parameter_name = "load"
    names = ("left", "right")
    units: ClassVar = {"load": "N", "left": "mm", "size": "mm"}
    events = (Monitor(lambda u, v: u[0] - 0.5, "half way"),)

    def start(self):
        return np.zeros(2), 0.0

    def residual(self, y, lam):
        return y - self.slope * lam

    def observe(self, y, lam):
        return {"size": float(np.hypot(*y))}


class Plain(Line):
    def __init__(self, slope=2.0):
        self.slope, self.label, self.table, self._hidden = slope, "steel", np.arange(3.0), 7.0


@dataclasses.dataclass
class Data(Line):
    slope: float = 2.0
    label: str = "steel"


@attrs.frozen
class Frozen(Line):
    slope: float = 2.0
    end: float | None = None


KINDS = [Plain, Data, Frozen]


@pytest.mark.parametrize("kind", KINDS)
def test_numeric_parameters_are_columns_of_a_sweep_whatever_the_class(tmp_path, kind):
    with trace_many([kind(slope) for slope in (1.0, 2.0, 3.0)], archive=tmp_path / "run.h5") as archive:
        assert archive.paths["homotopy_slope"].tolist() == [1.0, 2.0, 3.0]
        assert set(archive.paths["homotopy"]) == {f"{__name__}:{kind.__qualname__}".encode()}
        assert "_hidden" not in archive.attributes["parameters"]


def test_names_units_parameters_and_what_is_observed_are_kept_and_read_again(tmp_path):
    path = trace(Plain(), archive=PathLog(tmp_path / "run.h5", parameters={"grid": 7}))
    for one in (path, read(tmp_path / "run.h5")):
        assert (one.labels.parameter_name, one.labels.names) == ("load", ("left", "right"))
        assert one.labels.parameter() == "load [N]"
        assert (one.labels.index("right"), one.labels.index("load")) == (1, -1)
        assert [event.observed for event in one.events] == [{"size": pytest.approx(0.5 * np.sqrt(2.0), abs=1e-9)}]
    with open_archive(tmp_path / "run.h5") as archive:
        assert {'"grid": 7', '"label": "steel"'} <= set(archive.attributes["parameters"].strip("{}").split(", "))


@pytest.mark.parametrize(("name", "value"), [("parameter_name", 3), ("names", "ab"), ("names", (1, 2)), ("units", "N")])
def test_names_that_are_none_are_refused(monkeypatch, name, value):
    monkeypatch.setattr(Line, name, value)
    with pytest.raises(TypeError, match=f"{name}: expected "):
        trace(Plain())


def test_eight_points_of_a_hundred_unknowns_take_less_than_100_kilobytes(tmp_path):
    options = {"target": None, "controller": Fixed(Bounds(initial=0.1)), "budget": Budget(steps=7)}
    # A commit at the end, however slow the machine is: each takes a little room.
    path = trace(Bratu1D(100), archive=logged(tmp_path / "run.h5", 100), **options)
    assert len(path) == 8
    assert os.path.getsize(tmp_path / "run.h5") < 100_000


def test_merging_keeps_homotopy_and_source_of_each_path(tmp_path):
    files = [tmp_path / f"{kind.__name__}.h5" for kind in (Plain, Data)]
    trace(Plain(), archive=files[0])
    trace_many([Data(1.0), Data(2.0)], archive=files[1]).close()
    with open_archive(merge(files, tmp_path / "all.h5")) as archive:
        assert [name.decode().rpartition(":")[2] for name in archive.paths["homotopy"]] == ["Plain", "Data", "Data"]
        sources = [source.decode().split() for source in archive.paths["source"]]
    assert [(number, file) for _, number, file in sources] == [("0", "Plain.h5"), ("0", "Data.h5"), ("1", "Data.h5")]
    assert sources[0][0] != sources[1][0] == sources[2][0]


def test_merging_refuses_a_path_that_is_there_already(tmp_path):
    short, whole = tmp_path / "short.h5", tmp_path / "whole.h5"
    trace(Plain(), archive=short, budget=Budget(steps=1))
    resume(short, Plain(), archive=whole, budget=Budget())
    with pytest.raises(ArchiveError, match=r"whole\.h5: its path 0 is path 0 of .*copy\.h5 as well"):
        merge([merge([short], tmp_path / "copy.h5"), whole], tmp_path / "all.h5")
    assert not (tmp_path / "all.h5").exists()


def test_an_archive_of_solve_names_the_problem(tmp_path):
    lcp.solve(lcp.LCP([[1.0, -1.0], [-1.0, 1.0]], [-0.5, 2.0]), "kkt", archive=tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.attributes["title"] == "Paths of a linear complementarity problem, n = 2"
        assert archive.attributes["homotopy"] == "problems.lcp.homotopies.kkt:KKTHomotopy"
