"""`certify`: prove that a traced path is one curve."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, Protocol, runtime_checkable

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.auditing.retrace import Halved, metric_of
from continuation.certificate.arcs import by_pieces
from continuation.certificate.cells import Cells, cell_between, joined
from continuation.certificate.closing import NEXT_TO_END, made
from continuation.certificate.engine import Engine
from continuation.certificate.folds import Piece, SignsAlong, turning
from continuation.certificate.krawczyk import engine_of
from continuation.certificate.proof import Gap, Proof
from continuation.certificate.tubes import Tubes, check, search
from continuation.certificate.verify import verified
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.homotopy import SupportsPieces
from continuation.linear.threads import one_thread
from continuation.metric import norm
from continuation.path import Path, Step
from continuation.path.path import require_path
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.step.options import Options
from continuation.step.tracer import Tracer
from continuation.tolerance import Tolerance

CELL_HALVINGS = 8
"""Most halvings of a cell: its fourth-order error is then round-off."""

TAIL_NODES = 60
"""Most points added next to a singular end; ten suffice if parameter and distance fall alike."""

END_RATIO = 0.25
"""Ratio of successive points' distances from the end. On 50 degenerate LCPs (n = 2 to 20, 618 points) 0.25 gives 768
boxes, 0.4 gives 792, 0.1 gives 784 in half more time."""


@frozen(eq=False)
class PathNode:
    """A point with tangent and metric."""

    u: Array
    tangent: Array
    weights: Array
    place: float


@one_thread
def certify(path: Path, homotopy: Any) -> Proof:
    """Prove that a traced path is one curve; unproved parts become gaps.

    If Krawczyk's test holds around the cubic between two points, this tube holds exactly one curve, perhaps with folds.
    Failing cells are halved. Turning points are compared, and the end is joined to the target.

    Parameters
    ----------
    path : Path
        Traced, or read from an archive.
    homotopy : Homotopy
        As traced. Its residual must run on interval arrays, unless it has its own bounds (`SupportsProofEngine`), like
        LCP homotopies.

    Raises
    ------
    TypeError
        If the residual does not run on interval arrays; the message names the operation.
    ValueError
        If the path has fewer than two points, or belongs to another homotopy.

    References
    ----------
    Krawczyk, Computing 4 (1969) 187-201; for curves, Breden, Lessard and Vanicat, Acta Appl. Math. 128 (2013) 113-152.
    """
    require_path(path)
    Evaluator(homotopy, Counts())  # raises if it is none
    width = path.u.shape[1]
    if width != len(np.atleast_1d(homotopy.start()[0])) + 1:
        raise ValueError(f"path: expected points of {homotopy}, found {width - 1} unknowns")
    return recheck(None, path, homotopy)


def recheck(cells: Cells | None, path: Path, homotopy: Any) -> Proof:
    """Prove a path, or check every condition of a proof with `cells` again."""
    found = lifted(homotopy, path, cells)
    if isinstance(found, Proof):
        return found
    whole, longer = found
    if isinstance(whole, SupportsPieces):
        proof = by_pieces(whole, longer, cells, _smooth)
    else:
        proof = _smooth(whole, longer, cells, turning)[0]
    return proof.of_width(path.u.shape[1])


def _smooth(
    homotopy: Any, path: Path, cells: Cells | None, look: SignsAlong
) -> tuple[Proof, Engine, list[list[Piece]]]:
    """A proof, its engine, and pieces of each observed number, beginning with the parameter's rate."""
    engine = engine_of(homotopy)
    if cells is None:
        tubes, gaps = _searched(engine, homotopy, path, look)
    elif not len(cells):
        tubes, gaps = Tubes(cells, np.zeros(0, bool), []), []
    else:
        tubes = check(engine, cells, look)
        gaps = [Gap(begin, end, "the tube does not hold") for begin, end in cells.place[~tubes.proved].tolist()]
        tubes = tubes.take(np.flatnonzero(tubes.proved))
    numbers = tubes.numbers()
    return verified(engine, tubes.cells, path, homotopy, gaps, numbers[0] if numbers else []), engine, numbers


def _searched(engine: Engine, homotopy: Any, path: Path, look: SignsAlong) -> tuple[Tubes, list[Gap]]:
    """Search for cells and tubes: proved cells in order, and gaps."""
    solver = PathSolver(Evaluator(homotopy, Counts()), Tolerance())
    nodes = _nodes(solver.evaluator, homotopy, path)
    end, own = nodes[-1], getattr(homotopy, "metric", None) is not None
    # Nearer a singular end the path is not proved; farther cells are cut without limit.
    near = NEXT_TO_END * abs(float(nodes[0].u[-1] - end.u[-1])) if made(path.steps[-1]) else np.inf
    pending = [(a, b, CELL_HALVINGS) for a, b in pairwise(nodes)]
    done: list[Tubes] = []
    gaps: list[Gap] = []
    for _ in range(TAIL_NODES):
        if not pending:
            break
        trial = joined([_cell(a, b) for a, b, _ in pending])
        still = np.array([a.weights for a, *_ in pending]) ** -0.5 if own else trial.radius
        found = search(engine, trial.with_tubes(still, trial.slabs), look)
        settled = np.zeros(len(pending), bool)
        tried, pending = pending, []
        for k, (a, b, left) in enumerate(tried):
            clear = all(piece.sign or piece.bend for part in found.pieces[k] for piece in part)
            settled[k] = found.proved[k] and (clear or not left)
            if settled[k]:
                continue
            singular = b is end and near < np.inf and abs(a.u[-1] - end.u[-1]) > 0.0
            if singular and abs(a.u[-1] - end.u[-1]) <= near:
                continue
            why: PathNode | str = "no tube holds it, however short"
            if singular or left:
                why = _between(solver, a, b, END_RATIO if singular else 0.5)
            if isinstance(why, PathNode):
                pending += [(a, why, left - 1 + singular), (why, b, left - 1 + singular)]
            else:
                gaps.append(Gap(a.place, b.place, why))
        done.append(found.take(np.flatnonzero(settled)))
    whole = Tubes.joined(done)
    return whole.take(np.argsort(whole.cells.place[:, 0], kind="stable")), gaps


def _nodes(evaluator: Evaluator, homotopy: Any, path: Path) -> list[PathNode]:
    u, out = path.u, list[PathNode]()
    for k, (step, weights) in enumerate(zip(path.steps, _weights(homotopy, path))):
        tangent = step.tangent
        if not np.isfinite(tangent).all() or made(step):
            border = weights * (u[k] - u[k - 1] if k else u[1] - u[0])
            try:
                tangent = linearize(evaluator, step.u, weights, border).tangent
            except EvaluationError:
                tangent = np.full_like(step.u, np.nan)
        out.append(PathNode(step.u, tangent, weights, step.arclength))
    return out


def _between(solver: PathSolver, a: PathNode, b: PathNode, share: float) -> PathNode | str:
    """A point of the path between two nodes, at the part `share` of their distance from b, or why there is none.

    The midpoint guess uses slopes as long as the chord: those in the chart may be huge. Next to a singular end a
    parabola gives the guess.
    """
    cell, x = _cell(a, b), 1.0 - share
    first, last = (v[0] / (norm(a.weights, v[0]) or 1.0) for v in (cell.slope_begin, cell.slope_end))
    guess = 0.5 * (a.u + b.u) + 0.125 * norm(a.weights, b.u - a.u) * (first - last)
    if share != 0.5:
        guess = a.u + x * cell.slope_begin[0] + x * x * (b.u - a.u - cell.slope_begin[0])
    try:
        near = linearize(solver.evaluator, guess, a.weights, cell.chart[0])
        found: Linearization = solver.project_and_linearize(near, guess, cell.chart[0])
    except EvaluationError as error:
        return f"no point of the path was found between its ends ({error})"
    return PathNode(found.u, found.tangent, a.weights, a.place + x * (b.place - a.place))


def _cell(a: PathNode, b: PathNode) -> Cells:
    return cell_between(a.u, a.tangent, b.u, b.tangent, a.weights, (a.place, b.place))


def _weights(homotopy: Any, path: Path) -> list[Array]:
    rule, out = metric_of(homotopy, path), list[Array]()
    for step, after in zip(path.steps, [*path.steps[1:], path.steps[-1]]):
        usual = rule.weights(step.u, step.tangent, out[-1] if out else None)
        out.append(usual if after.weights is None else after.weights)
    return out


@runtime_checkable
class SupportsWrittenOut(Protocol):
    """A homotopy that eliminates unknowns by factorisations."""

    def written_out(self, points: Array) -> Any:
        """Homotopy with all unknowns, or None.

        Its `lifted(u, before)` puts the further unknowns in front of u, near those of `before`.

        Parameters
        ----------
        points : ndarray, shape (m, N + 1)
            Points of the path.
        """
        ...


def lifted(homotopy: Any, path: Path, cells: Cells | None = None) -> tuple[Any, Path] | Proof:
    """The homotopy and path to prove, perhaps with further unknowns, or an empty proof with a reason.

    Points that are nodes of `cells` take the unknowns from these.
    """
    points = path.u
    width, ends = points.shape[1], (float(path.arclength[0]), float(path.arclength[-1]))
    try:
        whole = homotopy.written_out(points) if isinstance(homotopy, SupportsWrittenOut) else None
        longer = path if whole is None else _lifted(whole, path, cells)
    except ArithmeticError as error:
        return Proof.empty(width, Gap(*ends, f"the equations cannot be written out there ({error})"))
    needed = longer.steps[0].u.size
    if cells is not None and cells.begin.shape[1] != needed:
        return Proof.empty(width, Gap(*ends, f"tubes have {cells.begin.shape[1]} components, not {needed}"))
    return homotopy if whole is None else whole, longer


def _lifted(whole: Any, path: Path, cells: Cells | None) -> Path:
    rows = () if cells is None else (*cells.begin, *cells.end)
    known = {row[-path.steps[0].u.size :].tobytes(): row for row in rows}
    steps: list[Step] = []
    before = None
    for step in path.steps:
        found = known.get(step.u.tobytes())
        before = whole.lifted(step.u, before) if found is None else found
        steps.append(evolve(step, u=before, tangent=np.full_like(before, np.nan), weights=None))
    events = []
    for event in path.events:
        u = whole.lifted(event.u, steps[min(event.step, len(steps) - 1)].u)
        events.append(evolve(event, u=u, tangent=np.full_like(u, np.nan)))
    return evolve(path, steps=steps, events=events)


TRACES = 4
"""Most traces; each halves the steps."""


@one_thread
def provable(homotopy: Any, options: Options) -> tuple[Options, Proof | None]:
    """Options with which the path, or its longest part, is proved, and the proof, if any.

    The recorded trace is the proved one: traces with equal numbers of threads are equal.
    """
    best: tuple[Options, Proof] | None = None
    tried = options
    for _ in range(TRACES):
        tracer = Tracer(homotopy, **tried)
        for _ in tracer:
            pass
        if len(tracer.path) < 2:
            break
        proof = certify(tracer.path, homotopy)
        if best is None or _missing(proof) < _missing(best[1]):
            best = tried, proof
        if proof.complete:
            break
        tried = {**options, "controller": Halved(tracer.path.arclength)}
    return best if best is not None else (options, None)


def _missing(proof: Proof) -> tuple[float, int]:
    return sum(gap.end - gap.begin for gap in proof.gaps), len(proof.gaps)
