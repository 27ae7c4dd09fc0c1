"""What goes in comes out: through our own reader, and through xarray with either engine."""

import attrs
import h5py
import numpy as np
import pytest
import xarray

import continuation
from continuation import Budget, Status, TargetValue, from_functions, trace
from continuation.archive import PathLog, open_archive, resume
from continuation.archive.schema import SCHEMA
from problems.bifurcation import Bratu1D, Circle, ExponentialCosine, FreudensteinRoth, Pitchfork

from .util import assert_same, read

EVENTS = (TargetValue(0.25, terminal=0), TargetValue(20.0, component=0, terminal=0))
CASES = {
    "folds": (FreudensteinRoth(), {}),
    "own events": (FreudensteinRoth(), {"events": EVENTS}),
    "terminal event": (FreudensteinRoth(), {"events": [TargetValue(-0.5)]}),
    "two events on the end": (FreudensteinRoth(), {"events": [TargetValue(1.0, terminal=0)] * 2}),
    "closed": (Circle(), {}),
    "observed": (Bratu1D(12), {"budget": Budget(steps=9)}),
    "branch point": (Pitchfork(), {}),
    "no point": (from_functions(lambda y, lam: y * y + 1.0 + lam, start=(np.array([0.5]), 0.0), target=1.0), {}),
}


# The directions at a branch point are found again when they are asked for.
UNSTORED = {"segment", "weights", "rejected", "rays"}


def stored(items):
    return [attrs.asdict(item, recurse=False, filter=lambda field, _: field.name not in UNSTORED) for item in items]


@pytest.mark.parametrize("case", CASES)
def test_a_path_comes_back_as_it_was(tmp_path, case):
    homotopy, options = CASES[case]
    path = trace(homotopy, archive=tmp_path / "run.h5", **options)
    found = read(tmp_path / "run.h5")
    np.testing.assert_equal(stored(found.steps), stored(path.steps))
    np.testing.assert_equal(stored(found.events), stored(path.events))
    assert (found.status, found.message, found.counts) == (path.status, path.message, path.counts)
    assert found.seconds == path.seconds


def test_dense_output_by_stored_tangents(tmp_path):
    path = trace(Circle(), archive=tmp_path / "run.h5")
    found = read(tmp_path / "run.h5")
    assert np.abs(np.hypot(*found(np.linspace(0.0, path.arclength[-1], 200)).T) - 1.0).max() < 1e-3
    assert np.abs(found(path.arclength) - path.u).max() < 1e-12


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_xarray_opens_the_file_without_us(tmp_path, engine):
    path = trace(FreudensteinRoth(), archive=tmp_path / "run.h5")
    with xarray.open_dataset(tmp_path / "run.h5", engine=engine) as data:
        data.load()
    assert dict(data.sizes) == {
        "point": len(path) + len(path.turning_points),
        "path": 1,
        "component": 2,
        "controller": 4,
        "event": 1,
    }
    assert set(data.coords) == {"path", "component"}
    assert data.y.dims == ("point", "component")
    assert data.attrs["schema"] == SCHEMA
    assert data.path_index.attrs["instance_dimension"] == "path"
    assert data.path.attrs["cf_role"] == "trajectory_id"
    accepted = data.where(data.role == 0, drop=True)
    assert np.array_equal(accepted.y, path.y)
    assert np.array_equal(accepted.parameter, path.lam)
    assert all(variable.attrs["units"] and variable.attrs["long_name"] for variable in data.variables.values())
    flags = dict(zip(data.status.attrs["flag_meanings"].split(), data.status.attrs["flag_values"]))
    assert flags == {status.flag: int(status) for status in Status}
    kinds = dict(zip(data.kind.attrs["flag_meanings"].split(), np.atleast_1d(data.kind.attrs["flag_values"])))
    assert data.parameter[data.kind == kinds["turning_point"]].values.tolist() == [e.lam for e in path.turning_points]
    assert int(data.committed_points) == data.sizes["point"]


def test_to_xarray_is_what_xarray_opens_and_a_dataframe_has_its_rows(tmp_path):
    trace(Bratu1D(5), archive=tmp_path / "run.h5", budget=Budget(steps=7))
    with open_archive(tmp_path / "run.h5") as archive:
        ours, frame = archive.to_xarray(), archive.to_dataframe()
    assert np.array_equal(frame[["y_0", "y_1"]], ours.y[:, :2])
    with xarray.open_dataset(tmp_path / "run.h5", engine="h5netcdf") as data:
        theirs = data.load().drop_vars(["committed_points", "committed_paths"])
    xarray.testing.assert_allclose(ours, theirs, rtol=0.0, atol=0.0)


def test_many_paths_in_one_file(tmp_path):
    cases = (ExponentialCosine(3), Budget()), (ExponentialCosine(3, target=0.4), Budget(steps=5))
    with PathLog(tmp_path / "run.h5", title="two") as log:
        paths = [trace(homotopy, archive=log, budget=budget) for homotopy, budget in cases]
        with pytest.raises(ValueError, match=r"homotopy: expected 3 unknowns.*found 2"):
            trace(FreudensteinRoth(), archive=log)
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.attributes["title"] == "two"
        for found, path in zip(archive[:2], paths, strict=True):
            assert np.array_equal(found.u, path.u)
        assert archive[-1].status is Status.RAISED


def test_provenance_and_the_problem_are_in_the_file(tmp_path):
    trace(FreudensteinRoth(), archive=tmp_path / "run.h5")
    with h5py.File(tmp_path / "run.h5") as file:
        about = dict(file.attrs)
    for name, begins in {
        "Conventions": "CF-", "featureType": "trajectory", "library_version": continuation.__version__,
        "homotopy": "problems.bifurcation.freudenstein_roth:FreudensteinRoth", "references": "@article",
    }.items():  # fmt: skip
        assert about[name].startswith(begins)
    assert all(about[f"{name}_version"] for name in ("python", "numpy", "scipy", "h5py", "hdf5"))
    assert "created" in about["history"]
    assert not any(isinstance(value, (bool, np.bool_)) for value in about.values())


@attrs.frozen(eq=False)
class Quadric:
    """A matrix, twice, of either layout."""

    matrix: np.ndarray
    scaled: tuple[np.ndarray, float]
    target = 1.0

    def start(self):
        return np.zeros(len(self.matrix)), 0.0

    def residual(self, y, lam):
        return y + 0.3 * np.tanh(self.matrix @ y) - lam * self.scaled[1] * (self.scaled[0] @ np.ones(len(y)))


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("first", [True, False])
def test_matrices_come_back_as_they_lay_in_memory(tmp_path, order, first):
    """BLAS adds up in another order for the one layout than for the other."""
    matrix = np.asarray(np.random.default_rng(4).standard_normal((9, 9)), order=order)
    homotopy, file = Quadric(matrix, (matrix, 0.5)), tmp_path / "run.h5"
    with PathLog(file) as log:
        if not first:
            trace(Quadric(np.eye(9), (np.eye(9), 2.0)), archive=log)
        trace(homotopy, archive=log, budget=Budget(steps=2))
    assert_same(resume(file, trust=[Quadric], budget=Budget()), trace(homotopy))
