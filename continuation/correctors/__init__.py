"""Correctors lead back to the path."""

from continuation.correctors.base import Correction, Corrector
from continuation.correctors.newton import BorderedNewton, MoorePenrose, NaturalParameter

__all__ = ["BorderedNewton", "Correction", "Corrector", "MoorePenrose", "NaturalParameter"]
