"""Diagrams: all connected branches, each once, and by deflation disconnected ones.

Each ray of a junction is followed once, breadth first; a path that returns to a known point marks its ray as used.
"""

from continuation.diagrams.asking import diagram
from continuation.diagrams.branches import Branch, Diagram, Special
from continuation.diagrams.deflation import Deflated

__all__ = ["Branch", "Deflated", "Diagram", "Special", "diagram"]
