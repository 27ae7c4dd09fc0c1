"""Results of class tests: answer, evidence, source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import wraps
from inspect import Parameter, Signature, cleandoc
from textwrap import shorten
from typing import Any

from attrs import evolve, frozen

from problems.lcp.classes.exact import ExactMatrix

CPS = "Cottle, Pang and Stone, The Linear Complementarity Problem, 1992"


@frozen
class Evidence:
    """The evidence for a membership; indices count from 0.

    Parameters
    ----------
    sentence : str
    indices : tuple of int, optional
        The deciding index set.
    value : Fraction, optional
        The deciding minor, quadratic form, entry or bound.
    vector : tuple of Fraction, optional
        The deciding vector.
    """

    sentence: str
    indices: tuple[int, ...] | None = None
    value: Fraction | None = None
    vector: tuple[Fraction, ...] | None = None

    def __str__(self) -> str:
        return self.sentence


@frozen
class Membership:
    """Whether a matrix belongs to a class.

    Parameters
    ----------
    holds : bool or None
        None if not decided.
    certificate : Evidence
        The reason.
    name : str
        The class.
    cited : str
        Source of the criterion.
    """

    holds: bool | None
    certificate: Evidence
    name: str = ""
    cited: str = CPS

    def __bool__(self) -> bool:
        raise TypeError(f"membership in {self.name} has three values, True, False and None: read .holds")

    def __str__(self) -> str:
        return f"{self.name}: {ANSWERS[self.holds]}, {self.certificate}"


ANSWERS: Mapping[bool | None, str] = {True: "yes", False: "no", None: "not decided"}

Classification = Mapping[str, Membership]


_SECTIONS = """

Parameters
----------
A : array_like or scipy sparse, shape (n, n)
    Each float is taken as the rational number that it is.

Returns
-------
Membership

Raises
------
ValueError
    If A is not a square matrix of finite real numbers.
"""


def matrix_class(name: str, cited: str) -> Callable[[Callable[[ExactMatrix], Membership]], Callable[[Any], Membership]]:
    """Decorate a test of exact matrices: it takes any matrix, and its answers have the class's `name` and `cited`
    source.
    """

    def decorated(test: Callable[[ExactMatrix], Membership]) -> Callable[[Any], Membership]:
        @wraps(test)
        def of(A: Any) -> Membership:
            return evolve(test(ExactMatrix.of(A)), name=name, cited=cited)

        of.__doc__ = cleandoc(f"{test.__doc__}") + _SECTIONS
        of.__signature__ = Signature([Parameter("A", Parameter.POSITIONAL_OR_KEYWORD)])  # type: ignore[attr-defined]
        return of

    return decorated


MOST_CASES = 4096
"""Most minors or linear programs of a test: some 0.1 s; order 12 with one for each index set."""


def undecided(cases: int) -> Membership:
    """Answer of a test with too many cases."""
    return Membership(
        None, Evidence(f"the exact test is exponential in n and stops at {MOST_CASES} cases, found {cases}")
    )


def shown(values: Sequence[int] | Sequence[Fraction]) -> str:
    """A vector as text."""
    return f"({', '.join(map(str, values))})"


def shown_set(indices: Sequence[int]) -> str:
    """An index set as text."""
    return f"{{{shown(indices)[1:-1]}}}"


def table(classification: Classification, width: int = 110) -> str:
    """Lines of class, answer and evidence.

    Parameters
    ----------
    classification : mapping of str to Membership
        From `classify`.
    width : int
        Longest evidence in characters.
    """
    from continuation.chart.table import Table

    rows = [
        (name, ANSWERS[one.holds], shorten(str(one.certificate), max(width, 3), placeholder="..."))
        for name, one in classification.items()
    ]
    return Table(("class", "answer", "evidence"), rows).text()
