"""`export`: an archive as a compressed netCDF-4 file, or as two tables of text."""

from __future__ import annotations

import csv
import gzip
import os
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path as File
from typing import Any

from continuation.archive.atomic import as_file, beside, check_new, publish
from continuation.archive.copies import check_level, share_of, write_copy
from continuation.archive.provenance import history
from continuation.archive.reader import Archive, open_archive
from continuation.archive.store import put
from continuation.archive.tables import Table

_ROWS = 4096


def export(file: str | PathLike[str], target: str | PathLike[str], *, compression: int = 4) -> list[File]:
    """Write an archive in another form, told by the suffix of `target`.

    ``.nc``, ``.nc4``, ``.h5``: one netCDF-4 file, with gzip and shuffle. ``.csv``, ``.csv.gz``: two tables,
    ``name.csv`` for the points and ``name.paths.csv`` for the paths, numbers in full precision.

    Parameters
    ----------
    file, target : path
    compression : int
        Level of gzip, 0 (none) to 9. CSV is compressed by its suffix alone.

    Returns
    -------
    list of pathlib.Path
        The files written.

    Raises
    ------
    ValueError
        For another suffix, or a level that gzip does not know.
    ArchiveError
        If `file` is no archive, or a target exists.
    """
    check_level(compression)
    name = as_file("target", target)
    with open_archive(file) as archive:
        if name.suffix in (".nc", ".nc4", ".h5"):
            attributes = {**archive.attributes, **history(archive.attributes, f"exported from {archive.file.name}")}
            check_new(name)
            share = share_of(archive)
            put(name, lambda part: write_copy([share], part, attributes=attributes, compression=compression))
            return [name]
        for suffix in (".csv", ".csv.gz"):
            if name.name.endswith(suffix):
                return _export_text(archive, name, name.with_name(f"{name.name.removesuffix(suffix)}.paths{suffix}"))
    raise ValueError(f"target: expected a suffix .nc, .nc4, .h5, .csv or .csv.gz, found {name.name!r}")


def _export_text(archive: Archive, points: File, paths: File) -> list[File]:
    for target in (points, paths):
        check_new(target)
    with beside(points) as first, beside(paths) as second:
        for part, table in ((first, archive.points), (second, archive.paths)):
            _write_text(part, table, points.suffix == ".gz")
        # The points last: who sees them sees both.
        publish(second, paths)
        publish(first, points)
    return [points, paths]


def _write_text(part: File, table: Table, compressed: bool) -> None:
    opened: Any = gzip.open if compressed else open
    with opened(part, "xt", encoding="utf-8", newline="") as out:
        writer = csv.writer(out)
        for start in range(0, max(table.size, 1), _ROWS):
            names, columns = _spread(table.block(slice(start, min(start + _ROWS, table.size))))
            writer.writerows([names] if not start else [])
            writer.writerows(zip(*columns))
    with part.open("rb") as written:
        os.fsync(written.fileno())


def _spread(block: Mapping[str, Any]) -> tuple[list[str], list[Iterable[Any]]]:
    """Names and columns, a matrix as one column a component; Python prints floats in full precision."""
    names: list[str] = []
    columns: list[Iterable[Any]] = []
    for name, values in block.items():
        if values.dtype.kind == "S":
            names.append(name)
            columns.append([value.decode(errors="replace") for value in values])
        elif values.ndim == 1:
            names.append(name)
            columns.append(values.tolist())
        else:
            names += [f"{name}_{i}" for i in range(values.shape[1])]
            columns += values.T.tolist()
    return names, columns
