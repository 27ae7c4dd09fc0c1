"""How a path ended, and kinds of stored points."""

from __future__ import annotations

from enum import IntEnum


class Described(IntEnum):
    """Numbers with sentences."""

    def __new__(cls, number: int, sentence: str = "") -> Described:
        """Make a member."""
        member = int.__new__(cls, number)
        member._value_ = number
        member.__doc__ = sentence
        return member

    @property
    def flag(self) -> str:
        """Name, for CF flag_meanings."""
        return self.name.lower()


class Status(Described):
    """The end of a path; archives store the number: never renumber."""

    TRACING = 0, "The path is still being traced."
    REACHED_TARGET = 1, "The path reached the target."
    STOPPED_AT_EVENT = 2, "The path stopped at a terminal event."
    CLOSED = 3, "The path returned to its start with the same direction: it is a closed curve."
    TURNED_BACK = 4, "The path came back to the start's parameter value: it will not reach the target this way."
    DIVERGED = 5, "The path runs off to infinity while the parameter stalls: there is no end to reach."
    STEP_TOO_SMALL = 6, "The step fell below its floor; loosen `tolerance`, or look for a singular point near it."
    LEFT_DOMAIN = 7, "The path left the set on which the homotopy can be evaluated; check the formulas there."
    SINGULAR_START = 8, "The Jacobian [H_y, H_lam] has no full rank at the start; start elsewhere."
    BUDGET_EXHAUSTED = 9, "The budget is used up; raise `budget`, or resume from the archive."
    INTERRUPTED = 10, "The trace was interrupted by hand; all accepted points are kept and it can be resumed."
    START_NOT_ON_PATH = 11, "The start is not on the path and the corrector could not bring it there."
    PREDICTOR_FAILED = 12, "The predictor found no curve to follow from the last point; take another `predictor`."
    DEAD_END = 13, "No branch leaves the kink at which the path ends, but the one it came on."
    UNRESOLVED_KINK = 14, "The path ends at a kink whose branches could not be told; see the message."
    ABANDONED = 15, "The trace was left before the path ended; all accepted points are kept and it can be resumed."
    RAISED = 16, "An exception ended the trace; all accepted points are kept, mend that and resume."

    def __str__(self) -> str:
        return str(self.__doc__)

    def __bool__(self) -> bool:
        return self.success

    @property
    def success(self) -> bool:
        """Whether the path reached a requested end: target, terminal event, or its own start."""
        return self in (Status.REACHED_TARGET, Status.STOPPED_AT_EVENT, Status.CLOSED)


class Kind(Described):
    """Kind of a stored point; archives store the number: never renumber."""

    REGULAR = 0, "A point like others."
    START = 1, "Where the path begins."
    TARGET = 2, "Where the parameter takes the target's value."
    TURNING_POINT = 3, "A fold: the parameter turns back."
    BRANCH_POINT = 4, "Another branch crosses."
    EVENT = 5, "A zero of an event's monitor."
    KINK = 6, "Two smooth pieces of the path meet."
    SINGULAR_POINT = 7, "Several branches meet, or it is degenerate: the kernel of H' may have three dimensions."
    HOPF = 8, "A pair of eigenvalues crosses the imaginary axis."

    def __repr__(self) -> str:
        return f"Kind.{self.name}"
