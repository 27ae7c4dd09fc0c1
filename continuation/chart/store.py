"""Results as an HDF5 file of the archive's kind: netCDF-4 dimensions, units and meanings on every variable.

`h5py`, `xarray` (engine h5netcdf) and `continuation.chart.read` all open it.
"""

from __future__ import annotations

from io import BytesIO
from os import PathLike
from pathlib import Path as File
from typing import Any

import h5py
import numpy as np
from h5py import h5s

from continuation.archive.atomic import beside, check_new, publish
from continuation.archive.errors import ArchiveError
from continuation.archive.provenance import history
from continuation.archive.schema import TEXT, Column, text
from continuation.archive.store import LIBVER
from continuation.chart.results import Results, Row
from continuation.counts import Counts

SCHEMA = "continuation-chart-1"
"""Additions keep the name; a change of meaning would be `continuation-chart-2`, which this reader refuses."""

_NAME = 80
_RUN = ("run",)
_LABELS = (
    Column("problem", f"utf8:{_NAME}", "1", "problem", _RUN),
    Column("family", f"utf8:{_NAME}", "1", "family of problems that differ in size or seed alone", _RUN),
    Column("method", f"utf8:{_NAME}", "1", "method", _RUN),
    Column("failure", f"utf8:{_NAME}", "1", "how the run failed; empty if it did not", _RUN),
    Column("message", f"utf8:{TEXT}", "1", "how the run ended, in words", _RUN),
)
_NUMBERS = (
    Column("n", "i8", "1", "size of the problem", _RUN),
    Column("seed", "i8", "1", "seed of the problem's random numbers; -1 where there are none", _RUN),
    Column("rung", "f8", "1", "value of the ladder; NaN where the ladder does not concern the method", _RUN),
    Column("turns", "i8", "1", "turning points found", _RUN),
    Column("seconds", "f8", "s", "processor time, least of the repeated runs", _RUN),
    Column("repeats", "i8", "1", "timed runs after the first", _RUN),
)
_COUNTS = tuple(Column(name, "i8", "1", f"count of {name}", _RUN) for name in Counts().as_dict())
_ERROR = "error_"


def write(results: Results, file: str | PathLike[str]) -> File:
    """Write results to a new file.

    Parameters
    ----------
    results : Results
    file : path
        Must not exist.

    Raises
    ------
    ArchiveError
        If the file exists, or its directory does not, or may not be written, or the disk is full.
    """
    name = File(file)
    check_new(name)
    # In memory, since HDF5 ends the process where it cannot write what it closes.
    image = BytesIO()
    with h5py.File(image, "w", libver=LIBVER) as h5:
        h5.attrs.update(
            {
                "Conventions": "CF-1.11",
                "schema": SCHEMA,
                "title": results.title,
                "study": results.study,
                "ladder": results.ladder,
                "errors": " ".join(results.errors),
                "work": " ".join(results.work),
                **results.provenance,
                **history({}, "created"),
            }
        )
        run = h5.create_dataset("run", data=np.arange(len(results.rows), dtype="i8"))
        run.attrs.update({"units": "1", "long_name": "number of the run"})
        run.make_scale("run")
        for column, values in _columns(results):
            _put(h5, column, values)
    with beside(name) as part:
        part.write_bytes(image.getvalue())
        publish(part, name)
    return name


def _columns(results: Results) -> list[tuple[Column, list[Any]]]:
    rows = results.rows
    found: list[tuple[Column, list[Any]]] = [
        (column, [text(getattr(row, column.name), column.length) for row in rows]) for column in _LABELS
    ]
    found += [(column, [getattr(row, column.name) for row in rows]) for column in _NUMBERS]
    found += [(column, [getattr(row.counts, column.name) for row in rows]) for column in _COUNTS]
    for name, label in results.errors.items():
        column = Column(f"{_ERROR}{name}", "f8", "1", label, _RUN)
        found.append((column, [row.errors[name] for row in rows]))
    return found


def _put(h5: Any, column: Column, values: list[Any]) -> None:
    dtype = h5py.string_dtype("utf-8", column.length) if column.length else np.dtype(column.dtype)
    dataset = h5.create_dataset(column.name, (len(values),), dtype)
    # With the type of the file, since h5py does not convert bytes of numpy's to text of a fixed length.
    dataset.id.write(h5s.ALL, h5s.ALL, np.array(values, dtype=column.storage), dataset.id.get_type())
    dataset.attrs.update(column.attributes)
    dataset.dims[0].attach_scale(h5["run"])


def read(file: str | PathLike[str]) -> Results:
    """Read the results of a study.

    Parameters
    ----------
    file : path
        Written by `write`.

    Raises
    ------
    ArchiveError
        If the file cannot be opened, or holds something else.
    """
    name = File(file)
    try:
        opened = h5py.File(name, "r")
    except OSError as error:
        raise ArchiveError(f"{name}: cannot be opened as HDF5 ({str(error).splitlines()[0][:160]})") from None
    with opened as h5:
        schema = h5.attrs.get("schema")
        if schema != SCHEMA:
            raise ArchiveError(f"{name}: has the schema {schema!r}, expected {SCHEMA!r}")
        attributes = {key: str(value) for key, value in h5.attrs.items()}
        labels = {name: str(h5[f"{_ERROR}{name}"].attrs["long_name"]) for name in attributes["errors"].split()}
        data = {key: h5[key][:].tolist() for key in h5}
    rows = tuple(_row(data, labels, k) for k in range(len(data["run"])))
    known = ("Conventions", "schema", "title", "study", "ladder", "errors", "work", "history")
    return Results(
        study=attributes["study"],
        title=attributes["title"],
        ladder=attributes["ladder"],
        errors=labels,
        work=tuple(attributes["work"].split()),
        rows=rows,
        provenance={key: value for key, value in attributes.items() if key not in known},
    )


def _row(data: dict[str, list[Any]], labels: dict[str, str], k: int) -> Row:
    return Row(
        **{column.name: data[column.name][k].decode() for column in _LABELS},
        **{column.name: data[column.name][k] for column in _NUMBERS},
        counts=Counts(**{column.name: data[column.name][k] for column in _COUNTS}),
        errors={name: data[f"{_ERROR}{name}"][k] for name in labels},
    )
