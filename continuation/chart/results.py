"""What a study found: one row a run, failures included; kept as CSV."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path as File
from typing import Any

from attrs import field, fields, fields_dict, frozen

from continuation.counts import Counts

ERROR_FLOOR = 1e-13
"""Errors below this are round-off, and count as equal."""

PREFIX = "error: "
"""Of the columns of errors in a file."""


@frozen
class Row:
    """One run.

    Attributes
    ----------
    problem, family : str
    n, seed : int
    method : str
    outside : bool
        Whether the method is another package's, or the textbooks'.
    rung : float
        The ladder's value; NaN where the ladder does not concern the method.
    failure, message : str
        One of `Failure`; why.
    errors : mapping of str to float
        Of the answer, by name; NaN where one does not apply.
    counts : Counts
    turns : int
        Turning points found.
    seconds : float
        Processor time, the least of the repeated runs.
    repeats : int
        How many runs were timed after the first; 0 if the first took too long to be repeated.
    """

    problem: str
    family: str
    n: int
    seed: int
    method: str
    outside: bool
    rung: float
    failure: str
    message: str
    errors: Mapping[str, float]
    counts: Counts
    turns: int
    seconds: float
    repeats: int

    @property
    def failed(self) -> bool:
        """Whether it has a failure."""
        return bool(self.failure)

    def work(self, name: str) -> float:
        """One of `WORK` by name, not below its least.

        Parameters
        ----------
        name : str
            One of `WORK`.
        """
        measure = WORK[name]
        return max(measure.of(self), measure.least)

    def placed(self, error: str, work: str) -> tuple[float, float] | None:
        """(error, work), the error to three digits and not below `ERROR_FLOOR`; None if it failed or has no error.

        Errors that differ in the fourth digit say the same: neither run is better for it.

        Parameters
        ----------
        error, work : str
            Names in `errors` and `WORK`.
        """
        value = self.errors[error]
        if self.failed or not math.isfinite(value):
            return None
        return max(float(f"{value:.2e}"), ERROR_FLOOR), self.work(work)


@frozen
class Work:
    """A measure of work: what it is, how it is read off a row, and what a run costs at least.

    A run that needs no factorisation at all counts as one, so that logarithms and ratios exist.
    """

    label: str
    of: Callable[[Row], float]
    least: float = 1.0


WORK: Mapping[str, Work] = {
    "factorizations": Work("factorisations", lambda row: float(row.counts.factorizations)),
    "solves": Work("solves with a factorisation", lambda row: float(row.counts.solves)),
    "residuals": Work("residual evaluations", lambda row: float(row.counts.residuals)),
    "steps": Work("accepted steps", lambda row: float(row.counts.accepted)),
    "seconds": Work("processor time (s)", lambda row: row.seconds, 1e-9),
}
"""By name."""


@frozen
class Results:
    """The rows of a study, with what its tables and figures need to know of it.

    Attributes
    ----------
    study, title, ladder : str
    errors : mapping of str to str
        Name to axis label, the most telling first.
    work : sequence of str
    rows : sequence of Row
    provenance : mapping of str to str
        Versions, machine, BLAS threads.
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
        """As for the problems."""
        return list(dict.fromkeys(row.family for row in self.rows))

    @property
    def methods(self) -> list[str]:
        """As for the problems."""
        return list(dict.fromkeys(row.method for row in self.rows))

    def of(self, *, problem: str | None = None, family: str | None = None, method: str | None = None) -> Sequence[Row]:
        """The rows with the given names.

        Parameters
        ----------
        problem, family, method : str, optional
            Only rows of that name; all by default.
        """
        wanted = {"problem": problem, "family": family, "method": method}
        given = {name: value for name, value in wanted.items() if value is not None}
        return [row for row in self.rows if all(getattr(row, name) == value for name, value in given.items())]

    def check(self, error: str | None = None, work: str | None = None) -> None:
        """Refuse an error or a work that the results do not have.

        Parameters
        ----------
        error, work : str, optional

        Raises
        ------
        ValueError
            Naming what there is.
        """
        if error is not None and error not in self.errors:
            raise ValueError(f"error: expected one of {', '.join(self.errors)}, found {error!r}")
        if work is not None and work not in WORK:
            raise ValueError(f"work: expected one of {', '.join(WORK)}, found {work!r}")


_OWN = [each.name for each in fields(Row) if each.name not in ("errors", "counts")]
_COUNTS = list(Counts().as_dict())
_HEAD = [each.name for each in fields(Results) if each.name != "rows"]


def write(results: Results, file: str | PathLike[str]) -> File:
    """Write results as CSV: a line a run under lines ``# name: JSON`` of what the rows have in common.

    ``pandas.read_csv(file, comment="#")`` reads it, and `read`.

    Parameters
    ----------
    results : Results
    file : path
        Replaced if it exists.

    Returns
    -------
    Path
    """
    out = io.StringIO()
    for name in _HEAD:
        out.write(f"# {name}: {json.dumps(getattr(results, name))}\n")
    table = csv.writer(out, lineterminator="\n")
    table.writerow([*_OWN, *_COUNTS, *(PREFIX + name for name in results.errors)])
    for row in results.rows:
        counts = row.counts.as_dict()
        # What begins with # would be read as a comment; a message has no use for it.
        own = [value.replace("#", "") if isinstance(value := getattr(row, name), str) else value for name in _OWN]
        table.writerow([*own, *(counts[name] for name in _COUNTS), *(row.errors[name] for name in results.errors)])
    target = File(file)
    target.write_text(out.getvalue(), encoding="utf-8")
    return target


def read(file: str | PathLike[str]) -> Results:
    """Read the results of a study.

    Parameters
    ----------
    file : path
        Written by `write`.

    Returns
    -------
    Results

    Raises
    ------
    ValueError
        If the file holds something else.
    """
    lines = File(file).read_text(encoding="utf-8").splitlines()
    head = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    if list(head) != _HEAD:
        raise ValueError(f"file: expected results that `write` wrote, found {file} without {', '.join(_HEAD)}")
    common = {name: json.loads(value) for name, value in head.items()}
    rows = [_row(cells, common["errors"]) for cells in csv.DictReader(lines[len(head) :])]
    return Results(**common, rows=rows)


def _row(cells: dict[str, str], errors: Mapping[str, str]) -> Row:
    kinds: dict[str, Callable[[str], Any]] = {"int": int, "float": float, "str": str, "bool": "True".__eq__}
    own = {name: kinds[str(fields_dict(Row)[name].type)](cells[name]) for name in _OWN}
    counts = Counts(*(int(cells[name]) for name in _COUNTS))
    return Row(**own, counts=counts, errors={name: float(cells[PREFIX + name]) for name in errors})
