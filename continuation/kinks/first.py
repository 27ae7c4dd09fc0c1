"""The first zero of any switch on an arc."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, generic_vector
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.noise import NOISE_LOOKS
from continuation.evaluation.pieces import Pieces, Signs, SwitchError
from continuation.events.locate import MONITOR_PLACES, Function, zeros
from continuation.point.arc import Arc, cubic_between, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver

DIP = 0.25
"""Part of a switch's values on both sides below which two zeros are possible."""

TIED = NOISE_LOOKS * NOISE_LOOKS
"""A switch within this multiple of its round-off sample is zero: samples differ by this factor."""


def switch_noise(solver: PathSolver, pieces: Pieces, point: Linearization) -> Array:
    """Round-off of the switches at a path point, shape (m,)."""
    evaluator, generic = solver.evaluator, generic_vector(point.u.size)
    terms = evaluator.round_off(point.u, evaluator.residual(point.u))
    signs = np.sign(generic)
    noise = np.maximum(*(np.abs(point.solve(terms * some[:-1])) for some in (signs, signs[::-1])))
    noise += solver.noise_by_component(point)
    here = pieces.values(point.u)
    looks = [np.abs(pieces.values(point.u + noise * move) - here) for move in (signs, signs[::-1])]
    return NOISE_LOOKS * np.maximum(*looks) + np.spacing(np.abs(here))


def first_zero(
    solver: PathSolver, pieces: Pieces, signs: Signs, arc: Arc
) -> tuple[Linearization, tuple[int, ...]] | None:
    """The first point of an arc where a switch vanishes, with all switches that vanish there, or None.

    A switch that vanishes at the beginning counts once it has left zero. `signs`: of the arc's piece. `EvaluationError`
    if the path cannot be evaluated.
    """
    s = np.array(signs)
    try:
        places = np.linspace(0.0, 1.0, MONITOR_PLACES)
        inner = [pieces.values(arc.segment.at(float(t))) for t in places[1:-1]]
        grid = s * np.array([pieces.values(arc.a.u), *inner, pieces.values(arc.b.u)])
        if not (_suspects(grid) | (np.abs(grid[-1]) <= SIX_DIGITS * np.abs(grid).max(axis=0))).any():
            return None
        fine = switch_noise(solver, pieces, arc.a)
        noise = TIED * fine
        fresh = grid[0] > fine
        grid = np.where(np.abs(grid) <= noise, 0.0, grid)
        grid[0, fresh] = np.maximum(grid[0, fresh], fine[fresh])
        found = _first(solver, pieces, s, noise, arc, grid)
    except SwitchError as error:
        raise EvaluationError(str(error)) from error
    if found is None:
        return None
    point, j = found
    zero = np.abs(pieces.values(point.u)) <= TIED * switch_noise(solver, pieces, point)
    zero[j] = True
    return point, tuple(np.flatnonzero(zero).tolist())


def same_piece(pieces: Pieces, signs: Signs, point: Linearization, u: Array) -> bool:
    """Whether u lies on the piece of a path point, to half of the digits."""
    try:
        here, there = pieces.values(point.u), np.array(signs) * pieces.values(u)
    except SwitchError:
        return False
    return bool((there >= -ROOT_OF_ROUND_OFF * np.abs(here)).all())


def _suspects(grid: Array) -> NDArray[np.bool_]:
    """Switches with a wrong sign after the beginning, or a dip."""
    wrong = (grid[1:] < 0.0).any(axis=0) | (grid[-1] <= 0.0)
    left, middle, right = grid[:-2], grid[1:-1], grid[2:]
    bend = left - 2.0 * middle + right
    lowest = middle - np.where(bend > 0.0, (right - left) ** 2 / np.where(bend > 0.0, 8.0 * bend, 1.0), 0.0)
    before = np.maximum.accumulate(grid, axis=0)[:-2]
    after = np.maximum.accumulate(grid[::-1], axis=0)[::-1][2:]
    dips = (bend > 0.0) & (middle <= left) & (middle <= right) & (lowest < DIP * np.minimum(before, after))
    return np.asarray(wrong | dips.any(axis=0))


def _first(
    solver: PathSolver, pieces: Pieces, signs: Array, noise: Array, arc: Arc, grid: Array
) -> tuple[Linearization, int] | None:
    found: tuple[Linearization, int] | None = None
    wrong = grid < 0.0
    order = np.where(wrong.any(axis=0), wrong.argmax(axis=0), grid.argmin(axis=0))
    suspects = np.flatnonzero(_suspects(grid) & (grid != 0.0).any(axis=0)).tolist()
    for j in sorted(suspects, key=lambda j: int(order[j])):

        def switch(u: Array, v: Array, j: int = j) -> float:
            return float(signs[j] * pieces.values(u)[j])

        point = _zero(solver, switch, float(noise[j]), arc, found[0] if found else arc.b, grid[:, j])
        found = found if point is None else (point, j)
    return found


def _zero(
    solver: PathSolver, switch: Function, noise: float, arc: Arc, end: Linearization, values: Array
) -> Linearization | None:
    def seen(point: Linearization) -> float:
        g = switch(point.u, point.tangent)
        return g if abs(g) > noise else 0.0

    begin, ga = arc.a, float(values[0])
    if ga <= 0.0:
        # The switch vanishes at the beginning: search behind it.
        first = int(np.flatnonzero(values[1:])[0]) + 1
        if first == 1 and values[1] < 0.0:
            raise EvaluationError("a switch that vanishes at the beginning of the arc takes the wrong sign behind it")
        t = (first if values[first] > 0.0 else first - 1) / (len(values) - 1)
        begin = solver.project_and_linearize(arc.a if t < 0.5 else arc.b, arc.segment.at(t), arc.border)
        if values[first] < 0.0:
            return begin
        ga = seen(begin)
    if ga <= 0.0 or position(arc, begin.u) >= position(arc, end.u):
        return None
    if begin is not arc.a or end is not arc.b:
        arc = cubic_between(begin, end, arc.border)
    return next(zeros(solver, switch, arc, ga, seen(end), noise), None)
