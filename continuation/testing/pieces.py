"""Checks of piecewise smooth maps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from continuation.arrays import ROOT_OF_ROUND_OFF
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.pieces import Pieces, Signs
from continuation.testing import derivatives
from continuation.testing.subject import Subject, TestedPoint, compare, reporting


def pieces(subject: Subject) -> None:
    """Each piece is a homotopy and equals the map where its signs hold, kinks included."""
    # A kink is known to the round-off of the path, in which an unknown that vanishes there has no digit.
    farthest = np.abs([step.u for step in subject.path.steps]).max(axis=0)
    for place, signs, piece in _met(subject):
        with reporting("residual of the piece", place.where):
            found = piece.residual(place.y, place.lam)
            wanted = np.asarray(subject.homotopy.residual(place.y, place.lam), dtype=float)
        size = np.maximum(np.abs(place.u), ROOT_OF_ROUND_OFF * farthest)
        allowed = ROOT_OF_ROUND_OFF * np.abs(Subject(piece).derivative(place)) @ size
        shown = "".join("+" if sign > 0 else "-" for sign in signs[:40])
        compare("piece", place, f"the piece {shown} differs from the map: number", found, wanted, allowed)


def derivatives_of_pieces(subject: Subject) -> None:
    """The pieces' derivatives are right."""
    for place, _, made in _met(subject):
        piece = Subject(made)
        # The piece's own start and path may lie beyond its border.
        vars(piece)["places"] = (place,)
        for name in ("jacobian", "differential", "bordered"):
            if piece.has(name):
                getattr(derivatives, name)(piece)


def _met(subject: Subject) -> Iterator[tuple[TestedPoint, Signs, Any]]:
    """Places and up to three kinks, with all pieces there."""
    each = Pieces(subject.homotopy)
    found = []
    for place in subject.places:
        with reporting("switches", place.where):
            found.append((place, each.signs(place.u)))
    for event in subject.path.kinks[:3]:
        signs, place = each.signs(event.u), TestedPoint(f"at the kink at lam = {event.lam:.6g}", event.u)
        across = (tuple(-s if i == j else s for i, s in enumerate(signs)) for j in event.switches)
        found += [(place, one) for one in (signs, *across)]
    for place, signs in found:
        with reporting("piece", place.where):
            piece = subject.homotopy.piece(np.array(signs))
            Evaluator(piece, Counts())
        yield place, signs, piece
