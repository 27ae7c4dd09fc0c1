"""A study: problems x methods x a ladder, the errors to measure, and the figures to draw."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from attrs import Factory, field, frozen

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.chart.errors import Error
from continuation.chart.ladder import Ladder, tolerances
from continuation.chart.model import Method, Problem
from continuation.chart.results import WORK, Results
from continuation.chart.table import Table


class Figure(Protocol):
    """A picture of results."""

    @property
    def name(self) -> str:
        """Part of the file name."""
        ...

    def draw(self, results: Results) -> Any:
        """The matplotlib figure.

        Parameters
        ----------
        results : Results

        Returns
        -------
        matplotlib Figure
        """
        ...


def _distinct(instance: Any, attribute: Any, value: Sequence[Any]) -> None:
    if not isinstance(value, Sequence) or isinstance(value, str):
        raise TypeError(f"{attribute.name}: expected a list, found {value!r}")
    if not value:
        raise ValueError(f"{attribute.name}: expected at least one, found none")
    for item in value:
        if not hasattr(item, "name"):
            raise TypeError(f"{attribute.name}: expected {attribute.name} of continuation.chart, found {item!r}")
    names = [item.name for item in value]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"{attribute.name}: expected distinct names, found {twice!r} twice")


def _known_work(instance: Any, attribute: Any, value: Sequence[str]) -> None:
    if isinstance(value, str) or not value or not set(value) <= set(WORK):
        raise ValueError(f"work: expected a list of some of {', '.join(WORK)}, found {value!r}")


@frozen(eq=False, kw_only=True)
class Study:
    """Problems x methods x a ladder.

    Parameters
    ----------
    name : str
        Of its files.
    problems : sequence of Problem
    methods : sequence of Method
        See `traced` for the usual ones.
    ladder : Ladder
        By default tolerances from 1e-4 to 1e-10.
    errors : sequence of Error
        The first one counts where a table has room for one.
    work : sequence of str
        Names in `WORK`; the first one counts where there is room for one.
    figures : sequence of Figure
        What ``continuation chart`` draws.
    tables : mapping of str to callable
        By title, of the results: what ``continuation chart`` prints beside the summary by method.
    title : str
    repeats : int
        Timed runs after the first, which warms up and is judged; the shortest counts.
    patience : float
        Seconds: a run that took longer than this, or failed, is not repeated, its own time counts.
    give_up : bool
        Whether a method that ran out of budget is spared the further rungs of that problem and the larger problems of
        its family: they are failures of the same kind, without having been run.
    notes : sequence of str
        Sentences for the reader of the results, kept with them: outside solvers that are not installed, say.

    Raises
    ------
    ValueError
        If there is no problem, method or error, two of a kind have the same name, or a kind of work is unknown.
    TypeError
        If problems, methods or errors are no list of such.
    """

    name: str
    problems: Sequence[Problem] = field(validator=_distinct)
    methods: Sequence[Method] = field(validator=_distinct)
    ladder: Ladder = field(factory=lambda: tolerances(1e-4, 1e-6, 1e-8, 1e-10))
    errors: Sequence[Error] = field(validator=_distinct)
    work: Sequence[str] = field(default=("factorizations", "seconds"), validator=_known_work)
    figures: Sequence[Figure] = ()
    tables: Mapping[str, Callable[[Results], Table]] = field(factory=dict)
    title: str = field(default=Factory(lambda study: study.name, takes_self=True))
    repeats: int = field(default=2, validator=integer(0))
    patience: float = field(default=0.5, validator=NOT_NEGATIVE)
    give_up: bool = False
    notes: Sequence[str] = ()
