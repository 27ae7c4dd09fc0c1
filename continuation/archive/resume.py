"""`resume`: continue an interrupted path exactly; `add_proof`, `recheck`: proofs, in the group `/certificate`."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from os import PathLike
from pathlib import Path as File
from typing import Any, Unpack

import h5py
import numpy as np

from continuation.archive.atomic import ArchiveError, as_file, beside, new_file, own, publish, short
from continuation.archive.codec import UnknownError, decode, registry
from continuation.archive.contents import FAULTS
from continuation.archive.growing import check_homotopy, copy, share_of
from continuation.archive.hdf5 import StructureError, member, read_arrays, write_arrays
from continuation.archive.provenance import OPTIONS, Checkpoint, pack, process, whole
from continuation.archive.reader import Archive, open_archive
from continuation.archive.rows import kept_whole
from continuation.archive.writer import PathLog
from continuation.certificate.cells import COLUMNS, Cells
from continuation.certificate.certifying import recheck as checked_again
from continuation.certificate.proof import Gap, Proof
from continuation.path import Path
from continuation.status import Status
from continuation.step.options import OBSERVER, Options, documented, each
from continuation.step.tracer import Observer, Tracer
from continuation.version import __version__

RESUMABLE = (
    Status.TRACING,
    Status.INTERRUPTED,
    Status.BUDGET_EXHAUSTED,
    Status.STEP_TOO_SMALL,
    Status.LEFT_DOMAIN,
    Status.PREDICTOR_FAILED,
    Status.ABANDONED,
    Status.RAISED,
)


@documented
def resume(
    file: str | PathLike[str],
    homotopy: Any = None,
    *,
    archive: str | PathLike[str] | None = None,
    observers: tuple[Observer, ...] = (),
    trust: Sequence[Any] = (),
    keep: str = "all",
    **options: Unpack[Options],
) -> Path:
    """Continue the last path of an archive, bit for bit like an uninterrupted trace.

    A copy up to the last checkpoint replaces the file. Given options replace the file's. A budget's seconds count from
    now.

    Parameters
    ----------
    file : path
        Interrupted, killed, recovered, or out of budget.
    homotopy : Homotopy, optional
        Needed if the file cannot rebuild it.
    archive : path, optional
        A new file; default: `file`.
    observers : tuple of Observer
    trust : sequence of class or function
        Objects the file may make besides the library's and registered homotopies.
    keep : str
        As for `PathLog`.
    {options}

    Returns
    -------
    Path
        The whole path. Earlier tangents are NaN unless archived.

    Raises
    ------
    ArchiveError
        If the file cannot be read, replaced or resumed, or a part must be passed.
    ValueError
        If `homotopy` is not the file's.
    """
    name = as_file("file", file)
    target = File(os.path.realpath(name)) if archive is None else new_file("archive", archive)
    whole_path = kept_whole(keep)
    each("observers", observers, OBSERVER)
    for option in ("start", "state"):
        if option in options:
            raise ValueError(f"{option}: a resumed path begins where the archive ends")
    known = registry(trust)
    with ExitStack() as stack:
        source = stack.enter_context(open_archive(name))
        if archive is None:
            stack.enter_context(closing(own(target, source.contents.descriptor)))
        checkpoint = _checkpoint(source, options)
        tracer = _tracer(source, checkpoint, known, homotopy, options)
        rows = source.rows(checkpoint.path).start + checkpoint.rows
        stored = float(source.points.some("residual_norm", slice(rows - 1, rows))[0])
        check_homotopy(tracer.homotopy, checkpoint.state.here.u, stored)
        parent = f"{source.file.name} ({source.attributes.get('created', '')})"
        store = copy(
            [share_of(source, last=checkpoint.path, points=rows)],
            target,
            what=f"resumed from path {checkpoint.path}, point {checkpoint.state.index} of {parent}",
            more={**process(), "parent": parent},
            checkpoint=pack(checkpoint),
            replace=archive is None,
            grows=True,
        )
    log = PathLog.continued(store, checkpoint, tracer, whole_path)
    try:
        with open_archive(store.file) as held:
            before = held.path(checkpoint.path, keep=keep)
        tracer.path.steps, tracer.path.events[:] = before.steps, before.events
        tracer.observers = (log, *observers)
        steps = iter(tracer)
        # A resumed tracer's extra factorisation is not counted.
        next(steps)
        for counter, count in checkpoint.counts.items():
            setattr(tracer.counts, counter, count)
        for _ in steps:
            pass
    finally:
        log.close()
        tracer.path.seconds += checkpoint.seconds
    return tracer.path


def _tracer(
    source: Archive, checkpoint: Checkpoint, known: Mapping[str, Any], given: Any, options: Mapping[str, Any]
) -> Tracer:
    homotopy = stored_homotopy(source, checkpoint, known) if given is None else given
    trees: Any = checkpoint.run.get("options", {})
    names = [name for name in OPTIONS if isinstance(trees, dict) and name in trees and name not in options]
    stored = {name: _made(source, name, trees[name], whole, known, f"{name}=") for name in names}
    settings: Any = {"box": None, **stored, **options}
    try:
        tracer = Tracer(homotopy, state=checkpoint.state, **settings)
        known_events, watched = len(checkpoint.state.monitors), len(tracer.settings.events)
        if known_events != watched:
            raise ValueError(f"events: expected {known_events}, as in the archive, found {watched}")
        return tracer
    except (TypeError, ValueError, AttributeError, RecursionError) as error:
        fault = str(error).partition(":")[0]
        if fault in options or (given is not None and fault not in settings):
            raise
        raise ArchiveError(f"{source.file}: what it stores cannot be used ({short(error)})") from None


def _checkpoint(source: Archive, options: Mapping[str, Any]) -> Checkpoint:
    if not len(source):
        raise ArchiveError(f"{source.file}: holds no point to resume from; trace it again")
    last = len(source) - 1
    status, checkpoint = source.status(last), source.checkpoint()
    writer, none = source.attributes.get("library_version", "unknown"), checkpoint is None or checkpoint.path != last
    other = (
        f"path {last} was written by version {writer!s:.20} and has no state that version {__version__} resumes "
        f"(a state resumes within its major version); "
        f"go on from its last point by trace(homotopy, start=open_archive({str(source.file)!r})[{last}])"
    )
    spent = f"the budget of path {last} is used up; pass budget=, a larger one (in a shell --steps)"
    refused = {
        f"path {last} has ended ({status.name}), there is nothing to resume": status not in RESUMABLE,
        spent: status is Status.BUDGET_EXHAUSTED and "budget" not in options,
        f"path {last} has no state to resume from; trace it again": none and not source.paths["n_points"][last],
        other: none,
    }
    for what, wrong in refused.items():
        if wrong:
            raise ArchiveError(f"{source.file}: {what}")
    assert checkpoint is not None
    return checkpoint


def stored_homotopy(source: Archive, checkpoint: Checkpoint, known: Mapping[str, Any]) -> Any:
    """The homotopy that the file describes; `known` is the `registry`."""
    tree: Any = checkpoint.run["homotopy"]
    fetch: Callable[[Any], Any] = whole
    if isinstance(tree, dict) and tree.get("problem"):
        described, arrays = source.contents.problem()
        tree, fetch = source.contents.guarded(lambda: json.loads(described)), arrays.__getitem__
    return _made(source, "the homotopy", tree, fetch, known, "homotopy= or --homotopy")


def _made(
    source: Archive, name: str, tree: Any, fetch: Callable[[Any], Any], known: Mapping[str, Any], hint: str
) -> Any:
    try:
        if isinstance(tree, dict) and "unstorable" in tree:
            raise UnknownError(tree["unstorable"])
        return decode(tree, fetch, known)
    except UnknownError as error:
        said = f"{name} cannot be made from the file ({short(error)}); pass {hint}"
        raise ArchiveError(f"{source.file}: {said}") from None


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
        closing(own(name, source.contents.descriptor)),
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
        if GROUP not in set(root) or str(path) not in set(member(root, GROUP)):
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
    shapes = {"slabs": (count,), "place": (count, 2)}
    for name in COLUMNS:
        values, kind = columns[name], "i" if name == "slabs" else "f"
        if (
            values.shape != shapes.get(name, (count, width))
            or values.dtype.kind != kind
            or not np.isfinite(values).all()
        ):
            raise StructureError(f"{name} is of another shape, or holds numbers that are not finite")
    # The library's proofs have fewer slabs; more take long to check.
    if not all(1 <= slabs <= 64 for slabs in columns["slabs"]):
        raise StructureError("slabs are not from 1 to 64")


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
