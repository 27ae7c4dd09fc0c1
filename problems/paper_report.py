"""The ten examples: accurate paths from the paper's starts, and the paper's algorithm."""

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
from problems.lcp.homotopies import KKTHomotopy
from problems.lcp.proof.certificate import certify
from problems.lcp.search.padded import Padded
from problems.literal import LiteralRun, run_literally
from problems.paper import Example

SOLVED_TO = 1e-6
"""Example 7 ends like the square root of lambda, so its path is good to this; others are far better."""

TITLE = "The ten examples of Dutta, Das and Jana: y = (x, z1, z2), then NaN"


@frozen(eq=False)
class Row:
    """An example with its accurate path and the literal algorithm's run."""

    example: Example
    path: Path
    literal: LiteralRun

    @property
    def x(self) -> Array:
        """The path's last x, shape (n,)."""
        return self.path.endpoint.y[: self.example.q.size]

    @property
    def residual(self) -> float:
        """Its natural residual."""
        return certify(self.example.problem, self.x).residual

    @property
    def solved(self) -> bool:
        """Whether it solves the LCP to `SOLVED_TO`."""
        return certify(self.example.problem, self.x).solves(SOLVED_TO)


def trace_example(example: Example, observers: tuple[Observer, ...] = ()) -> Path:
    """The KKT path from the paper's start, with default parts."""
    return continuation.trace(KKTHomotopy(example.problem, example.x0, example.z1, example.z2), observers=observers)


def run_examples(examples: Sequence[Example], archive: str | PathLike[str]) -> list[Row]:
    """Trace the examples into a new archive, and run the literal algorithm.

    `archive`: also gets A, q and x0 in group `examples`. Raises `ArchiveError` if it exists or cannot be written.
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
    """Store data to certify ends from the file alone."""
    with h5py.File(archive, "r+") as file:
        for example in examples:
            group = file.create_group(f"examples/{example.number}")
            group.attrs["label"] = example.label
            for name in ("A", "q", "x0"):
                group[name] = getattr(example, name)


def table(rows: Sequence[Row]) -> str:
    """The rows as text."""
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
    """False claims of the literal algorithm, and paths that stop early."""
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
    """A vector as short text, negligible components as 0."""
    size = float(np.abs(x).max())
    return "(" + ", ".join("0" if abs(value) <= SOLVED_TO * size else f"{value:.{digits}g}" for value in x) + ")"
