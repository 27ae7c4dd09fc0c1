"""Periodic orbits: a homotopy, and models with known ones."""

from problems.orbits.models import brusselator, from_model, lorenz, normal_form, roessler, van_der_pol
from problems.orbits.orbit import PeriodicOrbit

__all__ = ["PeriodicOrbit", "brusselator", "from_model", "lorenz", "normal_form", "roessler", "van_der_pol"]
