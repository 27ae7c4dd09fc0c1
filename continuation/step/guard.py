"""Checks of arcs by users."""

from __future__ import annotations

from typing import Any, Protocol

from continuation.arguments.checks import complain
from continuation.point.arc import Arc


class Guard(Protocol):
    """A function that may reject an arc, whose step is then shortened.

    Guards run last, on the arc up to the path's end; ends by `finish` or endgame are not shown to them.
    """

    def __call__(self, arc: Arc, /) -> str | None:
        """Return why the arc does not count, or None.

        Parameters
        ----------
        arc : Arc
            Ends `arc.a`, `arc.b` have `u`, `y`, `lam`, `tangent`, `weights`; `arc.samples` are points and tangents
            between.
        """
        ...


def objection(guard: Guard, arc: Arc) -> str:
    """The guard's answer, "" for None; `TypeError` for others."""
    answer: Any = guard(arc)
    if answer is None or isinstance(answer, str):
        return answer or ""
    raise complain(TypeError, "guards", "None, or a string that says why the arc does not count", answer)
