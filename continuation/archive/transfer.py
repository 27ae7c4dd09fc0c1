"""Operations on archives: `merge`, `export`, `recover`, `describe`, and the union of a sweep's parts."""

from __future__ import annotations

import csv
import gzip
import json
import os
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from functools import partial
from itertools import groupby, pairwise, starmap
from os import PathLike
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import evolve

from continuation.archive.atomic import ArchiveError, as_file, beside, check_new, new_file, own, publish
from continuation.archive.contents import Contents
from continuation.archive.growing import Share, copy, leading, share_of
from continuation.archive.provenance import pack, process
from continuation.archive.reader import Archive, open_archive
from continuation.archive.resume import RESUMABLE
from continuation.archive.rows import ROWS_AT_ONCE, Table, flat, record_of, row_columns
from continuation.archive.schema import COUNT_NAMES, KINK_PART, MESSAGE, TABLES, text
from continuation.arguments.checks import expect
from continuation.path import Path
from continuation.status import Kind, Status


def merge(files: Iterable[str | PathLike[str]], target: str | PathLike[str]) -> File:
    """Concatenate archives and renumber their paths.

    Paths keep homotopy and source; settings and problem are the first file's. The result cannot be resumed.

    Parameters
    ----------
    files : iterable of path
    target : path
        Must not exist.

    Raises
    ------
    ValueError
        If there are no files.
    ArchiveError
        If a file is no archive, numbers of unknowns differ, files share a path, or `target` exists.
    """
    several = isinstance(files, Iterable) and not isinstance(files, (str, bytes, PathLike))
    expect(several, "files", "names of archives, in a list", files, TypeError)
    files = list(files)
    expect(files, "files", "at least one archive", files)
    whole = new_file("target", target)
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        shares = [share_of(archive) for archive in archives]
        names = ", ".join(archive.file.name for archive in archives[:8]) + (", ..." if len(archives) > 8 else "")
        _refuse_duplicates(archives, shares)
        copy(shares, whole, what=f"merged from {len(archives)} files: {names}", more=process())
    return whole


def _refuse_duplicates(archives: Sequence[Archive], shares: Sequence[Share]) -> None:
    known: dict[bytes, str] = {}
    for archive, share in zip(archives, shares):
        for k, source in enumerate(share.paths.get("source", ())):
            # Without the name, since files may be renamed.
            key = b" ".join(source.split(b" ", 2)[:2])
            if key in known:
                raise ArchiveError(f"{archive.file}: its path {k} is {known[key]} as well; expected each path once")
            known[key] = f"path {k} of {archive.file}"


def gather(files: Sequence[File], target: File) -> None:
    """Merge parts of a sweep in member order; paths with another number of unknowns than the first keep no points."""
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        places = sorted((m, i, k) for i, one in enumerate(archives) for k, m in enumerate(one.paths["member"].tolist()))
        runs = [[*run] for _, run in groupby(enumerate(places), lambda at: (at[1][1], at[1][2] - at[0]))]
        shares = [share_of(archives[run[0][1][1]], run[0][1][2], run[-1][1][2] + 1) for run in runs]
        unknowns = leading(shares).layout.unknowns
        made = [_of_size(share, unknowns, target) for share in shares]
        copy(made, target, what=f"a sweep of {len(places)} paths", more=process())


def _of_size(share: Share, unknowns: int, target: File) -> Share:
    found = share.layout.unknowns
    if found == unknowns or not share.size:
        return share
    reason = f"ValueError: homotopy: expected {unknowns} unknowns, as in {target} so far, found {found}"
    paths, had = dict(share.paths), share.paths["n_points"] > 0
    for name, value in {"status": int(Status.RAISED), "message": text(reason, MESSAGE.length), "n_points": 0}.items():
        paths[name] = np.where(had, np.array(value, paths[name].dtype), paths[name])
    return evolve(share, paths=paths, rows=slice(0, 0))


def export(file: str | PathLike[str], target: str | PathLike[str]) -> list[File]:
    """Write an archive in another format.

    The suffix decides: ``.nc``, ``.nc4``, ``.h5`` for compressed netCDF-4; ``.csv``, ``.csv.gz`` for two tables,
    ``name.csv`` (points) and ``name.paths.csv``.

    Parameters
    ----------
    file, target : path

    Returns
    -------
    list of pathlib.Path

    Raises
    ------
    ValueError
        For another suffix.
    ArchiveError
        If `file` is no archive or a target exists.
    """
    name = as_file("target", target)
    with open_archive(file) as archive:
        if name.suffix in (".nc", ".nc4", ".h5"):
            check_new(name)
            copy([share_of(archive)], name, what=f"exported from {archive.file.name}", compressed=True)
            return [name]
        for suffix in (".csv", ".csv.gz"):
            if name.name.endswith(suffix):
                return _export_text(archive, name, name.with_name(f"{name.name.removesuffix(suffix)}.paths{suffix}"))
    raise ValueError(f"target: expected a suffix .nc, .nc4, .h5, .csv or .csv.gz, found {name.name!r}")


def _export_text(archive: Archive, points: File, paths: File) -> list[File]:
    for target in (points, paths):
        check_new(target)
    opened: Any = gzip.open if points.suffix == ".gz" else open
    for target, table in ((points, archive.points), (paths, archive.paths)):
        with beside(target) as part:
            with opened(part, "xt", encoding="utf-8", newline="") as out:
                writer = csv.writer(out)
                for start in range(0, max(table.size, 1), ROWS_AT_ONCE):
                    columns = flat(table.block(slice(start, min(start + ROWS_AT_ONCE, table.size))))
                    writer.writerows([[*columns]] if not start else [])
                    writer.writerows(zip(*(values.tolist() for values in columns.values())))
            publish(part, target)
    return [points, paths]


def recover(file: str | PathLike[str]) -> File:
    """Replace a killed writer's file by its committed rows.

    An unfinished path becomes INTERRUPTED and can be resumed. Sound, closed files stay. In a damaged file, each path
    ends before its first damaged row; the original becomes ``NAME.damaged``.

    Parameters
    ----------
    file : path

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    ArchiveError
        If the file is no archive, read-only, being written, or its structure is damaged.
    """
    name = as_file("file", file)
    real = File(os.path.realpath(name))
    with closing(Contents(name, salvage=True)) as contents:
        sound = {table: contents.sound(table) for table in TABLES}
        lost = {table: contents.stated.rows(table) - int(sound[table].sum()) for table in TABLES}
        shares, checkpoint, damaged = [], None, any(lost.values())
        if damaged:
            shares = _salvaged(contents, sound)
            contents.flaws.append(f"{lost['point']} points were not what was written")
        else:
            archive = Archive(contents)
            growing = archive.paths["status"] == int(Status.TRACING)
            if contents.closed_by_writer and not contents.flaws and not growing.any():
                return name
            shares, checkpoint = [share_of(archive)], archive.checkpoint()
            _interrupted(shares[0].paths, growing, "Its writer was killed.")
        with closing(own(real, contents.descriptor)):
            if damaged and len(shares) == 1:
                raise ArchiveError(f"{name}: is damaged, and none of its rows is sound")
            if damaged:
                publish(real, real.with_name(f"{real.name}.damaged"))
            packed = None if checkpoint is None else pack(checkpoint)
            copy(shares, real, what="; ".join(("recovered", *contents.flaws)), checkpoint=packed, replace=True)
    return name


def _interrupted(paths: Mapping[str, Any], which: Any, why: str) -> None:
    paths["status"][which] = int(Status.INTERRUPTED)
    paths["message"][which] = text(f"{Status.INTERRUPTED} {why}", MESSAGE.length)


def _salvaged(contents: Contents, sound: Mapping[str, Any]) -> list[Share]:
    """An empty share, then one for each path: its sound rows before its first damaged one."""
    layout, points, paths = contents.layout, contents.table("point"), contents.table("path")
    some = partial(Share, layout, contents.event_names, points=points, origin=contents)
    runs, shares = dict(_runs(points, sound["point"])), [some(layout.filled({}, "path", 0), rows=slice(0, 0))]
    for number in sorted({*runs, *np.flatnonzero(sound["path"]).tolist()}):
        rows = runs.get(number, slice(0, 0))
        row = row_columns({**record_of(Path(), None, ()), "path": number, "member": number, "n_points": -1}, layout)
        if number < paths.size and sound["path"][number]:
            row = {name: values.copy() for name, values in paths.block(slice(number, number + 1)).items()}
        if row["n_points"][0] != rows.stop - rows.start:
            row["n_points"][:] = rows.stop - rows.start
            _interrupted(row, 0, "The rest of it was damaged.")
        shares.append(some(row, rows=rows, first=number))
    return shares


def _runs(points: Table, sound: Any) -> Iterator[tuple[int, slice]]:
    edges = np.flatnonzero(np.diff(np.concatenate(([False], sound, [False])).astype("i1"))).reshape(-1, 2)
    for rows in starmap(slice, edges.tolist()):
        paths, kinds = (points.some(name, rows) for name in ("path_index", "kind"))
        changes = [0, *(np.flatnonzero(np.diff(paths)) + 1).tolist(), len(paths)]
        for first, last in pairwise(changes):
            # The end of a path alone is useless.
            if kinds[first] == Kind.START:
                yield int(paths[first]), slice(rows.start + first, rows.start + last)


_LISTED = 12
"""Paths, and points, with a line of their own."""

_SOFTWARE = "library", "python", "numpy", "scipy", "h5py", "hdf5"
_SETTINGS = "predictor", "corrector", "controller", "metric", "target"


def describe(archive: Archive) -> str:
    """Text of ``continuation inspect``.

    Parameters
    ----------
    archive : Archive

    Raises
    ------
    ArchiveError
        If the file is damaged.
    """
    expect(
        isinstance(archive, Archive), "archive", "an open Archive, as open_archive(file) returns", archive, TypeError
    )
    page = archive.contents.guarded(lambda: "\n".join(_lines(archive)))
    # A title must not send control codes to the terminal.
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in page) + "\n"


def _lines(archive: Archive) -> Iterator[str]:
    about: Mapping[str, Any] = {"title": "", "settings": "{}", "parameters": "{}", **archive.attributes}
    settings, parameters = json.loads(about["settings"]), json.loads(about["parameters"])
    named = {name: settings[name] for name in _SETTINGS if name in settings}
    said = {
        "file": f"{archive.file}, {archive.contents.size:,} bytes, {about['schema']}",
        "holds": f"{len(archive)} paths, {archive.points.size} points; unknowns: {archive.layout.unknowns}",
        "when": f"{about.get('created', '')} on {about.get('host', '')}",
        "homotopy": f"{about.get('homotopy', '')} ({about.get('homotopy_distribution', '')})".removesuffix(" ()"),
        "parameters": _fields(parameters.get("dict", parameters)),
        "settings": _fields(named),
        "software": ", ".join(f"{name} {about.get(f'{name}_version', '?')}" for name in _SOFTWARE),
        "BLAS": f"{about.get('blas', '')}, threads {about.get('blas_threads', '')}",
        "parent": str(about.get("parent", "")),
        "work": ", ".join(f"{int(archive.paths[name].clip(0).sum())} {name}" for name in COUNT_NAMES.values()),
        "seconds": f"{np.nansum(archive.paths['wall_time']):.3g}",
    }
    title = str(about["title"])
    yield from (title, "=" * len(title))
    for name, told in (*said.items(), *(("history", line) for line in str(about.get("history", "")).splitlines())):
        yield from (f"  {name:<11}{textwrap.shorten(told, 300, placeholder=' ...')}",) if told else ()
    yield from ("", "Paths", "-----", *_paths(archive), "", "Starts, events and ends", "-----------------------")
    yield from (*_points(archive), "", _hint(archive))


def _fields(trees: Mapping[str, Any]) -> str:
    plain = {name: tree.get("class", "...") if isinstance(tree, dict) else tree for name, tree in trees.items()}
    return ", ".join(f"{name}={str(value).rpartition(':')[2]}" for name, value in plain.items())


def _paths(archive: Archive) -> Iterator[str]:
    statuses, members, messages = (archive.paths[name] for name in ("status", "member", "message"))
    for value, count in zip(*np.unique(statuses, return_counts=True)):
        yield f"  {count:>8}  {Status(int(value)).name}"
    for row in np.argsort(~np.isin(statuses, RESUMABLE), kind="stable")[:_LISTED].tolist():
        text = messages[row].decode(errors="replace") or "still being traced, or its writer was killed"
        yield f"  path {row} (member {members[row]}): {text}"


def _points(archive: Archive) -> Iterator[str]:
    points, lengths = archive.points, archive.paths["n_points"]
    ends = (np.cumsum(lengths) - 1)[lengths > 0]
    events = np.flatnonzero((points["kind"] != Kind.REGULAR) & (points["role"] != KINK_PART))
    for number, name in enumerate(archive.event_names):
        yield f"  {np.count_nonzero(points['event_index'] == number):>8}  {name}"
    yield f"  {'':<24}{'lambda':>16}{'arclength':>14}{'residual':>10}  y"
    for row in np.union1d(events, ends).astype(int)[:_LISTED].tolist():
        at = {name: points.some(name, slice(row, row + 1))[0] for name in points}
        name = archive.event_names[at["event_index"]] if at["event_index"] >= 0 else Kind(int(at["kind"])).flag
        y = ", ".join(f"{value:.6g}" for value in at["y"][:4])
        numbers = f"{at['parameter']:>16.10g}{at['arclength']:>14.8g}{at['residual_norm']:>10.1e}"
        yield f"  {name[:23]:<24}{numbers}  ({y}{', ...' if at['y'].size > 4 else ''})"


def _hint(archive: Archive) -> str:
    if not archive.closed_by_writer:
        return "Its writer is still at work, or was killed: then `continuation recover` makes the file whole."
    last, checkpoint = len(archive) - 1, archive.checkpoint()
    if checkpoint is None or checkpoint.path != last or archive.status(last) not in RESUMABLE:
        return ""
    name = str(archive.attributes.get("homotopy", "")).replace("__main__:", "MODULE:")
    makeable = name.startswith("continuation.") or archive.attributes.get("homotopy_entry_point", "")
    command = f"continuation resume {archive.file}" + ("" if makeable else f" --homotopy {name}")
    if archive.status(last) is Status.BUDGET_EXHAUSTED:
        return f"Path {last} can be resumed with more steps: `{command} --steps N`."
    return f"Path {last} can be resumed: `{command}`."
