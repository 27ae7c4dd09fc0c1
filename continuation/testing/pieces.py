"""Checks of piecewise smooth maps."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.pieces import Pieces, Signs
from continuation.testing import derivatives
from continuation.testing.protocol import answers, difference
from continuation.testing.subject import Place, Subject, fail, random_directions, reporting, require

SAME_VALUE = 1e4
"""Allowed difference of two formulas, in round-off."""

MOVED_ULPS = 64.0
"""Motion of a point, in ulps, to sample round-off."""

SMOOTH = 1e-4
"""Relative difference of one-sided derivatives of a switch."""


def switches(subject: Subject) -> None:
    """`switches` gives equally many finite numbers everywhere, and is smooth."""
    _vectors(subject)
    for place in subject.places:
        _smooth(subject, place)


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


def _smooth(subject: Subject, place: Place) -> None:
    """Differences from both sides agree up to curvature, which shrinks with the step."""
    v = random_directions(place.u.size, 1, 23)[0]
    values = Pieces(subject.homotopy).values

    def kink(h: float) -> Array:
        return np.abs(values(place.u + h * v) - 2.0 * values(place.u) + values(place.u - h * v)) / h

    with reporting("switches", f"beside the point {place.where}"):
        far, near = kink(1e-4), kink(1e-5)
        slope = np.abs(Pieces(subject.homotopy).along(place.u, v))
    bad = (near > SMOOTH * (1.0 + slope)) & (near > 0.5 * far)
    require(not bad.any(), f"switches: {place.where} number {int(np.argmax(bad))} is not differentiable")


def pieces(subject: Subject) -> None:
    """Each piece is a homotopy and equals the map where its signs hold, kinks included."""
    for place, signs in _met(subject):
        piece = _piece(subject, place, signs)
        with reporting("residual of the piece", place.where):
            found = np.asarray(piece.residual(place.y, place.lam), dtype=float)
            wanted = np.asarray(subject.homotopy.residual(place.y, place.lam), dtype=float)
            round_off = _round_off(subject, place, wanted)
        allowed = SAME_VALUE * round_off + np.finfo(float).tiny
        if found.shape != wanted.shape or not (np.abs(found - wanted) <= allowed).all():
            signed = _shown(signs)
            fail(f"piece: {place.where} the piece {signed} differs from the map by {difference(found, wanted):.3g}")


def _round_off(subject: Subject, place: Place, value: Array) -> Array:
    move = np.spacing(np.abs(subject.path.u).max(axis=0)) * np.sign(random_directions(place.u.size, 1, 29)[0])
    moves = [MOVED_ULPS * move, -MOVED_ULPS * move, MOVED_ULPS * np.where(np.arange(move.size) % 2, move, -move)]
    looks = [np.asarray(subject.homotopy.residual((place.u + m)[:-1], float((place.u + m)[-1]))) for m in moves]
    rounded: Array = np.max([np.abs(look - value) for look in looks], axis=0) / MOVED_ULPS
    return rounded


def derivatives_of_pieces(subject: Subject) -> None:
    """The pieces' derivatives are right."""
    for place, signs in _met(subject):
        piece = Subject(_piece(subject, place, signs))
        # The piece's own start and path may lie beyond its border.
        vars(piece)["places"] = (place,)
        for name in ("jacobian", "differential", "bordered"):
            if piece.has(name):
                getattr(derivatives, name)(piece)


def _met(subject: Subject) -> list[tuple[Place, Signs]]:
    """Places and up to three kinks, with all pieces there."""
    each = Pieces(subject.homotopy)
    found = []
    for place in subject.places:
        with reporting("switches", place.where):
            found.append((place, each.signs(place.u)))
    for event in subject.path.kinks[:3]:
        signs = each.signs(event.u)
        place = Place(f"at the kink at lam = {event.lam:.6g}", event.u)
        found.append((place, signs))
        found += [(place, tuple(-s if i == j else s for i, s in enumerate(signs))) for j in event.switches]
    return found


def _piece(subject: Subject, place: Place, signs: Signs) -> Any:
    with reporting("piece", place.where):
        piece = subject.homotopy.piece(np.array(signs))
        Evaluator(piece, Counts())
    return piece


def _shown(signs: Signs) -> str:
    return "".join("+" if sign > 0 else "-" for sign in signs[:40]) + ("..." if len(signs) > 40 else "")
