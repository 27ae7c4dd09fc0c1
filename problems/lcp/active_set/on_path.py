"""When the finish is tried on a path: by its parameter, and by the products that the path makes small."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import define

from continuation.arrays import Array
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.iteration import Policy
from problems.lcp.homotopies.kkt import KKTHomotopy
from problems.lcp.homotopies.starts import natural_units

# How the next four do on 80 planted problems of five kinds (n = 20, 40), all with a path; 79 are solved whatever they
# are. Factorisations: 5,567; LATEST_START = 0.2, 1: 5,407, 5,697; LARGEST_PRODUCT = 0.1, 10, infinity: 5,251, 5,701,
# 6,038; SPACING = 0.2, 0.6, 0.8: 6,099, 5,844, 6,138; ON_PATH of 0, 2, 8 steps: 5,366, 5,418, 6,085.

LATEST_START = 0.5
"""The finish is first tried on a path when its parameter has fallen to this,"""

LARGEST_PRODUCT = 1.0
"""nor before the products x z1 (or x y) have fallen to this, in the problem's natural units,"""

SPACING = 0.4
"""and then each time the parameter has fallen by this factor since."""

ON_PATH = Policy(steps=4, singular=12)
"""At each try on a path. Singular faces, as of contacts, take more: of 25 stacks and 25 arches of bodies, n = 40 to
496, within 3 s each, 21 and 25 are solved without (16.1 and 4.0 s together), 23 and 25 with 12 (7.1 and 3.3 s)."""


@define(eq=False)
class AlongPath:
    """The finish as the `finish=` of a trace: tried at times, more often the nearer the end.

    Attributes
    ----------
    finish : Finish
    homotopy : KKTHomotopy or TwoVectorHomotopy
        Of the path.
    next_lam : float
        It is tried when the parameter has fallen to this.
    """

    finish: Finish
    homotopy: Any
    next_lam: float

    @classmethod
    def of(cls, finish: Finish, homotopy: Any) -> AlongPath:
        """For one path of a homotopy of this package, whose first n unknowns are x."""
        return cls(finish, homotopy, min(LATEST_START, smallest_parameter(homotopy, LARGEST_PRODUCT)))

    def __call__(self, y: Array, lam: float) -> Array | None:
        """The end of the path at the certified solution; None to go on."""
        if lam > self.next_lam:
            return None
        self.next_lam = SPACING * lam
        problem = self.finish.problem
        x = y[: problem.n]
        solved = self.finish.settle(problem.states(x, problem.w(x)), ON_PATH, x)
        end: Array | None = None if solved is None else self.homotopy.at_solution(solved)
        return end


def smallest_parameter(homotopy: Any, product: float) -> float:
    """The parameter at which the products x z1 (or x y) have fallen to a size, in the median.

    `product`: The size, in natural units of x times those of w.
    """
    products = homotopy.c1 if isinstance(homotopy, KKTHomotopy) else homotopy.c
    x, w = natural_units(homotopy.problem)
    return float(homotopy.start()[1] * product * x * w / np.median(products)) if products.size else LATEST_START
