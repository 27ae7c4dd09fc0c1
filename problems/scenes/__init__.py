"""Practical problems, each with an entry point in `continuation.scenes`."""

from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.registry import available, find, make
from problems.scenes.scene import (
    Finite,
    NotNegative,
    Numbers,
    Positive,
    Rival,
    Scene,
    Seed,
    Unknown,
    error,
    order,
    solve,
    with_parameters,
)

__all__ = [
    "Finite", "NotNegative", "Numbers", "Picture", "Positive", "Rival", "Scene", "Seed", "Unknown",
    "available", "error", "find", "make", "mark", "order", "picture", "solve", "with_parameters",
]  # fmt: skip
