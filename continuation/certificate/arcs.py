"""Kinked paths: each smooth arc proved with the equations of its piece, and joined to the next at a zero of a switch.

Near its end the curve of an arc lies in boxes p(1 - delta) and p(1 + delta) + [-r, r], on which the switch that
vanishes at the kink has different signs: it has a zero z in between. There both pieces are the map, so that z is a zero
of the next piece's equations as well; where the next arc's tube holds z, it lies on that arc's curve. Either curve has
one zero of the switch there, its derivative along the curve having a sign: the one begins where the other ends.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.certificate.cells import OVERHANG, Cells, Slabs, at_node, joined
from continuation.certificate.engine import Engine, up_by
from continuation.certificate.krawczyk import ByIntervals, engine_of
from continuation.certificate.links import nodes, reach
from continuation.certificate.proof import Gap, Proof, merged
from continuation.certificate.switches import judged, signs_along, value_at
from continuation.numbers.boxes import derivatives, with_gradient
from continuation.numbers.ends import Ends, bilinear, thin
from continuation.path import LocatedEvent, Path, Step
from continuation.status import Kind, Status

NEXT_TO = 10.0 ** -np.arange(4.0, 10.0)
"""How far from its end the signs of a switch are asked, in lengths of the last cell: the first that will do."""

NO_KINK = "a kink is listed where there is none"

Prove = Callable[[Any, Path, Cells | None], tuple[Proof, Engine]]


@frozen(eq=False)
class SmoothPart:
    """What is between two kinks.

    Attributes
    ----------
    signs : ndarray of int
        Of the switches.
    proof : Proof
    engine : Engine
    ends : tuple of tuple of int
        The switches that vanish where it begins, and where it ends.
    """

    signs: Array
    proof: Proof
    engine: Engine
    ends: tuple[tuple[int, ...], tuple[int, ...]]


def by_pieces(homotopy: Any, path: Path, cells: Cells | None, prove: Prove) -> Proof:
    """The proof of a path of a homotopy in pieces.

    Parameters
    ----------
    homotopy : SupportsPieces
    path : Path
    cells : Cells or None
        Of a proof that is checked again.
    prove : callable
        Proves a smooth path, or checks the cells of a proof of it.
    """
    switches = ByIntervals(homotopy.switches, path.u.shape[1] - 1)
    kinks, gaps = _listed(path)
    places = [0, *(kink.step for kink in kinks), len(path) - 1]
    tied = [(), *(kink.switches for kink in kinks), ()]
    arcs, others = [], [event for event in path.events if event.kind is not Kind.KINK]
    before = None
    for k, (first, last) in enumerate(pairwise(places)):
        if first == last:  # a kink in which the path ends
            continue
        steps, ends = path.steps[first : last + 1], (tied[k], tied[k + 1])
        signs, told = _signs(homotopy, steps, ends, before)
        gaps, before = gaps + told, None if told else signs
        begin, end = steps[0].arclength, steps[-1].arclength
        if told:
            gaps.append(Gap(begin, end, "it is not on one piece"))
            continue
        events = [e for e in others if (e.step > first or not first) and (e.step <= last or last == places[-1])]
        known = None
        if cells is not None:
            known = cells.take((cells.place[:, 0] >= begin) & (cells.place[:, 1] <= end))
        status = path.status if last == places[-1] else Status.STOPPED_AT_EVENT
        points = _from(steps, kinks[k - 1] if k else None)
        proof, engine = prove(homotopy.piece(signs), Path(steps=points, events=events, status=status), known)
        arc = SmoothPart(signs, proof, engine, ends)
        gaps += [*proof.gaps, *_kept(arc, switches, (begin, end))]
        arcs.append(arc)
    by_end = {arc.proof.cells.place[-1, 1]: arc for arc in arcs if len(arc.proof.cells)}
    by_begin = {arc.proof.cells.place[0, 0]: arc for arc in arcs if len(arc.proof.cells)}
    crossed = []
    for kink in kinks:
        left, right = by_end.get(kink.arclength), by_begin.get(kink.arclength)
        if left is None or (right is None and kink.step < len(path) - 1):
            continue  # there is a gap
        found = _joined(homotopy, left, right, kink)
        if isinstance(found, str):
            gaps.append(Gap(kink.arclength, kink.arclength, found))
        else:
            crossed.append(found)
    if not arcs:
        return Proof.empty(path.u.shape[1], *merged(gaps))
    proofs = [arc.proof for arc in arcs]
    return evolve(
        proofs[-1],
        cells=joined([proof.cells for proof in proofs]),
        node_radius=np.concatenate([proof.node_radius for proof in proofs]),
        gaps=merged(gaps),
        turning_points=tuple(turn for proof in proofs for turn in proof.turning_points),
        kinks=tuple(crossed),
    )


def _listed(path: Path) -> tuple[list[LocatedEvent], list[Gap]]:
    """The kinks at points of the path, one a point."""
    out: list[LocatedEvent] = []
    gaps = []
    for kink in sorted(path.kinks, key=lambda event: event.step):
        step, s = path.steps[min(max(kink.step, 1), len(path) - 1)], kink.arclength
        # In a kink in which a path begins it has come from nowhere.
        if kink.step != step.index or s != step.arclength or not (kink.u == step.u).all():
            gaps.append(Gap(s, s, NO_KINK))
        elif out and out[-1].step == kink.step:
            gaps.append(Gap(s, s, "more kinks are listed"))
        else:
            out.append(kink)
    return out, gaps


def _signs(
    homotopy: Any, steps: list[Step], ends: tuple[tuple[int, ...], ...], before: Array | None
) -> tuple[Array, list[Gap]]:
    """Those of the switches between two kinks, given those before, and where the points are not on one piece."""
    with np.errstate(all="ignore"):
        values = np.array([homotopy.switches(step.u[:-1], step.u[-1]) for step in steps], dtype=float)
        middle = 0.5 * (steps[0].u + steps[1].u)
        signs = np.where(np.asarray(homotopy.switches(middle[:-1], middle[-1]), dtype=float) > 0.0, 1, -1)
    if before is not None:
        # What vanishes at both ends of a step is zero in the middle of its chord, too.
        crossed = [j for j in ends[0] if 0 <= j < len(signs)]
        signs[crossed] = -before[crossed]
    for row, end in zip((0, -1), ends):
        known = [j for j in end if 0 <= j < len(signs)]
        values[row, known] = signs[known]
    wrong = [k for k, row in enumerate(values) if not (row * signs > 0.0).all()]
    if not wrong:
        return signs, []
    k = max(wrong[0], 1)
    return signs, [Gap(steps[k - 1].arclength, steps[k].arclength, "a kink that the path does not list")]


def _from(steps: list[Step], kink: LocatedEvent | None) -> list[Step]:
    """The points of an arc. That of a kink has the tangent with which the path came: here it is to have the other."""
    if kink is None:
        return steps
    away = np.full_like(kink.u, np.nan) if kink.rays is None or len(kink.rays) < 2 else kink.rays[1]
    return [evolve(steps[0], tangent=away), *steps[1:]]


def _kept(arc: SmoothPart, switches: ByIntervals, span: tuple[float, float]) -> list[Gap]:
    """Where switches do not surely keep their signs."""
    cells = arc.proof.cells
    if not len(cells):
        return []
    gaps = []
    for j, found in enumerate(signs_along(arc.engine, switches, cells)):
        told = judged(found, len(cells), int(arc.signs[j]), (j in arc.ends[0], j in arc.ends[1]))
        if isinstance(told, str):
            gaps.append(Gap(*span, told))
    return gaps


def _joined(
    homotopy: Any, before: SmoothPart, after: SmoothPart | None, kink: LocatedEvent
) -> tuple[float, float] | str:
    """A range of arclength with the kink in which one arc goes over into the next, or why they are not proved to.

    Where the path ends in the kink there is no arc `after` it, and the next piece alone says whether the parameter
    turns: the curve of its zeros goes on to where the switch has the sign that it had not before.
    """
    if len(kink.switches) != 1:
        return "several switches vanish in one kink" if kink.switches else NO_KINK
    j = kink.switches[0]
    if not 0 <= j < len(before.signs):
        return NO_KINK
    signs = np.where(np.arange(len(before.signs)) == j, -before.signs, before.signs) if after is None else after.signs
    if before.signs[j] == signs[j]:
        return NO_KINK
    switches = ByIntervals(homotopy.switches, kink.u.size - 1)
    left = before.proof.cells.take(slice(-1, None))
    right = None if after is None else after.proof.cells.take(slice(0, 1))
    why = "two arcs are not joined in the kink"
    for delta in NEXT_TO.tolist():
        sides = joined([left, left])
        at = nodes(before.engine, sides, np.array([1.0 - delta, 1.0 + delta]))
        window = nodes(before.engine, left, np.ones(1), delta)
        # Within the tube it is the tube's curve; a nan, where nothing is proved, is not.
        if not ((at.radius <= left.radius).all() and (window.radius <= left.radius).all()):
            continue
        slabs = Slabs(np.arange(2), np.array([1.0 - delta, 1.0 + delta]), np.zeros(2), sides)
        change = value_at(switches, slabs, at.radius)[:, j]
        if change[0] != before.signs[j] or change[1] != signs[j]:
            continue
        room = Slabs(np.zeros(1, dtype=np.intp), np.ones(1), np.full(1, delta), left)
        off = up_by(window.radius + (room.over[0] - thin(left.end)).magnitude(), 2)
        if right is not None and not (reach(right, np.zeros(1), Ends(-off, off)) <= right.radius).all():
            continue
        came = _rate(before.engine, left, 1.0, off)
        if after is None or right is None:
            onward = engine_of(homotopy.piece(signs), np.vstack([left.begin, left.end]))
            goes = _rate(onward, left, 1.0, off, switches, j) * int(signs[j])
        else:
            goes = _rate(after.engine, right, 0.0, off)
        if not came * goes:
            why = "whether the parameter turns in the kink is not decided"
            continue
        if kink.name != ("kink" if came == goes else "turning kink"):
            return "the parameter does not turn in the kink as the path says"
        (begin, end), later = left.place[0].tolist(), kink.arclength if right is None else float(right.place[0, 1])
        return end - delta * (end - begin), end + OVERHANG * (later - end)
    return why


def _rate(engine: Engine, cell: Cells, s: float, off: Array, switches: ByIntervals | None = None, j: int = 0) -> int:
    """The sign with which the parameter moves along the curve at a point within `off` of a node; 0 where it has none.

    Along the curve is where the cell's chart advances, or where switch j grows.
    """
    t = engine.judge(at_node(cell, np.array([s])), off).tangent(off, off)
    found = _sign(t[0, -1])
    if switches is None:
        return found
    u = cell.end if s else cell.begin
    box = thin(u) + Ends(-off, off)
    slope = Ends(*derivatives(switches.image(with_gradient(box.lo, box.hi)), u.size))[0, j]
    with np.errstate(all="ignore"):
        grows = bilinear(np.matmul, slope, t[0])
    return found * _sign(grows)


def _sign(x: Ends) -> int:
    """That of one interval."""
    return int(x.lo > 0.0) - int(x.hi < 0.0)
