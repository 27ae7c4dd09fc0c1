"""Junctions of branches."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import define, evolve, field

from continuation.arrays import Array
from continuation.branch_switching import crossing_rays, leaving_branches, metric_at, switch_branch
from continuation.metric import inner, norm
from continuation.path import LocatedEvent, Path
from continuation.status import Kind

MEETING = (Kind.BRANCH_POINT, Kind.SINGULAR_POINT, Kind.KINK)

RAY_COSINE = 0.99
"""Least cosine between a ray and a branch along it: eight degrees."""

STRAIGHT_ON = -1.0 + 1e-3
"""Largest cosine between two rays of one branch; those of multiple branch points are extrapolated."""


@define(eq=False)
class Junction:
    """A point where branches meet.

    `rays`, (k, N + 1): directions away, two of them of the path that found it. `starts`: for the others. `used`: rays
    followed. `label`: empty until a finished branch contains the point. `failed`: why rays are unknown.
    """

    event: LocatedEvent
    weights: Array
    rays: Array
    starts: list[tuple[Array, Array]]
    label: str = ""
    number: int = -1
    generation: int = 0
    failed: str = ""
    used: set[int] = field(factory=set)

    @classmethod
    def at(cls, homotopy: Any, event: LocatedEvent, step: float) -> Junction:
        """An event's junction, with starts on other rays."""
        weights = metric_at(event)
        try:
            if event.kind == Kind.SINGULAR_POINT:
                found = leaving_branches(homotopy, event, step)
                return cls(event, weights, np.array([b.ray for b in found]), [(b.u, b.tangent) for b in found[2:]])
            rays = event.rays if event.kind == Kind.KINK else crossing_rays(homotopy, event)
            event = evolve(event, rays=rays)
            return cls(event, weights, np.array(rays), list(switch_branch(homotopy, event, step)))
        except ArithmeticError as error:
            return cls(event, weights, np.array([-event.tangent, event.tangent]), [], failed=str(error))

    def take(self, direction: Array) -> None:
        """Mark the ray along `direction` as used."""
        along = self._cosines(direction)
        if max(along) >= RAY_COSINE:
            self.used.add(int(np.argmax(along)))

    def _cosines(self, direction: Array) -> list[float]:
        size = norm(self.weights, direction)
        return [inner(self.weights, ray, direction) / (norm(self.weights, ray) * size) for ray in self.rays]

    def open(self) -> list[int]:
        """Unused rays with a start."""
        return [k for k in range(2, 2 + len(self.starts)) if k not in self.used]

    def line(self, ray: int) -> list[int]:
        """The rays of one smooth branch: `ray`, and the one straight on, if any."""
        along = self._cosines(self.rays[ray])
        ahead = int(np.argmin(along))
        return [ray, ahead] if self.event.kind != Kind.KINK and along[ahead] <= STRAIGHT_ON else [ray]


def meetings(path: Path) -> list[LocatedEvent]:
    """Events of a path where branches may leave."""
    several = (event for event in path.events if event.kind in MEETING)
    return [e for e in several if e.kind != Kind.KINK or (e.rays is not None and len(e.rays) > 2)]


def directions_of(event: LocatedEvent, path: Path) -> list[Array]:
    """Directions in which a path leaves an event."""
    ends = event.ends_step and event.step == path.steps[-1].index
    begins = np.array_equal(event.u, path.steps[0].u)
    at_kink = event.kind == Kind.KINK and event.rays is not None
    both = list(event.rays[:2]) if at_kink and event.rays is not None else [-event.tangent, event.tangent]
    return both[begins : 1 if ends else 2]
