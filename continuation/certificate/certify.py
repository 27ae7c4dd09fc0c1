"""`certify`: from a traced path to a proof that it is one path."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.certificate.cells import Cells, between, joined
from continuation.certificate.folds import pieces
from continuation.certificate.proof import Gap, Proof
from continuation.certificate.quadratic import ByProducts, SupportsQuadratic
from continuation.certificate.test import ByIntervals, Engine
from continuation.certificate.tubes import search
from continuation.certificate.verify import verified
from continuation.counts import Counts
from continuation.evaluation.evaluator import EvaluationError, Evaluator
from continuation.metric import Automatic, Metric
from continuation.path import Path, Step
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.tolerance import Tolerance

DEPTH = 8
"""How often a cell is halved: its error, of fourth order, is then below round-off."""


def engines(homotopy: Any) -> tuple[Engine, ByIntervals]:
    """What bounds derivatives for this homotopy: by products where it is quadratic; and by intervals, which all can.

    Parameters
    ----------
    homotopy : Homotopy

    Raises
    ------
    TypeError
        If the residual does not run on interval arrays; the message names the operation.
    """
    plain = ByIntervals(homotopy.residual)
    y, lam = homotopy.start()
    plain.probe(np.append(np.asarray(y, dtype=float), float(lam)))
    if isinstance(homotopy, SupportsQuadratic):
        return ByProducts(homotopy.quadratic()), plain
    return plain, plain


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
        The one that was traced. Its residual is to run on interval arrays as it runs on jets; a homotopy that is
        quadratic and says so (`quadratic`) is proved at a fraction of the cost of its trace.

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
    if len(path) < 2:
        raise ValueError(f"path: expected at least two points, found {len(path)}")
    engine, plain = engines(homotopy)
    if path.u.shape[1] != len(np.atleast_1d(homotopy.start()[0])) + 1:
        raise ValueError(f"path: expected points of {homotopy}, found {path.u.shape[1] - 1} unknowns")
    cells, gaps = Search(engine, plain, homotopy, path).run()
    return verified(engine, plain, cells, path, homotopy, gaps, proved=True)


@frozen(eq=False)
class Node:
    """A point of the path with its tangent and the metric there."""

    u: Array
    tangent: Array
    weights: Array
    place: float


@frozen(eq=False, slots=False)
class Search:
    """The search for cells and tubes.

    Attributes
    ----------
    engine : Engine
    homotopy : Homotopy
    path : Path
    """

    engine: Engine
    plain: ByIntervals
    homotopy: Any
    path: Path

    def run(self) -> tuple[Cells, list[Gap]]:
        """Proved cells in order, and the gaps between them."""
        solver = PathSolver(Evaluator(self.homotopy, Counts()), Tolerance())
        pending = list(pairwise(self._nodes(solver.evaluator)))
        done: list[Cells] = []
        gaps: list[Gap] = []
        for depth in range(DEPTH + 1):
            if not pending:
                break
            found = search(self.engine, joined([_cell(a, b) for a, b in pending]))
            settled = found.proved.copy()
            if depth < DEPTH:
                settled[settled] = self._counted(found.cells.take(found.proved))
            done.append(found.cells.take(settled))
            failed = [(pair, bool(found.undefined[k])) for k, pair in enumerate(pending) if not settled[k]]
            pending = []
            for (a, b), undefined in failed:
                middle = self._middle(solver, a, b) if depth < DEPTH else "no tube holds it, however short"
                if isinstance(middle, Node):
                    pending += [(a, middle), (middle, b)]
                else:
                    why = "the residual has no value, or is not decided, on a box around it" if undefined else middle
                    gaps.append(Gap(a.place, b.place, why))
        cells = joined(done)
        return cells.take(np.argsort(cells.place[:, 0], kind="stable")), gaps

    def _counted(self, cells: Cells) -> Array:
        """Whether the tubes are thin enough to tell the turning points, cell by cell."""
        good = np.ones(len(cells), bool)
        if len(cells):
            found = pieces(self.engine, self.plain, cells)
            good[[piece.cell for piece in found if not piece.sign and not piece.bend]] = False
        return good

    def _nodes(self, evaluator: Evaluator) -> list[Node]:
        """The stored points; tangents that are not stored, or are those of a chord, computed."""
        weights = _weights(self.homotopy, self.path)
        out = []
        for k, step in enumerate(self.path.steps):
            tangent = step.tangent
            if not np.isfinite(tangent).all() or _made(step):
                tangent = self._tangent(evaluator, step.u, weights[k], out[-1].u if out else None)
            out.append(Node(step.u, tangent, weights[k], step.arclength))
        return out

    def _tangent(self, evaluator: Evaluator, u: Array, weights: Array, before: Array | None) -> Array:
        border = weights * (u - before) if before is not None else weights * (self.path.steps[1].u - u)
        try:
            return linearize(evaluator, u, weights, border).tangent
        except EvaluationError:
            return np.full_like(u, np.nan)

    def _middle(self, solver: PathSolver, a: Node, b: Node) -> Node | str:
        """A point of the path between two nodes, or why there is none."""
        cell = _cell(a, b)
        guess = 0.5 * (a.u + b.u) + 0.125 * (cell.slope_begin[0] - cell.slope_end[0])
        chart = cell.chart[0]
        try:
            near = linearize(solver.evaluator, guess, a.weights, chart)
            found: Linearization = solver.project_and_linearize(near, guess, chart)
        except EvaluationError as error:
            return f"no point of the path was found between its ends ({error})"
        return Node(found.u, found.tangent, a.weights, 0.5 * (a.place + b.place))


def _made(step: Step) -> bool:
    """Whether a point was not stepped to, but is an end that was found otherwise: its tangent is a chord."""
    return step.index > 0 and step.segment is None and step.corrector_iterations == 0


def _cell(a: Node, b: Node) -> Cells:
    return between(a.u, a.tangent, b.u, b.tangent, a.weights, (a.place, b.place))


def _weights(homotopy: Any, path: Path) -> list[Array]:
    """The metric at each point: the homotopy's own, or one by how far the path has gone up to the next point."""
    points, tangents = path.u, path.tangents
    own: Metric | None = getattr(homotopy, "metric", None)
    if own is None:
        extent = np.maximum.accumulate(np.abs(points - points[0]), axis=0)
        extent = np.vstack([extent[1:], extent[-1:]])
        extent = np.where(extent > 0.0, extent, extent.max(axis=1, keepdims=True))
        return [Automatic().of_extent(np.where(row > 0.0, row, 1.0)) for row in extent]
    out: list[Array] = []
    for u, tangent in zip(points, tangents):
        out.append(own.weights(u, tangent, out[-1] if out else None))
    return out


Certify = Callable[[Path, Any], Proof]
