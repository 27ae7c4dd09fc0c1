"""Diagrams: all branches that hang together, each once, and by deflation those that hang on nothing."""

from continuation.diagrams.asking import diagram
from continuation.diagrams.branches import Branch, Diagram, Special
from continuation.diagrams.deflation import Deflated

__all__ = ["Branch", "Deflated", "Diagram", "Special", "diagram"]
