"""When a log commits what it has buffered."""

from __future__ import annotations

from attrs import field, frozen

from continuation.arguments.checks import integer, number


@frozen
class Limits:
    """When buffered rows are committed: at so many rows, bytes of points, or seconds since the last commit."""

    rows: int = field(default=256, validator=integer(1))
    nbytes: int = field(default=4 << 20, validator=integer(1))
    seconds: float = field(default=1.0, validator=number("at least 0", lambda x: x >= 0.0))
