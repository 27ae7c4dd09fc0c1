"""Traces with a proof, and proofs in archives: checked again, and refused where they were changed."""

import h5py
import numpy as np
import pytest
from attrs import evolve

from continuation import certify, from_functions, trace
from continuation.archive import ArchiveError, PathLog, add_proof, open_archive, recheck
from continuation.certificate.certifying import recheck as checked_again
from problems.bifurcation import FreudensteinRoth


def test_a_certified_trace_is_the_same_trace_where_that_is_proved(tmp_path):
    file = tmp_path / "proved.h5"
    path = trace(FreudensteinRoth(), certified=True, archive=file)
    plain = trace(FreudensteinRoth())
    assert path.proof.complete
    assert "Proved" in path.message
    np.testing.assert_array_equal(path.u, plain.u)
    assert plain.proof is None
    (again,) = recheck(file)
    assert again.complete
    assert len(again.turning_points) == 2
    bare = tmp_path / "without_tangents.h5"
    with PathLog(bare, tangents=False) as log:
        trace(FreudensteinRoth(), archive=log)
    with open_archive(bare) as archive:
        stored = archive[0]
    np.testing.assert_array_equal(stored.u, path.u)
    assert np.isnan(stored.tangents).any()  # computed again where a file has none
    assert certify(stored, FreudensteinRoth()).complete


def test_a_changed_certificate_proves_nothing(tmp_path):
    homotopy = FreudensteinRoth()
    path = trace(homotopy)
    proof = certify(path, homotopy)
    assert checked_again(proof.cells, path, homotopy).complete
    for radius in (1e-9 * proof.cells.radius, 30.0 * proof.cells.radius):
        changed = proof.cells.with_tubes(radius, proof.cells.slabs)
        assert not checked_again(changed, path, homotopy).complete
    assert not checked_again(proof.cells.take(np.arange(3, len(proof.cells))), path, homotopy).complete
    assert not checked_again(proof.cells.take(np.delete(np.arange(len(proof.cells)), 5)), path, homotopy).complete
    shifted = evolve(proof.cells, begin=proof.cells.begin + 1e-3)
    assert not checked_again(shifted, path, homotopy).complete
    other = from_functions(lambda y, lam: homotopy.residual(y, 1.001 * lam), start=homotopy.start())
    assert not checked_again(proof.cells, path, other).complete


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
    for damage in (_bit, _shape, _text):
        copy = tmp_path / f"{damage.__name__}.h5"
        copy.write_bytes(file.read_bytes())
        with h5py.File(copy, "r+") as opened:
            damage(opened["certificate/0"])
        with pytest.raises(ArchiveError, match="certificate of path 0 is damaged"):
            recheck(copy)


def _bit(group):
    group["radius"][3, 1] *= 1.0000001


def _shape(group):
    values = group["radius"][:, :2]
    del group["radius"]
    group["radius"] = values


def _text(group):
    del group["chart"]
    group["chart"] = "not numbers"


def test_the_shell_checks_again(tmp_path, capsys):
    from continuation.cli import main

    file = tmp_path / "proved.h5"
    trace(FreudensteinRoth(), certified=True, archive=file)
    assert main(["recheck", str(file)]) == 0
    assert "path 0: Proved" in capsys.readouterr().out
    trace(FreudensteinRoth(), archive=tmp_path / "plain.h5")
    assert main(["recheck", str(tmp_path / "plain.h5")]) == 1


def test_a_stored_proof_of_nothing_is_checked_again(tmp_path):
    path = trace(FreudensteinRoth(), archive=tmp_path / "a.h5")
    proof = certify(path, FreudensteinRoth())
    none = evolve(proof, cells=proof.cells.take(slice(0, 0)), node_radius=proof.node_radius[:0])
    add_proof(tmp_path / "a.h5", none)
    (found,) = recheck(tmp_path / "a.h5")
    assert not found.complete
