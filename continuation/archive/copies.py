"""Paths as columns, read from a file or held in memory, and appended elsewhere.

A `Share` is some paths with their points; `append` adds one to a file that grows, `write_copy` makes a new file of
several. Recovery, resuming, merging, export, diagrams and the parts of a sweep are shares and one of the two.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from numbers import Integral
from os import PathLike
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.atomic import ArchiveError, as_file, check_new
from continuation.archive.contents import Contents
from continuation.archive.provenance import history, process
from continuation.archive.reader import Archive, open_archive
from continuation.archive.schema import ORIGIN_COLUMNS, SCHEMA, TEXT, Column, Layout, text
from continuation.archive.store import Store, put
from continuation.arguments.checks import complain
from continuation.status import Status

Block = dict[str, Any]

_BLOCK_BYTES, _BLOCK_ROWS = 1 << 23, 4096
"""Of what is copied at once, and so of the blocks that a reader checks whole."""


@frozen(eq=False)
class Share:
    """Some paths and their points.

    `paths`: Rows of the path table, by column. `points`: Which rows of the point table; of the last path it may be the
    first ones only. `fetch`: (column, rows) -> numbers. `names`: What `event_index` counts. `first`: The number that
    the first path has in `path_index`. `origin`: The open file, where it is of one.
    """

    layout: Layout
    names: Sequence[str]
    paths: Mapping[str, Any]
    points: slice
    fetch: Callable[[str, slice], Any]
    first: int = 0
    origin: Contents | None = None

    @classmethod
    def of(cls, contents: Contents, paths: Mapping[str, Any], points: slice, first: int = 0) -> Share:
        """A share of an open file."""
        return cls(
            contents.layout, contents.event_names, paths, points, partial(contents.read, "point"), first, contents
        )

    @property
    def size(self) -> int:
        """The number of points."""
        return int(self.points.stop - self.points.start)


def check_level(compression: Any) -> None:
    """Raise unless gzip knows the level."""
    if not isinstance(compression, Integral) or not 0 <= int(compression) <= 9:
        raise ValueError(f"compression: expected a level from 0 to 9, found {compression!r}")


def share_of(archive: Archive, first: int = 0, last: int | None = None, points: int | None = None) -> Share:
    """Paths of an archive from number `first` to before `last`, or all, and their points, or so many from the first on.

    Each path has its homotopy and its source: those of the file, where its row does not say.
    """
    stop, contents = len(archive) if last is None else last, archive.contents
    paths, about, count = archive.paths.block(slice(first, stop)), contents.attributes, stop - first
    # Of files without an identifier the time, the process and the name must do.
    unnamed = f"{about.get('created', '')}/{about.get('process', '')}/{contents.file.name}".replace(" ", "_")
    identifier = about.get("identifier", unnamed)
    said = {
        "homotopy": [about.get("homotopy", "")] * count,
        "source": [f"{identifier} {first + k} {contents.file.name}" for k in range(count)],
    }
    for column in ORIGIN_COLUMNS:
        own = paths.get(column.name, np.zeros(count, dtype=column.storage))
        filled = np.array([text(str(value), column.length) for value in said[column.name]], dtype=column.storage)
        paths[column.name] = np.where(own == b"", filled, own)
    begin = archive.rows(first).start if count else 0
    end = begin + points if points is not None else archive.rows(stop - 1).stop if count else 0
    return Share.of(contents, paths, slice(begin, end), first)


def interrupt(paths: Mapping[str, Any]) -> None:
    """A path that was being traced when its writer died counts as interrupted."""
    open_ = paths["status"] == int(Status.TRACING)
    paths["status"][open_] = int(Status.INTERRUPTED)
    paths["message"][open_] = text(f"{Status.INTERRUPTED} Its writer was killed.", TEXT)


def leading(shares: Sequence[Share]) -> Contents:
    """The archive of the first point: its settings and problem stand for all; one of failures alone has none."""
    found = next((share for share in shares if share.size), shares[0]).origin
    assert found is not None
    return found


def append(store: Store, share: Share) -> None:
    """Add a share that is in memory to a file, in one commit."""
    held = store.committed
    points = _numbered(share, store, share.points, held.paths) if share.size else None
    store.commit(points, held.points, _rows(share, store.layout, held.paths), held.paths)


def write_copy(
    shares: Sequence[Share],
    part: File,
    *,
    attributes: Mapping[str, Any],
    checkpoints: Mapping[int, bytes] | None = None,
    compression: int = 0,
) -> Store:
    """Concatenate shares of open files into a new one, which is still open.

    Raises `ArchiveError` if the archives differ in the number of unknowns, or the file cannot be written.
    """
    layout = _joint(shares)
    store = Store(part, layout, {**attributes, "schema": SCHEMA}, leading(shares).problem(), compression=compression)
    try:
        for block in _blocks(shares, store):
            store.commit(block, store.committed.points)
        counts = np.cumsum([0, *(len(share.paths["path"]) for share in shares)]).tolist()
        rows = [_rows(share, layout, number) for share, number in zip(shares, counts)]
        store.commit(paths=_joined(rows) if counts[-1] else None, checkpoints=checkpoints)
    except BaseException:
        store.close()
        raise
    return store


def _joint(shares: Sequence[Share]) -> Layout:
    """One layout that holds them all: a column that only some have is missing elsewhere."""
    head = leading(shares)
    first, layouts = head.layout, [share.layout for share in shares]
    for share in shares:
        if share.layout.unknowns != first.unknowns and share.size and share.origin is not None:
            raise ArchiveError(
                f"{share.origin.file}: holds paths of {share.layout.unknowns} unknowns, {head.file} of "
                f"{first.unknowns}; one file holds one number"
            )
    return evolve(
        first,
        controller=max(layout.controller for layout in layouts),
        observed=tuple(sorted({name for layout in layouts for name in layout.observed})),
        scalars=tuple(sorted({name for layout in layouts for name in layout.scalars})),
        tangents=any(layout.tangents for layout in layouts),
        pieces=any(layout.pieces for layout in layouts),
        origins=any(layout.origins for layout in layouts) or len(layouts) > 1,
    )


def _blocks(shares: Sequence[Share], store: Store) -> Iterator[Block]:
    """The points of all of them, in blocks of nearly one size: what is small is joined, what is large cut."""
    size = min(max(_BLOCK_BYTES // (8 * (store.layout.unknowns + 16)), 1), _BLOCK_ROWS)
    waiting: list[Block] = []
    held = path = 0
    for share in shares:
        for start in range(share.points.start, share.points.stop, size):
            part = slice(start, min(start + size, share.points.stop))
            waiting.append(_numbered(share, store, part, path))
            held += part.stop - part.start
            if held >= size:
                yield _joined(waiting)
                waiting, held = [], 0
        path += len(share.paths["path"])
    if waiting:
        yield _joined(waiting)


def _joined(blocks: Sequence[Block]) -> Block:
    return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


def _numbered(share: Share, store: Store, rows: slice, path: int) -> Block:
    """Points as a block of the store's columns, with its numbers of events, the share's first path being `path`."""
    numbers = np.array([store.name_event(name) for name in share.names] + [-1], dtype="i2")
    block = {column.name: share.fetch(column.name, rows) for column in share.layout.point_columns}
    block["path_index"] = (block["path_index"] + (path - share.first)).astype("i4")
    if share.origin and (np.any(block["event_index"] >= len(share.names)) or np.any(block["event_index"] < -1)):
        raise share.origin.damaged(ValueError("its points refer to events that it does not name"))
    # The number -1, no event, finds the last entry.
    block["event_index"] = numbers[block["event_index"]]
    return filled(block, store.layout, store.layout.point_columns, rows.stop - rows.start)


def _rows(share: Share, layout: Layout, path: int) -> Block:
    """The share's rows of the path table, numbered from `path` on."""
    count = len(share.paths["path"])
    columns = {**share.paths, "path": np.arange(path, path + count)}
    return filled(columns, layout, layout.path_columns, count)


def filled(block: Mapping[str, Any], layout: Layout, columns: Sequence[Column], rows: int) -> Block:
    """The block in the columns of the layout; what it lacks is missing (NaN)."""
    whole = {}
    for column in columns:
        values, shape = block.get(column.name), (rows, *layout.width(column))
        if values is None or values.shape != shape:
            missing = np.full(shape, column.missing, dtype=column.storage)
            if values is not None:
                missing[:, : values.shape[1]] = values
            values = missing
        whole[column.name] = np.ascontiguousarray(values)
    return whole


# -- many files as one -----------------------------------------------------------------------------------------


def merge(
    files: Iterable[str | PathLike[str]], target: str | PathLike[str], *, compression: int = 0, title: str = ""
) -> File:
    """Concatenate archives, in the order given: paths are numbered anew, everything else stays as it is.

    Files of killed writers count with what was committed. Each path keeps its homotopy and its source, the columns
    ``homotopy`` and ``source`` of the path table; the settings and the problem of the first file are those of the new
    one, which cannot be resumed.

    Parameters
    ----------
    files : iterable of path
    target : path
        Must not exist.
    compression : int
        Level of gzip, 0 to 9.
    title : str

    Raises
    ------
    ValueError
        If there are no files, or gzip does not know the level.
    ArchiveError
        If one is no archive, has another number of unknowns than the first, or a path that another has too, or if
        `target` exists.
    """
    if isinstance(files, (str, bytes, PathLike)) or not isinstance(files, Iterable):
        raise complain(TypeError, "files", "names of archives, in a list", files)
    files = list(files)
    if not files:
        raise ValueError("files: expected at least one archive, found none")
    check_level(compression)
    whole = as_file("target", target)
    check_new(whole)
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        shares = [share_of(archive) for archive in archives]
        first = leading(shares).attributes
        names = ", ".join(archive.file.name for archive in archives[:8]) + (", ..." if len(archives) > 8 else "")
        attributes = {**first, **process(), **history(first, f"merged from {len(archives)} files: {names}")}
        if title:
            attributes["title"] = title
        _refuse_duplicates(archives, shares)
        put(whole, lambda part: write_copy(shares, part, attributes=attributes, compression=compression))
    return whole


def _refuse_duplicates(archives: Sequence[Archive], shares: Sequence[Share]) -> None:
    """A path that is in two of the files would count twice in every average."""
    known: dict[bytes, str] = {}
    for archive, share in zip(archives, shares):
        for k, source in enumerate(share.paths["source"]):
            # The identifier and the number; the name of the file may have been changed since.
            key = b" ".join(source.split(b" ", 2)[:2])
            if key in known:
                raise ArchiveError(f"{archive.file}: its path {k} is {known[key]} as well; expected each path once")
            known[key] = f"path {k} of {archive.file}"


def gather(files: Sequence[File], target: File) -> None:
    """Merge the parts of a sweep, in the order of its members; those of other sizes than the first keep no points."""
    with ExitStack() as stack:
        archives = [stack.enter_context(open_archive(file)) for file in files]
        places = []
        for archive in archives:
            archive.paths.load()
            places += [(member, archive, k) for k, member in enumerate(archive.paths["member"].tolist())]
        shares = [share_of(archive, k, k + 1) for _, archive, k in sorted(places, key=lambda place: place[0])]
        head = leading(shares)
        shares = [_of_size(share, head.layout.unknowns, target) for share in shares]
        attributes = {**head.attributes, **process(), **history(head.attributes, f"a sweep of {len(shares)} paths")}
        put(target, lambda part: write_copy(shares, part, attributes=attributes))


def _of_size(share: Share, unknowns: int, target: File) -> Share:
    """The share; if its paths have another number of unknowns, what they would be in one file: refused."""
    found = share.layout.unknowns
    if found == unknowns or not share.size:
        return share
    reason = f"ValueError: homotopy: expected {unknowns} unknowns, as in {target} so far, found {found}"
    paths = dict(share.paths)
    for name, value in {"status": int(Status.RAISED), "message": text(reason, TEXT), "n_points": 0}.items():
        paths[name] = np.full_like(paths[name], value)
    return evolve(share, paths=paths, points=slice(0, 0))
