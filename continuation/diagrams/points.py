"""Special points of a diagram."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from continuation.branch_switching import metric_at
from continuation.diagrams.branches import LABELS, Branch, Special
from continuation.diagrams.junctions import Junction
from continuation.diagrams.places import PointIndex
from continuation.path import LocatedEvent


def points_of(branches: Sequence[Branch], junctions: Sequence[Junction]) -> list[Special]:
    """Junctions, turning points, Hopf points and kinks, in branch order."""
    labels: Counter[str] = Counter()
    found: list[tuple[str, LocatedEvent, list[int]]] = []
    places: PointIndex[tuple[str, list[int]]] = PointIndex()

    def entry(label: str, event: LocatedEvent) -> list[int]:
        through: list[int] = []
        found.append((label, event, through))
        places.add(event.u, metric_at(event), (label, through))
        labels[label[:2]] += 1
        return through

    origins = {j.label: entry(j.label, j.event) for j in sorted(junctions, key=lambda j: j.number) if j.label}
    for k, branch in enumerate(branches):
        for event in branch.path.events:
            if event.kind not in LABELS:
                continue
            kind = LABELS[event.kind]
            same = [through for label, through in places.near(event.u) if label.startswith(kind)]
            (same[0] if same else entry(f"{kind}{1 + labels[kind]}", event)).append(k)
        if branch.origin:
            origins[branch.origin].append(k)
    return [Special(label, event, tuple(dict.fromkeys(through))) for label, event, through in found]
