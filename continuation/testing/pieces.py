"""Checks of piecewise smooth maps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.pieces import Pieces, Signs
from continuation.testing import derivatives
from continuation.testing.protocol import answers
from continuation.testing.subject import Place, Subject, compare, random_directions, reporting, require

SAME_VALUE = 1e4
"""Allowed difference of two formulas, in round-off."""

MOVED_ULPS = 64.0
"""Motion of a point, in ulps, to sample round-off."""

SMOOTH = 1e-4
"""Relative difference of one-sided derivatives of a switch."""


_vectors = answers(
    "switches",
    lambda h, place: [np.asarray(h.switches(u[:-1].copy(), float(u[-1]))) for u in (place.u, np.append(*h.start()))],
    lambda pair, _: (
        pair[0].ndim == 1
        and pair[0].size == pair[1].size
        and pair[0].dtype.kind in "fiu"
        and bool(np.isfinite(pair[0]).all())
    ),
    "as many finite real numbers as at the start",
)


def switches(subject: Subject) -> None:
    """`switches` gives equally many finite numbers everywhere, and is smooth.

    Differences from both sides agree up to curvature, which shrinks with the step.
    """
    _vectors(subject)
    each = Pieces(subject.homotopy)
    for place in subject.places:
        u, v = place.u, random_directions(place.u.size, 1, 23)[0]
        with reporting("switches", f"beside the point {place.where}"):
            far, near = (
                np.abs(each.values(u + h * v) - 2.0 * each.values(u) + each.values(u - h * v)) / h for h in (1e-4, 1e-5)
            )
            slope = np.abs(each.along(u, v))
        bad = (near > SMOOTH * (1.0 + slope)) & (near > 0.5 * far)
        require(not bad.any(), f"switches: {place.where} number {int(np.argmax(bad))} is not differentiable")


def pieces(subject: Subject) -> None:
    """Each piece is a homotopy and equals the map where its signs hold, kinks included."""
    for place, signs, piece in _met(subject):
        with reporting("residual of the piece", place.where):
            found = piece.residual(place.y, place.lam)
            wanted = np.asarray(subject.homotopy.residual(place.y, place.lam), dtype=float)
            move = np.spacing(np.abs(subject.path.u).max(axis=0)) * np.sign(random_directions(place.u.size, 1, 29)[0])
            odd = np.where(np.arange(move.size) % 2, move, -move)
            near = [place.u + MOVED_ULPS * way for way in (move, -move, odd)]
            looks = [np.asarray(subject.homotopy.residual(u[:-1], float(u[-1]))) for u in near]
            round_off = np.max([np.abs(look - wanted) for look in looks], axis=0) / MOVED_ULPS
        shown = "".join("+" if sign > 0 else "-" for sign in signs[:40]) + ("..." if len(signs) > 40 else "")
        what = f"the piece {shown} differs from the map: number"
        compare("piece", place, what, found, wanted, SAME_VALUE * round_off + np.finfo(float).tiny)


def derivatives_of_pieces(subject: Subject) -> None:
    """The pieces' derivatives are right."""
    for place, _, made in _met(subject):
        piece = Subject(made)
        # The piece's own start and path may lie beyond its border.
        vars(piece)["places"] = (place,)
        for name in ("jacobian", "differential", "bordered"):
            if piece.has(name):
                getattr(derivatives, name)(piece)


def _met(subject: Subject) -> Iterator[tuple[Place, Signs, Any]]:
    """Places and up to three kinks, with all pieces there."""
    each = Pieces(subject.homotopy)
    found = []
    for place in subject.places:
        with reporting("switches", place.where):
            found.append((place, each.signs(place.u)))
    for event in subject.path.kinks[:3]:
        signs, place = each.signs(event.u), Place(f"at the kink at lam = {event.lam:.6g}", event.u)
        across = (tuple(-s if i == j else s for i, s in enumerate(signs)) for j in event.switches)
        found += [(place, one) for one in (signs, *across)]
    for place, signs in found:
        with reporting("piece", place.where):
            piece = subject.homotopy.piece(np.array(signs))
            Evaluator(piece, Counts())
        yield place, signs, piece
