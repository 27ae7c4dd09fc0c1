"""A check of one's own that every arc must pass before it counts."""

from __future__ import annotations

from typing import Any, Protocol

from continuation.arguments.checks import complain
from continuation.point.arc import Arc


class Guard(Protocol):
    """Says why an arc does not count; any function of an arc will do. A step that is refused is tried again, shorter.

    It is asked last, of the part of the arc that counts: after the tracer's own looks at what lies between the two
    points and at what crosses there, and up to the target, the kink or the event where the path ends. An end that no
    arc reaches, by `finish` or the endgame, is not asked about.
    """

    def __call__(self, arc: Arc, /) -> str | None:
        """Whether the path from one point to the next counts.

        Parameters
        ----------
        arc : Arc
            `arc.a` and `arc.b`, the two points, have `u`, `y`, `lam`, `tangent` and the metric's `weights`;
            `arc.samples` are points between them with tangents, at no evaluation of H.

        Returns
        -------
        str or None
            Nothing where it counts; else why it does not, as words for the message.
        """
        ...


def objection(guard: Guard, arc: Arc) -> str:
    """What a guard has against an arc; "" for nothing; `TypeError` if it answers with anything else."""
    answer: Any = guard(arc)
    if answer is None or isinstance(answer, str):
        return answer or ""
    raise complain(TypeError, "guards", "None, or a string that says why the arc does not count", answer)
