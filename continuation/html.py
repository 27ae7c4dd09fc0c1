"""Paths, archives and answers as small tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from continuation.path import Path

TABLE_ROWS = 10


def table(caption: str, rows: Iterable[Sequence[object]], head: Sequence[str] = ()) -> str:
    """A table of texts, each escaped.

    Parameters
    ----------
    caption : str
    rows : iterable of sequence
    head : sequence of str
        Names of the columns.
    """
    cells = "".join(
        "<tr>" + "".join(f"<td style='text-align:left'>{escape(str(cell))}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    names = "".join(f"<th style='text-align:left'>{escape(name)}</th>" for name in head)
    top = f"<tr>{names}</tr>" if names else ""
    return f"<table><caption style='text-align:left'><b>{escape(caption)}</b></caption>{top}{cells}</table>"


def path_page(path: Path) -> str:
    """How a path went: its end, its events, its cost."""
    rows: list[Sequence[object]] = [("message", path.message)]
    if path.steps:
        first, last = path.steps[0], path.steps[-1]
        name = path.labels.parameter()
        rows += [("points", len(path)), (name, f"{first.lam:.6g} to {last.lam:.6g}"),
                 ("arclength", f"{last.arclength:.6g}")]  # fmt: skip
    rows.append(("cost", f"{path.counts.factorizations} factorisations, {path.seconds:.3g} s"))
    page = table(f"Path: {path.status.name}", rows)
    if path.events:
        found = [(e.name, f"{e.lam:.10g}", f"{e.arclength:.6g}") for e in path.events[:TABLE_ROWS]]
        more = len(path.events) - TABLE_ROWS
        caption = "Events" if more <= 0 else f"Events, {more} more"
        page += table(caption, found, ("event", path.labels.parameter(), "arclength"))
    return page


def archive_page(archive: Any) -> str:
    """What an archive holds, path by path."""
    shown = range(min(len(archive), TABLE_ROWS))
    rows = [
        (k, archive.status(k).name, int(archive.paths["n_points"][k]), archive.paths["message"][k].decode())
        for k in shown
    ]
    more = len(archive) - len(rows)
    caption = f"{archive.file.name}: {len(archive)} paths" + (f", {more} not shown" if more > 0 else "")
    return table(caption, rows, ("path", "status", "points", "message"))
