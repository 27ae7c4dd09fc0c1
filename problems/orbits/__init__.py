"""Periodic orbits; `problems.orbits.models` has examples."""

from problems.orbits.named import from_model
from problems.orbits.orbit import PeriodicOrbit
from problems.orbits.pictures import plot_orbits

__all__ = ["PeriodicOrbit", "from_model", "plot_orbits"]
