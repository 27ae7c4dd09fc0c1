"""Proofs of paths, in the group `/certificate`; `recheck` tests every condition."""

from __future__ import annotations

import os
import shutil
from collections.abc import Sequence
from contextlib import closing
from os import PathLike
from pathlib import Path as File
from typing import Any

import h5py
import numpy as np

from continuation.archive.atomic import ArchiveError, as_file, beside, own, publish, short
from continuation.archive.codec import read_arrays, write_arrays
from continuation.archive.contents import FAULTS
from continuation.archive.hdf5 import StructureError, member, names
from continuation.archive.reader import Archive, open_archive
from continuation.archive.resume import stored_homotopy
from continuation.archive.trust import registry
from continuation.certificate.cells import COLUMNS, Cells
from continuation.certificate.certifying import recheck as checked_again
from continuation.certificate.proof import Gap, Proof

GROUP = "certificate"


def add_proof(file: str | PathLike[str], proof: Proof, path: int = -1) -> None:
    """Store or replace a proof in a closed archive.

    Parameters
    ----------
    file : path
        Replaced by a copy.
    proof : Proof
    path : int
        Number of the proved path.

    Raises
    ------
    ArchiveError
        If the file cannot be read or replaced, or lacks that path.
    """
    name = File(os.path.realpath(as_file("file", file)))
    with (
        open_archive(name) as source,
        closing(own(name, source.contents.descriptor, source.attributes.get("process"))),
    ):
        number = range(len(source))[path]
        with beside(name) as part:
            shutil.copyfile(name, part)
            with h5py.File(part, "r+") as copy:
                group = copy.require_group(GROUP)
                if str(number) in group:
                    del group[str(number)]
                made = group.create_group(str(number))
                made.attrs["summary"] = str(proof)[:1000]
                columns = {name: np.ascontiguousarray(getattr(proof.cells, name)) for name in COLUMNS}
                write_arrays(
                    made, {name: values.astype("i8" if name == "slabs" else "f8") for name, values in columns.items()}
                )
            publish(part, name, replace=True)


def read_cells(archive: Archive, path: int) -> Cells | None:
    """Cells of a stored proof, or None."""
    try:
        root = archive.contents.root
        if GROUP not in names(root) or str(path) not in names(member(root, GROUP)):
            return None
        columns = read_arrays(member(root, f"{GROUP}/{path}"), archive.contents.allowance)
        _check(columns)
        return Cells(**columns)
    except FAULTS as error:
        raise ArchiveError(
            f"{archive.contents.file}: the certificate of path {path} is damaged ({short(error)})"
        ) from None


def _check(columns: dict[str, Any]) -> None:
    # Cells may be wider than the path (`certifying.SupportsWrittenOut`).
    count, width = columns["begin"].shape
    for name in COLUMNS:
        shape = (count,) if name == "slabs" else (count, 2 if name == "place" else width)
        kind = "i" if name == "slabs" else "f"
        if columns[name].shape != shape or columns[name].dtype.kind != kind or not np.isfinite(columns[name]).all():
            raise StructureError(f"{name} is of another shape, or holds numbers that are not finite")
    if not all(1 <= slabs <= _MOST_SLABS for slabs in columns["slabs"]):
        raise StructureError("slabs are not from 1 to 64")


_MOST_SLABS = 64
"""Our files hold fewer; more take long to check."""


def recheck(file: str | PathLike[str], homotopy: Any = None, *, trust: Sequence[Any] = ()) -> list[Proof]:
    """Check every condition of an archive's proofs again.

    Parameters
    ----------
    file : path
    homotopy : Homotopy, optional
        Needed if the file cannot rebuild it.
    trust : sequence of class or function
        As for `resume`.

    Returns
    -------
    list of Proof
        One for each path; without a certificate it is one gap.

    Raises
    ------
    ArchiveError
        If the file cannot be read, a certificate is damaged, or the homotopy cannot be made.
    """
    with open_archive(file) as source:
        if homotopy is None:
            checkpoint = source.checkpoint()
            if checkpoint is None:
                raise ArchiveError(f"{source.file}: says nothing of its homotopy; pass homotopy=")
            homotopy = stored_homotopy(source, checkpoint, registry(trust))
        out = []
        for number in range(len(source)):
            path, cells = source.path(number), read_cells(source, number)
            if cells is None:
                span = float(path.arclength[0]), float(path.arclength[-1])
                out.append(Proof.empty(path.u.shape[1], Gap(*span, "the file holds no certificate")))
            else:
                out.append(checked_again(cells, path, homotopy))
        return out
