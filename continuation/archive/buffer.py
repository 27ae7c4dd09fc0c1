"""What a log holds in memory: rows that wait for a commit, the path being written, and points to resume from."""

from __future__ import annotations

from attrs import define, field, frozen

from continuation.archive.rows import Row
from continuation.path import Step
from continuation.step.state import State
from continuation.step.tracer import Tracer


@frozen(eq=False)
class Mark:
    """A point to resume from: the state, the counters there, and how many rows of the path come before it."""

    state: State
    counts: tuple[int, ...]
    rows: int


@define(eq=False)
class Buffer:
    """Rows not yet committed, and the number of the first: one object, so that a commit is one assignment."""

    start: int
    rows: list[Row] = field(factory=list)
    nbytes: int = 0


@define(eq=False)
class OpenPath:
    """The path being written."""

    tracer: Tracer
    number: int
    rows: int = 0
    seconds: float = 0.0
    run: bytes | None = None
    last: Mark | None = None
    resume: Mark | None = None
    skipped: Step | None = None
