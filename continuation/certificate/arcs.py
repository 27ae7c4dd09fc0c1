"""Kinked paths: each smooth arc is proved on its piece and joined to the next.

Just before and behind an arc's end the switch has different signs, so the arc's curve has a zero z between. Both pieces
equal the map at z; the next arc's tube must hold z. The switch's derivative along either curve has one sign, so z is
unique.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.certificate.cells import OVERHANG, SLAB_PARTS, Cells, Index, Slabs, at_node, joined
from continuation.certificate.engine import Engine, Judged, up_by
from continuation.certificate.folds import Piece, SignsAlong, signs, turning, turns
from continuation.certificate.krawczyk import ByIntervals
from continuation.certificate.links import nodes, reach
from continuation.certificate.proof import Gap, Proof, merged
from continuation.numbers.boxes import derivatives, with_gradient
from continuation.numbers.ends import Ends, bilinear, thin
from continuation.path import LocatedEvent, Path, Step
from continuation.status import Kind, Status

NEXT_TO = 10.0 ** -np.arange(4.0, 10.0)
"""Distances from an arc's end, in lengths of the last cell, at which a switch's sign is tried."""

NO_KINK = "a kink is listed where there is none"
NOT_LISTED = "a kink that the path does not list"

Prove = Callable[[Any, Path, Cells | None, SignsAlong], tuple[Proof, Engine, list[list[Piece]]]]


@frozen(eq=False)
class SmoothPart:
    """An arc between two kinks, with its switches' signs."""

    signs: Array
    proof: Proof
    engine: Engine


def by_pieces(homotopy: Any, path: Path, cells: Cells | None, prove: Prove) -> Proof:
    """Prove a path in pieces, or check `cells`; `prove` proves an arc."""
    switches = ByIntervals(homotopy.switches, path.u.shape[1] - 1)
    kinks, gaps = _listed(path)
    places = [0, *(kink.step for kink in kinks), len(path) - 1]
    tied = [(), *(kink.switches for kink in kinks), ()]
    others = [event for event in path.events if event.kind is not Kind.KINK]
    arcs: list[SmoothPart | None] = []
    before = None
    for k, (first, last) in enumerate(pairwise(places)):
        if first == last:
            arcs.append(None)
            continue
        steps, ends = path.steps[first : last + 1], (tied[k], tied[k + 1])
        here, before = _signs(homotopy, steps, ends, before)
        span = steps[0].arclength, steps[-1].arclength
        if before is None:
            arcs.append(None)
            gaps += [Gap(*here, NOT_LISTED), Gap(*span, "it is not on one piece")]
            continue
        events = [e for e in others if (e.step > first or not first) and (e.step <= last or last == places[-1])]
        known = cells
        if cells is not None:
            known = cells.take((cells.place[:, 0] >= span[0]) & (cells.place[:, 1] <= span[1]))
        status = path.status if last == places[-1] else Status.STOPPED_AT_EVENT
        points = _from(steps, kinks[k - 1] if k else None)
        part = Path(steps=points, events=events, status=status)
        proof, engine, numbers = prove(homotopy.piece(before), part, known, _look_at(switches))
        arcs.append(SmoothPart(before, proof, engine))
        gaps += proof.gaps
        if len(proof.cells):
            firsts, lasts = _at_ends(engine, switches, proof.cells)
            for j, found in enumerate(numbers[1:]):
                at = j in ends[0], j in ends[1]
                why = _kept([firsts[j], *found, lasts[j]], len(proof.cells), int(before[j]), at)
                gaps += [Gap(*span, why)] if why else []
    crossed = []
    for kink, left, right in zip(kinks, arcs, arcs[1:]):
        joint = _joined(homotopy, left, right, kink)
        if isinstance(joint, str):
            gaps.append(Gap(kink.arclength, kink.arclength, joint))
        else:
            crossed.append(joint)
    proofs = [arc.proof for arc in arcs if arc is not None]
    if not proofs:
        return Proof.empty(path.u.shape[1], *merged(gaps))
    return evolve(
        proofs[-1],
        cells=joined([proof.cells for proof in proofs]),
        node_radius=np.concatenate([proof.node_radius for proof in proofs]),
        gaps=merged(gaps),
        turning_points=tuple(turn for proof in proofs for turn in proof.turning_points),
        kinks=tuple(crossed),
    )


def _listed(path: Path) -> tuple[list[LocatedEvent], list[Gap]]:
    out: list[LocatedEvent] = []
    gaps = []
    for kink in sorted(path.kinks, key=lambda event: event.step):
        step, s = path.steps[min(max(kink.step, 1), len(path) - 1)], kink.arclength
        # No arc leads to a first kink.
        if kink.step != step.index or s != step.arclength or not (kink.u == step.u).all():
            gaps.append(Gap(s, s, NO_KINK))
        elif out and out[-1].step == kink.step:
            gaps.append(Gap(s, s, "more kinks are listed"))
        else:
            out.append(kink)
    return out, gaps


def _signs(
    homotopy: Any, steps: list[Step], ends: tuple[tuple[int, ...], ...], before: Array | None
) -> tuple[tuple[float, float], Array | None]:
    """The last step examined, and each switch's sign; None off one piece."""
    with np.errstate(all="ignore"):
        values = np.array([homotopy.switches(step.u[:-1], step.u[-1]) for step in steps], dtype=float)
        middle = 0.5 * (steps[0].u + steps[1].u)
        found = np.where(np.asarray(homotopy.switches(middle[:-1], middle[-1]), dtype=float) > 0.0, 1, -1)
    if before is not None:
        # A switch that is zero at both ends of a step is zero in its chord's middle.
        crossed = [j for j in ends[0] if 0 <= j < len(found)]
        found[crossed] = -before[crossed]
    for row, end in zip((0, -1), ends):
        known = [j for j in end if 0 <= j < len(found)]
        values[row, known] = found[known]
    wrong = [k for k, row in enumerate(values) if not (row * found > 0.0).all()]
    k = max(wrong[0], 1) if wrong else len(steps) - 1
    return (steps[k - 1].arclength, steps[k].arclength), None if wrong else found


def _from(steps: list[Step], kink: LocatedEvent | None) -> list[Step]:
    if kink is None:
        return steps
    away = np.full_like(kink.u, np.nan) if kink.rays is None or len(kink.rays) < 2 else kink.rays[1]
    return [evolve(steps[0], tangent=away), *steps[1:]]


def _look_at(switches: ByIntervals) -> SignsAlong:
    """A function that observes the parameter's rate, the switches and their derivatives along the curve."""

    def look(judged: Judged, slabs: Slabs, radius: Array) -> list[tuple[Index, Index]]:
        owner = np.repeat(np.arange(len(slabs)), SLAB_PARTS)
        box, t = slabs.halved(SLAB_PARTS).box(radius[owner]), judged.tangent(radius, radius)[owner]
        image = switches.image(with_gradient(box.lo, box.hi))
        with np.errstate(all="ignore"):
            slope = bilinear(np.matmul, Ends(*derivatives(image, radius.shape[1])), t[..., None])
        both = (x.T.reshape(-1, len(slabs), SLAB_PARTS) for x in (signs(image.c[0]), signs(slope[..., 0])))
        return [*turning(judged, slabs, radius), *zip(*both)]

    return look


def _at_ends(engine: Engine, switches: ByIntervals, cells: Cells) -> tuple[list[Piece], list[Piece]]:
    s, sides = np.array([0.0, 1.0]), cells.take([0, -1])
    radius = nodes(engine, sides, s).radius
    radius = np.where((radius <= sides.radius).all(axis=1, keepdims=True), radius, np.nan)
    first, last = _value_at(switches, at_node(sides, s), radius).tolist()
    end = float(len(cells))
    return [Piece(0.0, 0.0, sign, 0) for sign in first], [Piece(end, end, sign, 0) for sign in last]


def _value_at(switches: ByIntervals, slabs: Slabs, radius: Array) -> Index:
    box = slabs.cubic[:, 0] + Ends(-radius, radius)
    return signs(switches.image(with_gradient(box.lo, box.hi)).c[0])


def _kept(found: list[Piece], count: int, sign: int, at: tuple[bool, bool]) -> str:
    """Why a switch may change its sign on an arc. `at`: whether it should vanish at either end."""
    begin, *inner, end = found
    # A switch that vanishes at an end is round-off there.
    found = [*([] if at[0] or not begin.sign else [begin]), *inner, *([] if at[1] or not end.sign else [end])]
    understood, unknown = turns(found)
    first = [turn for turn in understood if turn.lo <= 0.0 <= turn.hi]
    last = [turn for turn in understood if turn.lo <= count <= turn.hi]
    lo, hi = max((t.hi for t in first), default=-np.inf), min((t.lo for t in last), default=np.inf)
    between = [piece.sign for piece in found if lo < 0.5 * (piece.lo + piece.hi) < hi]
    if unknown or not any(between):
        return "kinks could not be counted"
    if len(understood) > len(first) + len(last) or -sign in between or (bool(first), bool(last)) > at:
        return NOT_LISTED
    return NO_KINK if (len(first), len(last)) != at else ""


def _joined(
    homotopy: Any, before: SmoothPart | None, after: SmoothPart | None, kink: LocatedEvent
) -> tuple[float, float] | str:
    """A range of arclength that holds the kink, or why the arcs are not joined."""
    if len(kink.switches) != 1:
        return "several switches vanish in one kink" if kink.switches else NO_KINK
    (j,), s = kink.switches, kink.arclength
    if before is None or after is None:
        return "there is no proof on either side of the kink"
    if not 0 <= j < len(before.signs) or before.signs[j] == after.signs[j]:
        return NO_KINK
    left, right = before.proof.cells.take(slice(-1, None)), after.proof.cells.take(slice(0, 1))
    why = "two arcs are not joined in the kink"
    if not (len(left) and len(right) and left.place[0, 1] == s == right.place[0, 0]):
        return why
    switches, sides = ByIntervals(homotopy.switches, kink.u.size - 1), joined([left, left])
    for delta in NEXT_TO.tolist():
        window = nodes(before.engine, left, np.ones(1), delta)
        # False for nan (not proved).
        if not (window.radius <= left.radius).all():
            continue
        slabs = Slabs(np.arange(2), np.array([1.0 - delta, 1.0 + delta]), np.zeros(2), sides)
        if (_value_at(switches, slabs, window.radius[[0, 0]])[:, j] != (before.signs[j], after.signs[j])).any():
            continue
        room = Slabs(np.zeros(1, dtype=np.intp), np.ones(1), np.full(1, delta), left)
        off = up_by(window.radius + (room.over[0] - thin(left.end)).magnitude(), 2)
        if not (reach(right, np.zeros(1), Ends(-off, off)) <= right.radius).all():
            continue
        came, goes = _rate(before.engine, left, 1.0, off), _rate(after.engine, right, 0.0, off)
        if not came * goes:
            why = "whether the parameter turns in the kink is not decided"
            continue
        if kink.name != ("kink" if came == goes else "turning kink"):
            return "the parameter does not turn in the kink as the path says"
        return s - delta * (s - float(left.place[0, 0])), s + OVERHANG * (float(right.place[0, 1]) - s)
    return why


def _rate(engine: Engine, cell: Cells, s: float, off: Array) -> int:
    t = engine.judge(at_node(cell, np.array([s])), off).tangent(off, off)
    return int(signs(t[0, -1]))
