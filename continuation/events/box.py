"""A box of parameter and unknowns, whose faces end the path."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from attrs import field, frozen

from continuation.arguments.checks import FINITE, complain, is_number, sign
from continuation.arguments.labels import Labels
from continuation.arrays import Array
from continuation.events.monitors import Event, TargetValue
from continuation.status import Kind

Box = Mapping[str | int, tuple[float | None, float | None]]
"""Maps ``"lam"``, ``"y"`` (all unknowns), an index or a name to (low, high); None: open."""


@frozen
class Extreme:
    """The largest (side +1) or smallest (side -1) unknown passes a value outwards."""

    value: float = field(validator=FINITE)
    side: int = field(validator=sign)
    terminal: int = field(default=1, init=False)
    kind: Kind = field(default=Kind.EVENT, init=False)

    @property
    def name(self) -> str:
        """Condition as text."""
        return f"{'largest' if self.side > 0 else 'smallest'} unknown = {self.value:g}"

    @property
    def direction(self) -> int:
        """Outwards."""
        return self.side

    def monitor(self, u: Array, v: Array) -> float:
        """Extreme unknown minus value."""
        return float(u[:-1].max() if self.side > 0 else u[:-1].min()) - self.value


def faces(box: Any, labels: Labels, start: Array) -> tuple[Event, ...]:
    """One event for each face of a box; TypeError or ValueError if it is no box, or `start` lies outside."""
    events: list[Event] = []
    for key, face in _faces(box, labels, start.size):
        if face.monitor(start, start) * face.direction > 0.0:
            raise ValueError(f"box: expected the start inside, found {key!r} beyond {face.value:g} there")
        events.append(face)
    return tuple(events)


def is_inside(box: Any, labels: Labels, u: Array) -> bool:
    """Whether u, shape (N + 1,), lies inside a box."""
    return all(face.monitor(u, u) * face.direction < 0.0 for _, face in _faces(box, labels, u.size))


def is_boundless(box: Any) -> bool:
    """Whether a box bounds nothing."""
    return isinstance(box, Mapping) and all(_interval(key, pair) == (None, None) for key, pair in box.items())


def _faces(box: Any, labels: Labels, size: int) -> list[tuple[str | int, Extreme | TargetValue]]:
    if not isinstance(box, Mapping):
        raise complain(TypeError, "box", 'a mapping like {"lam": (0, 5), 2: (None, 1)}', box)
    found: list[tuple[str | int, Extreme | TargetValue]] = []
    for key, interval in box.items():
        component = -1 if key == "y" else _component(key, labels, size)
        for value, side in zip(_interval(key, interval), (-1, 1)):
            if value is not None:
                face = Extreme(value, side) if key == "y" else TargetValue(value, component, direction=side)
                found.append((key, face))
    return found


def _interval(key: Any, interval: Any) -> tuple[float | None, float | None]:
    pair = isinstance(interval, tuple | list) and len(interval) == 2
    if not pair or any(not (end is None or is_number(end)) for end in interval):
        raise complain(TypeError, "box", f"two numbers for {key!r}, low and high, or None for one of them", interval)
    low, high = (None if end is None or math.isinf(end) else float(end) for end in interval)
    if low is not None and high is not None and not low < high:
        raise complain(ValueError, "box", f"low < high for {key!r}", interval)
    return low, high


def _component(key: Any, labels: Labels, size: int) -> int:
    if isinstance(key, str):
        try:
            return labels.index(key)
        except ValueError as error:
            raise ValueError(str(error).replace("name:", "box:", 1)) from None
    if not isinstance(key, int) or isinstance(key, bool) or not -1 <= key < size - 1:
        raise complain(ValueError, "box", f'"lam", "y", a name, or a number from 0 to {size - 2}', key)
    return key
