"""Limits of a trace's cost."""

from __future__ import annotations

import math

from attrs import field, frozen

from continuation.arguments.checks import POSITIVE
from continuation.counts import Counts


@frozen
class Budget:
    """Limits of steps, seconds, factorisations and arclength."""

    steps: float = field(default=10_000, validator=POSITIVE)
    seconds: float = field(default=math.inf, validator=POSITIVE)
    factorizations: float = field(default=math.inf, validator=POSITIVE)
    arclength: float = field(default=math.inf, validator=POSITIVE)

    def spent(self, counts: Counts, seconds: float, arclength: float = 0.0) -> str:
        """The exhausted limit as text, or "".

        Parameters
        ----------
        counts : Counts
        seconds : float
        arclength : float
            So far, in the trace's metric.

        Returns
        -------
        str
        """
        if counts.accepted >= self.steps:
            return f"{self.steps:g} steps"
        if counts.factorizations >= self.factorizations:
            return f"{self.factorizations:g} factorisations"
        if seconds >= self.seconds:
            return f"{self.seconds:g} seconds"
        if arclength >= self.arclength:
            return f"{self.arclength:g} of arclength"
        return ""
