"""A game of two players: all its equilibria."""

from __future__ import annotations

from importlib import import_module
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.solutions import Solutions, solutions
from problems.options import real_array
from problems.scenes.scene import Point, Quantities, Rival, Units, Unknown

Payoffs = tuple[tuple[float, ...], ...]


def _payoffs(name: str, value: Any) -> Payoffs:
    matrix = real_array(name, value)
    if matrix.ndim != 2 or not matrix.size or not np.isfinite(matrix).all():
        raise ValueError(f"{name}: expected a matrix of finite numbers, found shape {matrix.shape}")
    return tuple(tuple(row) for row in matrix.tolist())


def _rows(value: Any) -> Payoffs:
    return _payoffs("rows", value)


def _columns(value: Any) -> Payoffs:
    return _payoffs("columns", value)


def bimatrix(C: Array, D: Array) -> LCP:
    """The equilibria of a game with positive losses: C y >= e and D'x >= e, complementary to x and y.

    `C`, `D`, of shape (m, n): What the player who chooses a row loses, and the one who chooses a column.
    """
    m, n = C.shape
    return LCP(np.block([[np.zeros((m, m)), C], [D.T, np.zeros((n, n))]]), -np.ones(m + n))


@frozen
class Game:
    """Two players choose at the same time: which mixed strategies are best against each other?

    Of small games all equilibria are found, by trying all faces exactly; of larger ones those that lie on paths.

    Parameters
    ----------
    rows, columns : matrix
        What the player who chooses a row gains, and the one who chooses a column.

    References
    ----------
    Nash, Annals of Math. 54 (1951); Avis, Rosenberg, Savani and von Stengel, Economic Theory 42 (2010), for the
    default.
    """

    rows: Payoffs = field(default=((3.0, 3.0), (2.0, 5.0), (0.0, 6.0)), converter=_rows)
    columns: Payoffs = field(default=((3.0, 2.0), (2.0, 6.0), (3.0, 1.0)), converter=_columns)
    units: ClassVar[Units] = {"equilibria": "", "gains": ""}

    def __attrs_post_init__(self) -> None:
        rows, columns = np.shape(self.rows), np.shape(self.columns)
        if rows != columns:
            raise ValueError(f"columns: expected a matrix of the shape of rows, {rows}, found {columns}")

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Probabilities over what the other player loses: with positive losses that value needs no unknown."""
        m, n = np.shape(self.rows)
        return (Unknown("strategies of the first", m, "what the first mixes"),
                Unknown("strategies of the second", n, "what the second mixes"))  # fmt: skip

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """All equilibria of a game without degeneracy."""
        return (Rival("support enumeration (quantecon)", "quantecon", _supports),)

    def problem(self) -> LCP:
        """In losses against more than the best."""
        gains, others = np.array(self.rows), np.array(self.columns)
        return bimatrix(gains.max() + 1.0 - gains, others.max() + 1.0 - others)

    def solve(self) -> Solutions:
        """All equilibria, or many."""
        return solutions(self.problem())

    def answer(self, solution: Any) -> Quantities:
        """One equilibrium a row, both mixed strategies side by side, in lexical order; and what both gain."""
        points = np.atleast_2d(solution.points if hasattr(solution, "points") else solution.x)
        m = len(self.rows)
        x, y = points[:, :m], points[:, m:]
        mixed = np.hstack([x / x.sum(axis=1, keepdims=True), y / y.sum(axis=1, keepdims=True)])
        mixed = mixed[np.lexsort(mixed.round(9).T[::-1])]
        gains = [[x @ self.rows @ y, x @ self.columns @ y] for x, y in ((row[:m], row[m:]) for row in mixed)]
        return {"equilibria": mixed, "gains": np.array(gains)}

    def exact(self) -> Quantities:
        """That of Avis and others, who publish theirs."""
        if self != Game():
            return {}
        published: Array = np.array([
            [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0], [0.8, 0.2, 0.0, 2.0 / 3.0, 1.0 / 3.0],
            [1.0, 0.0, 0.0, 1.0, 0.0],
        ])  # fmt: skip
        return {"equilibria": published}

    def draw(self, solution: Any, axes: Any) -> None:
        """Each equilibrium as two rows of bars."""
        found = self.answer(solution)["equilibria"]
        m = len(self.rows)
        for k, row in enumerate(found):
            for first, mixed, colour in ((True, row[:m], "#0072B2"), (False, row[m:], "#D55E00")):
                left = 0.0
                for i, part in enumerate(mixed):
                    axes.barh(
                        3 * k + (not first), part, left=left, color=colour, alpha=1.0 - 0.25 * i, edgecolor="white"
                    )
                    if part > 0.03:
                        axes.text(left + 0.5 * part, 3 * k + (not first), f"{i}: {part:.3g}", ha="center", va="center",
                                  color="white", fontsize="small")  # fmt: skip
                    left += part
        axes.set(yticks=[3 * k + 0.5 for k in range(len(found))], xlabel="probability", xlim=(0.0, 1.0))
        axes.set_yticklabels([f"equilibrium {k}" for k in range(len(found))])
        axes.set_title("strategies of the first player, blue, and of the second", fontsize="medium")
        axes.invert_yaxis()


def _supports(scene: Game) -> Quantities:
    theory = import_module("quantecon.game_theory")
    players = [theory.Player(np.array(scene.rows)), theory.Player(np.array(scene.columns).T)]
    found = theory.support_enumeration(theory.NormalFormGame(players))
    return scene.answer(Point(np.array([np.concatenate(pair) for pair in found])))
