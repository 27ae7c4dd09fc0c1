"""Ten examples traced accurately, beside the paper's algorithm: table and archive."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from os import PathLike

import h5py
import numpy as np
from attrs import frozen

import continuation
from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.chart.table import Cell, Table
from continuation.path import Path
from continuation.step.tracer import Observer
from problems.charts.lcp import SOLVED_TO
from problems.lcp.homotopies import KKTHomotopy
from problems.lcp.proof.certificate import certify
from problems.lcp.search.padded import Padded
from problems.literal import LiteralRun, run_literally
from problems.paper import Example

TITLE = "The ten examples of Dutta, Das and Jana: y = (x, z1, z2), then NaN"


@frozen(eq=False)
class Row:
    """An example's path and literal run."""

    example: Example
    path: Path
    literal: LiteralRun

    @property
    def x(self) -> Array:
        """Final x, shape (n,)."""
        return self.path.endpoint.y[: self.example.q.size]

    @property
    def residual(self) -> float:
        """Natural residual of x."""
        return certify(self.example.problem, self.x).residual

    @property
    def solved(self) -> bool:
        """Whether x solves the LCP to `SOLVED_TO`."""
        return certify(self.example.problem, self.x).solves(SOLVED_TO)


def trace_example(example: Example, observers: tuple[Observer, ...] = ()) -> Path:
    """Trace the KKT path by default options from the paper's start."""
    return continuation.trace(KKTHomotopy(example.problem, example.x0, example.z1, example.z2), observers=observers)


def run_examples(examples: Sequence[Example], archive: str | PathLike[str]) -> list[Row]:
    """Trace all examples and run the literal algorithm.

    `archive`: a new file; its group `examples` holds A, q and x0. Raises `ArchiveError` if it exists or cannot be
    written.
    """
    unknowns = 3 * max(example.q.size for example in examples)
    with PathLog(archive, title=TITLE) as log:
        paths = [trace_example(example, (Padded(log, unknowns),)) for example in examples]
    _write_data(archive, examples)
    return [
        Row(example, path, run_literally(example.problem, example.x0, example.z1, example.z2))
        for example, path in zip(examples, paths)
    ]


def _write_data(archive: str | PathLike[str], examples: Iterable[Example]) -> None:
    """A, q, x0 certify each end from the file alone."""
    with h5py.File(archive, "r+") as file:
        for example in examples:
            group = file.create_group(f"examples/{example.number}")
            group.attrs["label"] = example.label
            for name in ("A", "q", "x0"):
                group[name] = getattr(example, name)


def table(rows: Sequence[Row]) -> str:
    """Text table of examples, ends, work and iterations."""
    head = ("#", "class", "x at the end", "residual", "steps", "factor.", "turns", "paper", "literal", "status")
    return Table(head, [_cells(row) for row in rows]).text()


def _cells(row: Row) -> Sequence[Cell]:
    path, literal = row.path, row.literal
    return (
        row.example.number,
        row.example.stated_class,
        show(row.x),
        f"{row.residual:.1e}",
        path.counts.accepted,
        path.counts.factorizations,
        len(path.turning_points),
        row.example.printed_iterations,
        literal.iterations if _true(literal) else f"{literal.iterations}*",
        f"{path.status.name}{'' if row.solved else ', not a solution'}",
    )


def remarks(rows: Sequence[Row]) -> list[str]:
    """Notes on false claims of the literal algorithm and unfinished paths."""
    found = [
        f"* Example {row.example.number}: the algorithm as printed claims to solve it at x = {show(row.literal.x)}, "
        f"where the natural residual is {row.literal.residual:.2g}: it has jumped to another path."
        for row in rows
        if not _true(row.literal)
    ]
    found += [
        f"  Example {row.example.number}: {row.path.message} (lambda = {row.path.endpoint.lam:.1e})"
        for row in rows
        if row.path.status is not continuation.Status.REACHED_TARGET
    ]
    return found


def _true(literal: LiteralRun) -> bool:
    return literal.solved or not literal.claims_solution


def show(x: Array, digits: int = 7) -> str:
    """Short text of a vector; components within path accuracy of zero become 0."""
    size = float(np.abs(x).max())
    return "(" + ", ".join("0" if abs(value) <= SOLVED_TO * size else f"{value:.{digits}g}" for value in x) + ")"
