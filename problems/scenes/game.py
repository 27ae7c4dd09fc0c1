"""A game of two players."""

from __future__ import annotations

from importlib import import_module
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import expect
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.solutions import solutions
from problems.options import real_array
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import Quantities, Rival, Scene, Unknown, with_parameters


def payoffs(name: str, value: Any) -> tuple[tuple[float, ...], ...]:
    """Tuples can be compared."""
    matrix = real_array(name, value)
    expect(matrix.ndim == 2 and matrix.size and np.isfinite(matrix).all(), name, "a matrix of finite numbers", value)
    return tuple(tuple(row) for row in matrix.tolist())


Payoffs = Annotated[Any, None, payoffs]


def bimatrix(C: Array, D: Array) -> LCP:
    """Equilibria for positive losses `C`, `D` of shape (m, n): C y >= e and D'x >= e, complementary to x and y."""
    m, n = C.shape
    return LCP(np.block([[np.zeros((m, m)), C], [D.T, np.zeros((n, n))]]), -np.ones(m + n))


@with_parameters
def Game(
    rows: Payoffs = ((3.0, 3.0), (2.0, 5.0), (0.0, 6.0)), columns: Payoffs = ((3.0, 2.0), (2.0, 6.0), (3.0, 1.0))
) -> Scene:
    """Which mixed strategies of two players are best against each other?

    An exact test finds all equilibria of small games, paths some of larger ones.

    Parameters
    ----------
    rows, columns : matrix
        Gains of the two players.

    References
    ----------
    Nash, Annals of Math. 54 (1951); Avis, Rosenberg, Savani and von Stengel, Economic Theory 42 (2010), for the
    default.
    """
    mine, others = np.array(rows), np.array(columns)
    expect(mine.shape == others.shape, "columns", f"the shape of rows, {mine.shape}", others.shape)
    m, n = mine.shape

    def answer(solution: Any) -> Quantities:
        points = np.atleast_2d(solution.points if hasattr(solution, "points") else solution.x)
        mixed = np.hstack([part / part.sum(axis=1, keepdims=True) for part in (points[:, :m], points[:, m:])])
        mixed = mixed[np.lexsort(mixed.round(9).T[::-1])]
        gains = [[row[:m] @ matrix @ row[m:] for matrix in (mine, others)] for row in mixed]
        return {"equilibria": mixed, "gains": np.array(gains)}

    def exact() -> Quantities:
        avis = [[3.0, 3.0], [2.0, 5.0], [0.0, 6.0]], [[3.0, 2.0], [2.0, 6.0], [3.0, 1.0]]
        published = [
            [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0], [0.8, 0.2, 0.0, 2.0 / 3.0, 1.0 / 3.0],
            [1.0, 0.0, 0.0, 1.0, 0.0],
        ]  # fmt: skip
        return {"equilibria": np.array(published)} if (mine.tolist(), others.tolist()) == avis else {}

    def drawn(solution: Any) -> Picture:
        found = answer(solution)["equilibria"]
        names = [f"first's {i}" for i in range(m)] + [f"second's {i}" for i in range(n)]
        return picture(
            mark("imshow", found, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto"),
            *(mark("text", j, i, f"{part:.3g}", ha="center", va="center") for (i, j), part in np.ndenumerate(found)),
            xticks=range(m + n), xticklabels=names, yticks=range(len(found)), ylabel="equilibrium",
            title="probabilities of strategies",
        )  # fmt: skip

    def supports(scene: Any) -> Quantities:
        """Complete for nondegenerate games."""
        theory = import_module("quantecon.game_theory")
        players = [theory.Player(mine), theory.Player(others.T)]
        found = theory.support_enumeration(theory.NormalFormGame(players))
        return answer(SimpleNamespace(x=np.array([np.concatenate(pair) for pair in found])))

    return Scene(
        units={"equilibria": "", "gains": ""},
        # Positive losses need no unknown for the game's value.
        unknowns=(Unknown("strategies of the first", m, "what the first mixes"),
                  Unknown("strategies of the second", n, "what the second mixes")),
        problem=lambda: bimatrix(mine.max() + 1.0 - mine, others.max() + 1.0 - others),
        solve=lambda: solutions(bimatrix(mine.max() + 1.0 - mine, others.max() + 1.0 - others)),
        answer=answer, exact=exact, picture=drawn,
        rivals=(Rival("support enumeration (quantecon)", "quantecon", supports),),
    )  # fmt: skip
