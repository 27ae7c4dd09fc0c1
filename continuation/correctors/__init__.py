"""Correctors: from a predicted point back to the path."""

from continuation.correctors.base import Correction, Corrector
from continuation.correctors.broyden import Broyden
from continuation.correctors.newton import BorderedNewton, Chord, MoorePenrose, NaturalParameter

__all__ = ["BorderedNewton", "Broyden", "Chord", "Correction", "Corrector", "MoorePenrose", "NaturalParameter"]
