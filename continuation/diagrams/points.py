"""The points of a diagram: those where branches meet, and the others that are located on them, each once."""

from __future__ import annotations

from collections.abc import Sequence

from continuation.branch_switching import metric_at
from continuation.diagrams.branches import LABELS, Branch, Special
from continuation.diagrams.junctions import SAME_POINT, Junction
from continuation.metric import norm
from continuation.path import LocatedEvent


def points_of(branches: Sequence[Branch], junctions: Sequence[Junction]) -> list[Special]:
    """Junctions, turning points, Hopf points and kinks, each once, in the order of the branches.

    Parameters
    ----------
    branches : sequence of Branch
    junctions : sequence of Junction
    """
    labelled = sorted((j for j in junctions if j.label), key=lambda j: j.number)
    found: list[tuple[str, LocatedEvent, list[int]]] = [(j.label, j.event, []) for j in labelled]
    for k, branch in enumerate(branches):
        for event in branch.path.events:
            if event.kind not in LABELS:
                continue
            label = LABELS[event.kind]
            same = [entry for entry in found if entry[0].startswith(label) and _one_place(entry[1], event)]
            if not same:
                same = [(f"{label}{1 + sum(entry[0].startswith(label) for entry in found)}", event, [])]
                found += same
            same[0][2].append(k)
        for entry in found:
            if entry[0] == branch.origin:
                entry[2].append(k)
    return [Special(label, event, tuple(dict.fromkeys(through))) for label, event, through in found]


def _one_place(a: LocatedEvent, b: LocatedEvent) -> bool:
    return norm(metric_at(a), a.u - b.u) <= SAME_POINT
