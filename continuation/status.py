"""How a path ended, each way a sentence with the next move; and what a stored point is."""

from __future__ import annotations

from enum import IntEnum


class Status(IntEnum):
    """The end of a path. Numbers are stored in archives: they are added to, never renumbered."""

    TRACING = 0
    REACHED_TARGET = 1
    STOPPED_AT_EVENT = 2
    CLOSED = 3
    TURNED_BACK = 4
    DIVERGED = 5
    STEP_TOO_SMALL = 6
    LEFT_DOMAIN = 7
    SINGULAR_START = 8
    BUDGET_EXHAUSTED = 9
    INTERRUPTED = 10
    START_NOT_ON_PATH = 11
    PREDICTOR_FAILED = 12
    DEAD_END = 13
    UNRESOLVED_KINK = 14
    ABANDONED = 15
    RAISED = 16

    def __str__(self) -> str:
        return _SENTENCES[self]

    def __bool__(self) -> bool:
        return self.success

    @property
    def success(self) -> bool:
        """Whether the path came to an end that was asked for: the target, a terminal event, or its own start."""
        return self in (Status.REACHED_TARGET, Status.STOPPED_AT_EVENT, Status.CLOSED)

    @property
    def flag(self) -> str:
        """The name in lower case, as CF flag_meanings want it."""
        return self.name.lower()


_SENTENCES = {
    Status.TRACING: "The path is still being traced.",
    Status.REACHED_TARGET: "The path reached the target.",
    Status.STOPPED_AT_EVENT: "The path stopped at a terminal event.",
    Status.CLOSED: "The path returned to its start with the same direction: it is a closed curve.",
    Status.TURNED_BACK: "The path came back to the start's parameter value: it will not reach the target this way.",
    Status.DIVERGED: "The path runs off to infinity while the parameter stalls: there is no end to reach.",
    Status.STEP_TOO_SMALL: "The step fell below its floor; loosen `tolerance`, or look for a singular point near it.",
    Status.LEFT_DOMAIN: "The path left the set on which the homotopy can be evaluated; check the formulas there.",
    Status.SINGULAR_START: "The Jacobian [H_y, H_lam] has no full rank at the start; start elsewhere.",
    Status.BUDGET_EXHAUSTED: "The budget is used up; raise `budget`, or resume from the archive.",
    Status.INTERRUPTED: "The trace was interrupted by hand; all accepted points are kept and it can be resumed.",
    Status.START_NOT_ON_PATH: "The start is not on the path and the corrector could not bring it there.",
    Status.PREDICTOR_FAILED: "The predictor found no curve to follow from the last point; take another `predictor`.",
    Status.DEAD_END: "No branch leaves the kink at which the path ends, but the one it came on.",
    Status.UNRESOLVED_KINK: "The path ends at a kink whose branches could not be told; see the message.",
    Status.ABANDONED: "The trace was left before the path ended; all accepted points are kept and it can be resumed.",
    Status.RAISED: "An exception ended the trace; all accepted points are kept, mend that and resume.",
}


class Kind(IntEnum):
    """What a stored point is. Numbers are stored in archives: they are added to, never renumbered."""

    REGULAR = 0
    START = 1
    TARGET = 2
    TURNING_POINT = 3
    BRANCH_POINT = 4
    EVENT = 5
    KINK = 6
    SINGULAR_POINT = 7
    HOPF = 8

    def __repr__(self) -> str:
        return f"Kind.{self.name}"

    @property
    def flag(self) -> str:
        """The name in lower case, as CF flag_meanings want it."""
        return self.name.lower()
