"""User-defined checks of arcs."""

from __future__ import annotations

from typing import Any, Protocol

from continuation.arguments.checks import complain
from continuation.point.arc import Arc


class Guard(Protocol):
    """A function that says why an arc does not count; the step is then shortened.

    Guards run last, on the part of the arc that counts, up to where the path ends. They do not see ends found by
    `finish` or the endgame.
    """

    def __call__(self, arc: Arc, /) -> str | None:
        """Return why the arc does not count.

        Parameters
        ----------
        arc : Arc
            Its ends `arc.a` and `arc.b` have `u`, `y`, `lam`, `tangent`, `weights`; `arc.samples` has points and
            tangents between them, free of evaluations.

        Returns
        -------
        str or None
            None if it counts; else the reason.
        """
        ...


def objection(guard: Guard, arc: Arc) -> str:
    """Return the guard's answer, "" for None; `TypeError` for a wrong type."""
    answer: Any = guard(arc)
    if answer is None or isinstance(answer, str):
        return answer or ""
    raise complain(TypeError, "guards", "None, or a string that says why the arc does not count", answer)
