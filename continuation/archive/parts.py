"""The files of the workers of a sweep: what is finished in them, who still writes them, and their merging."""

from __future__ import annotations

import glob
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path as File

from continuation.archive.errors import ArchiveError
from continuation.archive.locks import is_held
from continuation.archive.merge import gather
from continuation.archive.reader import open_archive
from continuation.archive.workers import Batch
from continuation.archive.writer import PathLog
from continuation.status import Status

THREAD_SECONDS = 10.0
"""Seconds for those that cannot be ended, as threads: a file is merged when its writer has left it."""

_LOOK = 0.05
"""Seconds between two looks whether a file has been left."""


def finished(batch: Batch) -> set[int]:
    """The numbers of the homotopies whose paths a lost worker had finished."""
    found: set[int] = set()
    if batch.file is not None:
        for file in batch.file.parent.glob(f"{glob.escape(batch.file.stem)}*{batch.file.suffix}"):
            with suppress(ArchiveError), open_archive(file) as part:
                ended = part.paths["status"] != int(Status.TRACING)
                found.update(part.paths["member"][ended].tolist())
    return found


def end_repeats(target: File, token: str, sign: File) -> None:
    """Let those end that do a batch again whose result is here: dask begins it elsewhere when its worker dies then."""
    until = time.monotonic() + THREAD_SECONDS
    while any(map(is_held, _files(target, token))) and time.monotonic() < until:
        sign.touch()
        time.sleep(_LOOK)


def _files(target: File, token: str) -> list[File]:
    """Those of the workers of a sweep."""
    return sorted(target.parent.glob(f"{glob.escape(target.stem)}.sweep-{token}.*{glob.escape(target.suffix)}"))


def collect(
    batches: Sequence[Batch], errors: Mapping[int, BaseException], target: File, token: str, stopped: bool
) -> None:
    """Merge the workers' files; what was lost is there as failures, unless Ctrl-C is why it is not there."""
    lost = target.with_name(f"{target.stem}.sweep-{token}.lost{target.suffix}")
    if errors and not stopped:
        tasks = {batch.first + i: homotopy for batch in batches for i, homotopy in enumerate(batch.homotopies)}
        with PathLog(lost) as log:
            for number, error in sorted(errors.items()):
                log.member = number
                log.failure(tasks[number], error)
    files = _files(target, token)
    if files:
        gather(files, target, finished=stopped)
    # What a worker was writing when it was ended is named after its file, and nobody writes it any more.
    parts = target.parent.glob(f".{glob.escape(target.stem)}.sweep-{token}.*{glob.escape(target.suffix)}.*.part")
    for file in (*files, *(part for part in parts if not is_held(part))):
        file.unlink()
