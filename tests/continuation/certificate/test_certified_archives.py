"""Traces with a proof, and proofs in archives: checked again, and refused where they were changed."""

import h5py
import numpy as np
import pytest
from attrs import evolve

from continuation import certify, from_functions, trace
from continuation.archive import ArchiveError, add_proof, recheck
from continuation.certificate.certifying import recheck as checked_again
from continuation.cli import main
from problems.bifurcation import FreudensteinRoth

from ..archive.util import read
from .util import proved


def test_a_certified_trace_is_the_same_trace_where_that_is_proved(tmp_path, capsys):
    file, plain = tmp_path / "proved.h5", trace(FreudensteinRoth(), archive=tmp_path / "plain.h5")
    path = trace(FreudensteinRoth(), certified=True, archive=file)
    assert path.proof.complete
    assert "Proved" in path.message
    np.testing.assert_array_equal(path.u, plain.u)
    assert plain.proof is None
    (again,) = recheck(file)
    assert again.complete
    assert len(again.turning_points) == 2
    assert main(["recheck", str(file)]) == 0
    assert "path 0: Proved" in capsys.readouterr().out
    assert main(["recheck", str(tmp_path / "plain.h5")]) == 1
    stored = read(tmp_path / "plain.h5")
    # Computed again where a file has none.
    stored.steps = [evolve(step, tangent=np.full_like(step.tangent, np.nan)) for step in stored.steps]
    assert certify(stored, FreudensteinRoth()).complete


def test_a_changed_certificate_proves_nothing(tmp_path):
    homotopy = FreudensteinRoth()
    path, proof = proved(homotopy)
    assert checked_again(proof.cells, path, homotopy).complete
    cells, count = proof.cells, np.arange(len(proof.cells))
    for changed in (
        cells.with_tubes(1e-9 * cells.radius, cells.slabs),
        cells.with_tubes(30.0 * cells.radius, cells.slabs),
        cells.take(count[3:]),
        cells.take(np.delete(count, 5)),
        evolve(cells, begin=cells.begin + 1e-3),
    ):
        assert not checked_again(changed, path, homotopy).complete
    other = from_functions(lambda y, lam: homotopy.residual(y, 1.001 * lam), start=homotopy.start())
    assert not checked_again(cells, path, other).complete


def test_a_damaged_or_foreign_certificate_is_an_error(tmp_path):
    file = tmp_path / "path.h5"
    path = trace(FreudensteinRoth(), archive=file)
    (nothing,) = recheck(file)
    assert not nothing.complete
    assert "no certificate" in str(nothing)
    proof = certify(path, FreudensteinRoth())
    add_proof(file, proof)
    add_proof(file, proof)
    assert recheck(file)[0].complete
    for name, damage in DAMAGE.items():
        copy = tmp_path / f"{name}.h5"
        copy.write_bytes(file.read_bytes())
        with h5py.File(copy, "r+") as opened:
            group = opened["certificate/0"]
            values = damage(group[name][()])
            if np.shape(values) == group[name].shape:
                group[name][...] = values
            else:
                del group[name]
                group[name] = values
        with pytest.raises(ArchiveError, match="certificate of path 0 is damaged"):
            recheck(copy)


DAMAGE = {
    "radius": lambda values: values * 1.0000001,
    "begin": lambda values: values[:, :2],
    "chart": lambda values: "not numbers",
}


def test_a_stored_proof_of_nothing_is_checked_again(tmp_path):
    path = trace(FreudensteinRoth(), archive=tmp_path / "a.h5")
    proof = certify(path, FreudensteinRoth())
    none = evolve(proof, cells=proof.cells.take(slice(0, 0)), node_radius=proof.node_radius[:0])
    add_proof(tmp_path / "a.h5", none)
    (found,) = recheck(tmp_path / "a.h5")
    assert not found.complete
