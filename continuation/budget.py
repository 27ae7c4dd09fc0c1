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
        """Exhausted limit as text, or "".

        Parameters
        ----------
        counts : Counts
        seconds : float
        arclength : float
            So far, in the trace's metric.
        """
        for spent, limit, unit in (
            (counts.accepted, self.steps, "steps"),
            (counts.factorizations, self.factorizations, "factorisations"),
            (seconds, self.seconds, "seconds"),
            (arclength, self.arclength, "of arclength"),
        ):
            if spent >= limit:
                return f"{limit:g} {unit}"
        return ""
