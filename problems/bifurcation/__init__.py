"""Bifurcation problems with known answers."""

from problems.bifurcation.aircraft import Aircraft
from problems.bifurcation.bratu_1d import Bratu1D
from problems.bifurcation.bratu_2d import Bratu2D
from problems.bifurcation.circle import Circle
from problems.bifurcation.cusp import Cusp
from problems.bifurcation.exponential_cosine import ExponentialCosine
from problems.bifurcation.freudenstein_roth import FreudensteinRoth
from problems.bifurcation.pitchfork import Pitchfork

__all__ = [
    "Aircraft", "Bratu1D", "Bratu2D", "Circle", "Cusp", "ExponentialCosine", "FreudensteinRoth", "Pitchfork",
]  # fmt: skip
