"""What a study found: one row a run, failures included."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from attrs import field, frozen

from continuation.chart.model import Failure
from continuation.counts import Counts


@frozen
class Row:
    """One run.

    Attributes
    ----------
    problem, family : str
    n, seed : int
    method : str
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

    @property
    def spared(self) -> bool:
        """Whether it was not run, as a smaller problem had been out of budget (`Study.give_up`)."""
        return self.failure == Failure.BUDGET and self.counts == Counts()

    def work(self, name: str) -> float:
        """One of `WORK` by name, not below its least.

        Parameters
        ----------
        name : str
            One of `WORK`.
        """
        measure = WORK[name]
        return max(measure.of(self), measure.least)


@frozen
class Work:
    """A measure of work: what it is, how it is read off a row, what a run costs at least, and its unit.

    A run that needs no factorisation at all counts as one, so that logarithms and ratios exist.
    """

    quantity: str
    of: Callable[[Row], float]
    least: float = 1.0
    unit: str = ""

    @property
    def label(self) -> str:
        """Of an axis."""
        return f"{self.quantity} ({self.unit})" if self.unit else self.quantity


WORK: Mapping[str, Work] = {
    "factorizations": Work("factorisations", lambda row: float(row.counts.factorizations)),
    "solves": Work("solves with a factorisation", lambda row: float(row.counts.solves)),
    "residuals": Work("residual evaluations", lambda row: float(row.counts.residuals)),
    "steps": Work("accepted steps", lambda row: float(row.counts.accepted)),
    "seconds": Work("processor time", lambda row: row.seconds, 1e-9, "s"),
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
    work : tuple of str
    rows : tuple of Row
    provenance : mapping of str to str
        Versions, machine, BLAS threads.
    """

    study: str
    title: str
    ladder: str
    errors: Mapping[str, str]
    work: tuple[str, ...]
    rows: tuple[Row, ...]
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
