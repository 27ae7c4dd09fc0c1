"""Results of a study: one row per run, kept as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path as File

import numpy as np
from attrs import asdict, field, frozen

from continuation.arrays import Array
from continuation.counts import Counts

ERROR_FLOOR = 1e-13
"""Errors below this are round-off, and equal."""


@frozen
class Row:
    """One run.

    Attributes
    ----------
    problem, family, method : str
    n : int
        Size.
    outside : bool
        See `Method`.
    rung, seconds : float
        Ladder value; least processor time.
    failure, message : str
        See `Answer`.
    errors : mapping of str to float
        NaN if not applicable.
    counts : Counts
    """

    problem: str
    family: str
    n: int
    method: str
    outside: bool
    rung: float
    failure: str
    message: str
    errors: Mapping[str, float]
    counts: Counts
    seconds: float

    @property
    def failed(self) -> bool:
        """Whether the run failed."""
        return bool(self.failure)

    def work(self, name: str) -> float:
        """Work, positive.

        Parameters
        ----------
        name : str
            From `WORK`.
        """
        # A clock counts nanoseconds.
        return max(self.seconds, 1e-9) if name == "seconds" else max(float(getattr(self.counts, name)), 1.0)

    def placed(self, error: str, work: str) -> tuple[float, float] | None:
        """(error, work), or None for a failure or without error.

        Errors have three digits and are at least `ERROR_FLOOR`.

        Parameters
        ----------
        error, work : str
        """
        value = self.errors[error]
        if self.failed or not math.isfinite(value):
            return None
        return max(float(f"{value:.2e}"), ERROR_FLOOR), self.work(work)


WORK: Mapping[str, str] = {
    "factorizations": "factorisations",
    "solves": "solves with a factorisation",
    "residuals": "residual evaluations",
    "accepted": "accepted steps",
    "seconds": "processor time (s)",
}


def some(kind: str, wanted: Sequence[str] | None, known: Iterable[str]) -> Sequence[str]:
    """Wanted or all names; ValueError for unknown ones."""
    if wanted is None:
        return list(known)
    if isinstance(wanted, str) or not wanted or not set(wanted) <= set(known):
        raise ValueError(f"{kind}: expected some of {', '.join(known)}, found {wanted!r}")
    return wanted


@frozen
class Results:
    """Rows of a study.

    Attributes
    ----------
    study, title, ladder : str
        `ladder`: name of what is varied.
    errors : mapping of str to str
        Axis labels, most important first.
    work : sequence of str
        From `WORK`.
    rows : sequence of Row
    provenance : mapping of str to str
        Versions, machine, threads.
    """

    study: str
    title: str
    ladder: str
    errors: Mapping[str, str]
    work: Sequence[str]
    rows: Sequence[Row]
    provenance: Mapping[str, str] = field(factory=dict)

    @property
    def problems(self) -> list[str]:
        """Names in order of appearance."""
        return list(dict.fromkeys(row.problem for row in self.rows))

    @property
    def families(self) -> list[str]:
        """Names in order of appearance."""
        return list(dict.fromkeys(row.family for row in self.rows))

    @property
    def methods(self) -> list[str]:
        """Names in order of appearance."""
        return list(dict.fromkeys(row.method for row in self.rows))

    def of(self, **where: object) -> Sequence[Row]:
        """Select rows.

        Parameters
        ----------
        **where
            Values of `Row` attributes; None matches any.
        """
        given = {name: value for name, value in where.items() if value is not None}
        return [row for row in self.rows if all(getattr(row, name) == value for name, value in given.items())]


def write(results: Results, file: str | PathLike[str]) -> File:
    """Write results as a JSON object; pandas reads its ``rows``.

    Parameters
    ----------
    results : Results
    file : path
        Replaced if it exists.
    """
    target = File(file)
    kept = asdict(results, filter=lambda attribute, _: attribute.name != "notes")
    target.write_text(json.dumps(kept, indent=1), encoding="utf-8")
    return target


def read(file: str | PathLike[str]) -> Results:
    """Read results.

    Parameters
    ----------
    file : path

    Raises
    ------
    ValueError
        If `write` did not write it.
    """
    try:
        kept = json.loads(File(file).read_text(encoding="utf-8"))
        rows = [Row(**{**row, "counts": Counts(**row["counts"])}) for row in kept.pop("rows")]
        return Results(**kept, rows=rows)
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"file: expected results that `write` wrote, found {file} ({error})") from error


def excess(results: Results, error: str, work: str) -> Array:
    """Each row's work over the least work of runs at least as accurate; infinite for failures.

    Parameters
    ----------
    results : Results
    error, work : str

    Raises
    ------
    ValueError
        For unknown names.
    """
    some("error", [error], results.errors)
    some("work", [work], WORK)
    placed = [(row.problem, row.placed(error, work)) for row in results.rows]
    points = [(problem, *point) for problem, point in placed if point is not None]
    return np.array([
        math.inf if point is None else point[1] / min(w for of, e, w in points if of == problem and e <= point[0])
        for problem, point in placed
    ])  # fmt: skip
