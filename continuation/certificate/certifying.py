"""`certify`: from a traced path to a proof that it is one path."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.auditing.length import metric_of
from continuation.certificate.arcs import by_pieces
from continuation.certificate.cells import Cells, between, joined
from continuation.certificate.closing import made
from continuation.certificate.engine import Engine
from continuation.certificate.folds import Piece, pieces
from continuation.certificate.krawczyk import engine_of
from continuation.certificate.lifting import lifted
from continuation.certificate.proof import Gap, Proof
from continuation.certificate.tails import NEXT_TO_END, Node, tail
from continuation.certificate.tubes import search
from continuation.certificate.verify import verified
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.homotopy import SupportsPieces
from continuation.linear.threads import one_thread
from continuation.metric import norm
from continuation.numbers.ends import Mask
from continuation.path import Path
from continuation.path.path import require_path
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.tolerance import Tolerance

CELL_HALVINGS = 8
"""How often a cell is halved: its error, of fourth order, is then below round-off."""


LARGE_NUMBERS = 4_000_000
"""Numbers of an array of 32 MB, the largest that has this effect."""


@one_thread
def certify(path: Path, homotopy: Any) -> Proof:
    """Prove that a traced path is one path: what is proved, and gaps where it is not.

    Between two points runs the Hermite cubic through points and tangents; around it a tube is sought in which
    Krawczyk's test holds for every parameter, so that it has exactly one curve, without branch points, folds allowed.
    Cells that fail are halved at a new point that the corrector finds. Neighbouring tubes are linked at their nodes,
    turning points are counted and compared with those of the path, and the end is joined to the target.

    Parameters
    ----------
    path : Path
        Traced or read from an archive; tangents that it does not have are computed.
    homotopy : Homotopy
        The one that was traced. Its residual is to run on interval arrays as it runs on jets, unless it has bounds of
        its own (`SupportsProofEngine`): LCP homotopies are proved at a fraction of the cost of their traces.

    Returns
    -------
    Proof

    Raises
    ------
    TypeError
        If the residual does not run on interval arrays; the message names the operation.
    ValueError
        If the path has fewer than two points, or not those of this homotopy.

    References
    ----------
    Krawczyk, Computing 4 (1969) 187-201; for curves, Breden, Lessard and Vanicat, Acta Appl. Math. 128 (2013) 113-152.
    """
    require_path(path)
    Evaluator(homotopy, Counts())  # which says what no homotopy lacks
    width = path.u.shape[1]
    if width != len(np.atleast_1d(homotopy.start()[0])) + 1:
        raise ValueError(f"path: expected points of {homotopy}, found {width - 1} unknowns")
    whole = lifted(homotopy, path)
    if isinstance(whole, Proof):
        return whole
    return _proved(*whole, None).of_width(width)


def _proved(homotopy: Any, path: Path, cells: Cells | None) -> Proof:
    """A proof, with new cells or with these."""
    if isinstance(homotopy, SupportsPieces):
        return by_pieces(homotopy, path, cells, _smooth)
    return _smooth(homotopy, path, cells)[0]


def _smooth(homotopy: Any, path: Path, cells: Cells | None) -> tuple[Proof, Engine]:
    # glibc keeps what is freed for the next array once it has seen a large one freed; asking the system for pages again
    # each time took a third of a proof. Nothing is written to this one.
    np.empty(LARGE_NUMBERS)
    engine = engine_of(homotopy, path.u)
    if cells is not None:
        return verified(engine, cells, path, homotopy, []), engine
    cells, gaps, found = TubeSearch(engine, homotopy, path).run()
    return verified(engine, cells, path, homotopy, gaps, found), engine


def recheck(cells: Cells, path: Path, homotopy: Any) -> Proof:
    """Check a proof again, every condition, with the charts and radii that it has.

    Parameters
    ----------
    cells : Cells
        Of a proof, perhaps from a file.
    path : Path
        What they are to prove.
    homotopy : Homotopy

    Returns
    -------
    Proof
    """
    whole = lifted(homotopy, path, cells)
    if isinstance(whole, Proof):
        return whole
    return _proved(*whole, cells).of_width(path.u.shape[1])


@frozen(eq=False, slots=False)
class TubeSearch:
    """The search for cells and tubes.

    Attributes
    ----------
    engine : Engine
    homotopy : Homotopy
    path : Path
    """

    engine: Engine
    homotopy: Any
    path: Path

    def run(self) -> tuple[Cells, list[Gap], list[Piece]]:
        """Proved cells in order, the gaps between them, and the pieces of the cells."""
        solver = PathSolver(Evaluator(self.homotopy, Counts()), Tolerance())
        nodes = self._nodes(solver.evaluator)
        pending = list(pairwise(self._to_end(solver, nodes)))
        done: list[Cells] = []
        told: list[list[Piece]] = []
        gaps: list[Gap] = []
        own = getattr(self.homotopy, "metric", None) is not None
        for depth in range(CELL_HALVINGS + 1):
            if not pending:
                break
            trial = joined([_cell(a, b) for a, b in pending])
            still = np.array([a.weights for a, _ in pending]) ** -0.5 if own else trial.radius
            trial = trial.with_tubes(still, trial.slabs)
            found = search(self.engine, trial)
            proved = found.cells.take(found.proved)
            known = [some for some, good in zip(found.pieces, found.proved) if good and some]
            counted, by_cell = self._counted(proved, known, depth == CELL_HALVINGS)
            settled = found.proved.copy()
            settled[settled] = counted
            done.append(proved.take(counted))
            told += by_cell
            failed = [(pair, bool(found.undefined[k])) for k, pair in enumerate(pending) if not settled[k]]
            pending = []
            for (a, b), undefined in failed:
                middle = self._middle(solver, a, b) if depth < CELL_HALVINGS else "no tube holds it, however short"
                if isinstance(middle, Node):
                    pending += [(a, middle), (middle, b)]
                else:
                    why = "the residual has no value, or is not decided, on a box around it" if undefined else middle
                    gaps.append(Gap(a.place, b.place, why))
        cells = joined(done)
        order = np.argsort(cells.place[:, 0], kind="stable")
        numbered = [evolve(piece, cell=k) for k, old in enumerate(order.tolist()) for piece in told[old]]
        return cells.take(order), gaps, numbered

    def _counted(self, cells: Cells, known: list[list[Piece]], last: bool) -> tuple[Mask, list[list[Piece]]]:
        """Whether tubes are thin enough to tell the turning points (or need not be), and the pieces of those."""
        if not len(cells):
            return np.zeros(0, bool), []
        by_cell: list[list[Piece]] = known
        if not known:
            by_cell = [[] for _ in range(len(cells))]
            for piece in pieces(self.engine, cells):
                by_cell[piece.cell].append(piece)
        good = np.array([last or all(piece.sign or piece.bend for piece in part) for part in by_cell])
        return good, [part for part, kept in zip(by_cell, good) if kept]

    def _nodes(self, evaluator: Evaluator) -> list[Node]:
        """The stored points; tangents that are not stored, or are those of a chord, computed."""
        u, out = self.path.u, list[Node]()
        for k, (step, weights) in enumerate(zip(self.path.steps, _weights(self.homotopy, self.path))):
            tangent = step.tangent
            if not np.isfinite(tangent).all() or made(step):
                border = weights * (u[k] - u[k - 1] if k else u[1] - u[0])
                try:
                    tangent = linearize(evaluator, step.u, weights, border).tangent
                except EvaluationError:
                    tangent = np.full_like(step.u, np.nan)
            out.append(Node(step.u, tangent, weights, step.arclength))
        return out

    def _to_end(self, solver: PathSolver, nodes: list[Node]) -> list[Node]:
        """The nodes, with others in place of an end that was found otherwise than by a step, unless a tube holds it."""
        before, end = nodes[-2:]
        if not made(self.path.steps[-1]):
            return nodes
        if search(self.engine, _cell(before, end)).proved.all():
            return nodes
        lam, goal = float(before.u[-1]), float(end.u[-1])
        near = goal + NEXT_TO_END * (float(nodes[0].u[-1]) - goal)
        if lam == goal or (lam - near) * (near - goal) <= 0.0:
            return nodes
        found = tail(solver, before, end, near)
        for k, a in enumerate(found):
            if search(self.engine, _cell(a, end)).proved.all():
                found = [*found[: k + 1], end]
                break
        return [*nodes[:-1], *found] if found else nodes

    def _middle(self, solver: PathSolver, a: Node, b: Node) -> Node | str:
        """A point of the path between two nodes, or why there is none."""
        cell = _cell(a, b)
        # The cubic's middle, but for slopes as long as the chord: where a tangent is nearly across the chord its slope
        # in the chart is out of all proportion, and the corrector may not come back from there.
        first, last = (x[0] / (norm(a.weights, x[0]) or 1.0) for x in (cell.slope_begin, cell.slope_end))
        guess = 0.5 * (a.u + b.u) + 0.125 * norm(a.weights, b.u - a.u) * (first - last)
        try:
            near = linearize(solver.evaluator, guess, a.weights, cell.chart[0])
            found: Linearization = solver.project_and_linearize(near, guess, cell.chart[0])
        except EvaluationError as error:
            return f"no point of the path was found between its ends ({error})"
        return Node(found.u, found.tangent, a.weights, 0.5 * (a.place + b.place))


def _cell(a: Node, b: Node) -> Cells:
    return between(a.u, a.tangent, b.u, b.tangent, a.weights, (a.place, b.place))


def _weights(homotopy: Any, path: Path) -> list[Array]:
    """The metric at each point: that in which the path went on from there, where it is known."""
    rule, out = metric_of(homotopy, path), list[Array]()
    for step, after in zip(path.steps, [*path.steps[1:], path.steps[-1]]):
        usual = rule.weights(step.u, step.tangent, out[-1] if out else None)
        out.append(usual if after.weights is None else after.weights)
    return out
