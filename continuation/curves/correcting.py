"""A guess brought onto a curve before anything is known of its extent."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array

INCREMENTS = 20
"""At most so many; they end where they no longer shrink."""

NOTHING = 1e-14
"""What is smaller, beside how far it goes, is what round-off left of zero: as a size it would mislead."""

SINGULAR_INCREMENT = 10.0
"""A first increment longer than this, beside the size of the point, is that of a singular system."""


def corrected(homotopy: Any, y: Array, lam: float, size: Array) -> Array:
    """The unknowns with the smallest of Newton's increments, at the parameter of the guess.

    `homotopy`: With `bordered`. `y` of shape (N,). `size`, of shape (N,): What increments are measured by.
    """
    best, least = y, SINGULAR_INCREMENT
    for _ in range(INCREMENTS):
        try:
            with np.errstate(all="ignore"):
                system = homotopy.bordered(y, lam, np.append(np.zeros(y.size), 1.0))
                z = system.solve(homotopy.residual(y, lam), 0.0)[:-1]
        except ArithmeticError:
            break
        longest = float(np.abs(z / size).max())
        if not longest < least:
            break
        y, best, least = y - z, y, longest
    return np.where(np.abs(best) > NOTHING * size, best, 0.0)
