"""Diagrams: all branches that hang together, each once, and by deflation those that hang on nothing."""

from continuation.diagrams.branches import Branch, Diagram, Special
from continuation.diagrams.deflation import Deflated
from continuation.diagrams.tracing import diagram

__all__ = ["Branch", "Deflated", "Diagram", "Special", "diagram"]
