"""Bifurcation problems with references exact to round-off."""

from __future__ import annotations

from typing import Any

from continuation.chart import Problem, reference
from continuation.events import TargetValue
from problems.bifurcation import Bratu1D, Bratu2D, ExponentialCosine, FreudensteinRoth


def freudenstein() -> Problem:
    """Freudenstein-Roth path to (5, 4)."""
    subject = FreudensteinRoth()
    return Problem("Freudenstein-Roth", subject, reference(subject))


def cosine(n: int) -> Problem:
    """Exponential-cosine path."""
    subject = ExponentialCosine(n)
    return Problem(f"exponential-cosine, n = {n}", subject, reference(subject), family="exponential-cosine")


def bratu(n: int) -> Problem:
    """Bratu on an interval, through the fold to lam = 1."""
    return _round_the_fold(Bratu1D(n), 1.0, f"Bratu 1D, n = {n}", n, "Bratu 1D (banded)")


def bratu_square(m: int) -> Problem:
    """Bratu on m x m points, through the fold to lam = 2."""
    return _round_the_fold(Bratu2D(m), 2.0, f"Bratu 2D, n = {m * m}", m * m, "Bratu 2D (sparse)")


def _round_the_fold(subject: Any, lam: float, name: str, n: int, family: str) -> Problem:
    options = {"target": None, "direction": 1, "events": (TargetValue(lam, direction=-1),)}
    return Problem(name, subject, reference(subject, **options), options, n, family)
