"""Studies: methods on problems along a ladder."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from attrs import Attribute, Factory, field, frozen
from attrs.validators import deep_iterable, min_len

from continuation.arguments.checks import POSITIVE_FINITE, integer
from continuation.arrays import Array
from continuation.chart.model import Method, Problem
from continuation.chart.results import WORK, some

Size = Literal["smoke", "moderate", "full"]
"""Size of a ready study: for tests, for minutes on two cores, for reports."""


WRONG = 1e-2
"""Relative error of a wrong answer: right ones are far nearer."""


def distance(found: Array, true: Array | None) -> float:
    """Largest component difference over 1 + largest true component; nan if that is not known."""
    return math.nan if true is None else float(np.abs(found - true).max() / (1.0 + np.abs(true).max()))


END_POINT: Mapping[str, str] = {"end_point": "relative error of the end point"}
"""The error that `run` adds to an answer's scalars, where the end is known."""


def _named_once(study: Study, attribute: Attribute[Any], value: Any) -> None:
    names = [getattr(item, "name", None) for item in value] if isinstance(value, Sequence) else []
    if not names or None in names or len(set(names)) < len(names):
        raise ValueError(f"{attribute.name}: expected a list of some, each with a name of its own, found {value!r}")


@frozen(eq=False, kw_only=True)
class Study:
    """Problems x methods x a ladder.

    Parameters
    ----------
    name, title : str
        For files; for figures.
    problems, methods : sequence of Problem, of Method
    ladder : sequence of float
        Values of what is varied, by default tolerances 1e-4 to 1e-10.
    varied : str
        Its name in tables.
    errors : mapping of str to str
        Scalars of answers that vanish at solutions, with labels for axes, most important first.
    work : sequence of str
        From `WORK`.
    figures : sequence
        `Lines`, `Profile`.
    repeats : int
        Timed runs after the first, of what succeeded.

    Raises
    ------
    ValueError
        For missing or repeated names, or unknown work.
    """

    name: str
    problems: Sequence[Problem] = field(validator=_named_once)
    methods: Sequence[Method] = field(validator=_named_once)
    ladder: Sequence[float] = field(
        default=(1e-4, 1e-6, 1e-8, 1e-10), validator=deep_iterable(POSITIVE_FINITE, min_len(1))
    )
    varied: str = "tolerance"
    errors: Mapping[str, str] = field(default=END_POINT, validator=min_len(1))
    work: Sequence[str] = field(
        default=("factorizations", "seconds"), validator=lambda study, attribute, value: some("work", value, WORK)
    )
    figures: Sequence[Any] = ()
    title: str = field(default=Factory(lambda study: study.name, takes_self=True))
    repeats: int = field(default=2, validator=integer(0))
