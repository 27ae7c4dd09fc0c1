"""Tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

TABLE_ROWS = 10


def table(caption: str, rows: Iterable[Sequence[object]], head: Sequence[str] = ()) -> str:
    """Escape texts into a table; `head` names columns."""
    cells = "".join(
        "<tr>" + "".join(f"<td style='text-align:left'>{escape(str(cell))}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    names = "".join(f"<th style='text-align:left'>{escape(name)}</th>" for name in head)
    top = f"<tr>{names}</tr>" if names else ""
    return f"<table><caption style='text-align:left'><b>{escape(caption)}</b></caption>{top}{cells}</table>"


def archive_page(archive: Any) -> str:
    """Table of an archive's first paths."""
    lengths, messages = archive.paths["n_points"], archive.paths["message"]
    rows = [
        (k, archive.status(k).name, int(lengths[k]), messages[k].decode(errors="replace"))
        for k in range(min(len(archive), TABLE_ROWS))
    ]
    return table(f"{archive.file.name}: {len(archive)} paths", rows, ("path", "status", "points", "message"))
