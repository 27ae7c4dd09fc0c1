"""User-defined checks of arcs."""

from __future__ import annotations

from typing import Any, Protocol

from continuation.arguments.checks import complain
from continuation.point.arc import Arc


class Guard(Protocol):
    """A function that says why an arc does not count. The tracer repeats a refused step with a shorter length.

    Guards run last, on the part of the arc that counts: after the tracer's own checks, up to the target, kink or event
    where the path ends. They do not see ends found by `finish` or by the endgame.
    """

    def __call__(self, arc: Arc, /) -> str | None:
        """Return why the path between two points does not count.

        Parameters
        ----------
        arc : Arc
            The points `arc.a` and `arc.b` have `u`, `y`, `lam`, `tangent` and the metric's `weights`; `arc.samples`
            gives points between them with tangents, without evaluations of H.

        Returns
        -------
        str or None
            None if the arc counts; else the reason, for the message.
        """
        ...


def objection(guard: Guard, arc: Arc) -> str:
    """Return the guard's objection to an arc, "" for none; raise `TypeError` for any other answer."""
    answer: Any = guard(arc)
    if answer is None or isinstance(answer, str):
        return answer or ""
    raise complain(TypeError, "guards", "None, or a string that says why the arc does not count", answer)
