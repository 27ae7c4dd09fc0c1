"""The one place where `solve` traces a path, whatever homotopy it is of and whoever asks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from continuation.budget import Budget
from continuation.path import Path, Step
from continuation.step.tracer import Observer, Tracer
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.on_path import AlongPath
from problems.lcp.homotopies.registry import LCPHomotopy

Patience = Callable[[Step], str]
"""A step to the reason for which its path is given up, or to nothing."""


def follow(
    homotopy: LCPHomotopy,
    finish: Finish | None,
    budget: Budget,
    *,
    observers: tuple[Observer, ...] = (),
    patience: Patience | None = None,
    **options: Any,
) -> Path:
    """Trace a path, with the finish along it; its counts hold the factorisations of the finish too.

    `finish`: None for the pure path. `patience`: When the path is given up; the path's message then has the reason.
    `**options`: As for `continuation.Tracer`.
    """
    before = 0 if finish is None else finish.counts.factorizations
    along = None if finish is None else AlongPath.of(finish, homotopy)
    tracer = Tracer(homotopy, finish=along, budget=budget, observers=observers, **options)
    for step in tracer:
        if patience is not None and (reason := patience(step)):
            tracer.give_up(reason)
            break
    if finish is not None:
        tracer.path.counts.factorizations += finish.counts.factorizations - before
    return tracer.path
