"""Snap-through of von Mises' truss, as a homotopy for `continuation`."""

from typing import ClassVar

import numpy as np

__all__ = ["VonMisesTruss"]

VON_MISES = """@article{vonMises1923,
  author = {von Mises, Richard},
  title = {{\\"U}ber die Stabilit{\\"a}tsprobleme der Elastizit{\\"a}tstheorie},
  journal = {Zeitschrift f{\\"u}r Angewandte Mathematik und Mechanik},
  volume = {3},
  year = {1923},
}"""


class VonMisesTruss:
    """Two bars of unit span that meet in a tip, pressed down by the load lam until they snap through.

    With y = (sideways, downwards), the displacement of the tip, the strains of the bars are quadratic in y (Green's)
    and H is the sum of their forces minus the load. Pressed straight down the truss carries up to a first turning
    point, then less, and from a second one on more again, hanging.

    Parameters
    ----------
    rise : float
        Height of the tip over the supports, in half spans.
    target : float
        The load at which the path ends.
    """

    problem_class: ClassVar[str] = "elastic structures"
    references: ClassVar[tuple[str, ...]] = (VON_MISES,)

    def __init__(self, rise: float = 0.3, target: float = 0.05) -> None:
        if not rise > 0.0:
            raise ValueError(f"rise: expected a positive number, found {rise!r}")
        self.rise = rise
        self.target = target

    def start(self) -> tuple[np.ndarray, float]:
        """The truss without load."""
        return np.zeros(2), 0.0

    def residual(self, y: np.ndarray, lam: float) -> np.ndarray:
        """Forces on the tip, sideways and downwards, shape (2,)."""
        fall = 0.5 * (y[0] ** 2 + y[1] ** 2) - self.rise * y[1]
        left, right = fall + y[0], fall - y[0]
        sideways = left * (1.0 + y[0]) - right * (1.0 - y[0])
        upwards = (left + right) * (self.rise - y[1])
        return np.stack((sideways, -upwards - lam))

    def observe(self, y: np.ndarray, lam: float) -> dict[str, float]:
        """How far the tip has come down."""
        return {"sag": float(y[1])}

    def turning_points(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(sag, load) of both turning points, in closed form: the tip is at +rise/sqrt(3) and at -rise/sqrt(3)."""
        load = 2.0 * self.rise**3 / (3.0 * np.sqrt(3.0))
        return (self.rise * (1.0 - 1.0 / np.sqrt(3.0)), load), (self.rise * (1.0 + 1.0 / np.sqrt(3.0)), -load)
