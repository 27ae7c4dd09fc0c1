"""A study: problems x methods x a ladder, the errors to measure, and the figures to draw."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from attrs import field, frozen
from attrs.validators import ge

from continuation.arrays import Array
from continuation.chart.ladder import Ladder, Rung, tolerances
from continuation.chart.truth import Truth
from continuation.counts import Counts
from continuation.path import Path

if TYPE_CHECKING:
    from continuation.chart.errors import Error
    from continuation.chart.results import Results


class Failure:
    """How a run failed; the empty text if it did not."""

    NONE = ""
    JUMP = "jump"
    WRONG_END = "wrong end"
    EXCEPTION = "exception"
    BUDGET = "budget"
    STOPPED = "stopped"

    ALL = (JUMP, WRONG_END, EXCEPTION, BUDGET, STOPPED)


@frozen(eq=False)
class Problem:
    """What is solved.

    Attributes
    ----------
    name : str
    subject : Any
        A homotopy, or whatever the methods of the study take.
    truth : Truth
    options : mapping
        For `continuation.trace`, whatever the method: target, direction, events.
    n : int
        Size, for scaling; by default the subject's own.
    family : str
        Problems of one family differ in size or seed alone; by default the name.
    seed : int
        -1 where nothing is random.
    """

    name: str
    subject: Any
    truth: Truth = field(factory=Truth)
    options: Mapping[str, Any] = field(factory=dict)
    n: int = field()
    family: str = field()
    seed: int = -1

    @n.default
    def _size(self) -> int:
        if hasattr(self.subject, "start"):
            return len(self.subject.start()[0])
        return int(getattr(self.subject, "n", 0))

    @family.default
    def _own_name(self) -> str:
        return self.name


@frozen(eq=False)
class Answer:
    """What one run of a method came to.

    Attributes
    ----------
    counts : Counts
    path : Path or None
        None for methods that trace none.
    end : ndarray or None
        The point found, (y, lam) for a path.
    observed : mapping
        Named scalars at the end, such as the natural residual.
    failure, message : str
        One of `Failure`, if the method itself knows; why.
    """

    counts: Counts
    path: Path | None = None
    end: Array | None = None
    observed: Mapping[str, float] = field(factory=dict)
    failure: str = Failure.NONE
    message: str = ""


@frozen(eq=False)
class Method:
    """A way to solve the problems of a study.

    Attributes
    ----------
    name : str
        In the legend.
    run : callable
        (problem, rung) to an Answer. What it raises is caught and counts as a failure.
    laddered : bool
        Whether the ladder concerns it; otherwise it runs once a problem.
    """

    name: str
    run: Callable[[Problem, Rung], Answer]
    laddered: bool = True


class Figure(Protocol):
    """A picture of results, or a table of them."""

    @property
    def name(self) -> str:
        """Part of the file name."""
        ...

    def draw(self, results: Results) -> Any:
        """The matplotlib figure."""
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
    from continuation.chart.results import WORK

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
    title: str = field()
    repeats: int = field(default=2, validator=ge(0))
    patience: float = field(default=0.5, validator=ge(0))
    give_up: bool = False
    notes: Sequence[str] = ()

    @title.default
    def _own_name(self) -> str:
        return self.name
