"""Scenes: problems that people have, each with the smallest model that answers it, by name.

The scenes themselves are the entry points of the group `continuation.scenes`, so that a package may add its own.
"""

from problems.scenes.registry import available, find, make
from problems.scenes.scene import Point, Rival, Scene, Unknown, error, memory, order, solve

__all__ = ["Point", "Rival", "Scene", "Unknown", "available", "error", "find", "make", "memory", "order", "solve"]
