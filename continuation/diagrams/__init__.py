"""Diagrams of connected branches, and by deflation disconnected ones."""

from continuation.diagrams.asking import diagram
from continuation.diagrams.branches import Branch, Diagram, Special
from continuation.diagrams.deflation import Deflated

__all__ = ["Branch", "Deflated", "Diagram", "Special", "diagram"]
