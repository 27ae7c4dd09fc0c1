"""Periodic orbits: a homotopy, and ways to begin."""

from problems.orbits.orbit import PeriodicOrbit

__all__ = ["PeriodicOrbit"]
