"""Diagrams: all branches that hang together, each once, and by deflation those that hang on nothing.

A branch is one smooth curve; at a point where branches meet each ray is followed once, breadth first, and a path that
comes back to a known point marks the ray by which it came. Nothing is left open where no ray is.
"""

from continuation.diagrams.asking import diagram
from continuation.diagrams.branches import Branch, Diagram, Special
from continuation.diagrams.deflation import Deflated

__all__ = ["Branch", "Deflated", "Diagram", "Special", "diagram"]
