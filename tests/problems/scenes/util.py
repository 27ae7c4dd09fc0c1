"""Small sizes of the scenes, how exact they are there, and the fewest unknowns that they can have."""

from __future__ import annotations

from problems.scenes import make

SMALL = {
    "string": {"n": 20}, "membrane": {"n": 40}, "torsion": {"n": 8, "twist": 1.0}, "bratu-lid": {"n": 20},
    "bearing": {"n": 99, "eccentricity": 0.5}, "arch": {"stones": 20}, "pile": {"boxes": 2, "steps": 30},
    "american-put": {"n": 199, "steps": 50}, "traffic": {"side": 2}, "svm": {"samples": 2},
    "spatial-prices": {"offers": [4.0], "bids": [20.0]}, "denoising": {"samples": 40, "noise": 0.0, "weight": 1.0},
    "isotonic": {"samples": 30}, "converter": {"n": 40}, "unmixing": {"channels": 60},
}  # fmt: skip
"""Parameters other than the defaults."""

EXACT_TO = {
    "block": 1e-15, "painleve-rod": 1e-14, "box": 1e-13, "puck": 0.07, "string": 2e-3, "cournot": 1e-14, "arch": 0.0,
    "pile": 1e-15, "membrane": 2e-4, "torsion": 0.013, "bratu-lid": 5e-4, "bearing": 5e-4, "truss": 1e-14,
    "snap-through": 1e-14, "american-put": 2e-3, "portfolio": 1e-14, "braess": 1e-14,
    "spatial-prices": 1e-14, "game": 1e-14, "lasso": 1e-14, "unmixing": 1e-11, "isotonic": 1e-14, "svm": 1e-13,
    "denoising": 1e-13, "diode-bridge": 1e-13, "converter": 1e-2, "regulator": 1e-13,
}  # fmt: skip
"""Relative, to the closed form: round-off, or the error of the mesh at the small size."""

MINIMAL = {
    "block": (4, "a normal impulse, friction both ways, and a slip velocity to know whether friction is at its limit"),
    "painleve-rod": (1, "friction is a multiple of the contact force"),
    "box": (8, "a rigid box on a flat floor rests on two corners, whatever their number"),
    "arch": (45, "symmetry leaves two forces undetermined; a multiplier for each side of 21 joints tells the hinges"),
    "pile": (16, "two ends of each side that touches, four unknowns each"),
    "puck": (10, "a normal impulse, eight edges of the pyramid, a slip velocity"),
    "string": (20, "one height a point of one half; the floor's force is a residual"),
    "membrane": (40, "one height a point of one radius, as everything is round"),
    "torsion": (36, "eight symmetries of the square leave 8 * 9 / 2 points"),
    "bratu-lid": (20, "solutions are symmetric; the lid's force is a residual"),
    "bearing": (99, "one pressure a point; the gap that is not full is a residual"),
    "truss": (3, "bars under a growing pull yield on one side only"),
    "snap-through": (1, "by symmetry the joint moves up and down only"),
    "american-put": (199, "one value a point; known ones at both ends"),
    "portfolio": (5, "four weights, and the multiplier of the budget; a cap of 1 holds by itself"),
    "braess": (4, "three routes and their time; loads of five roads are sums"),
    "traffic": (7, "four streets, and times from all crossings but the goal"),
    "cournot": (4, "prices and profits follow from quantities, capacities are bounds"),
    "spatial-prices": (1, "one way; prices are linear in what goes it"),
    "game": (5, "three and two pure strategies; values are scaled to 1"),
    "lasso": (12, "a coefficient has a sign of its own"),
    "unmixing": (12, "one amount a substance, none a channel"),
    "isotonic": (29, "one force between neighbours, none for the 30 values"),
    "svm": (3, "a weight a point, and the offset"),
    "denoising": (39, "one force between neighbours, none for the 40 values"),
    "diode-bridge": (4, "one a diode"),
    "converter": (40, "a current a step; voltages are linear in them"),
    "regulator": (12, "a force a step; states are linear in them"),
    "flash-drum": (1, "compositions follow from the part of vapour"),
}
"""The fewest unknowns that the small scenes can have, and why."""

FREE = {
    "arch": (3, "thrust, its moment and the margin have no sign"),
    "membrane": (20, "outside of the ball nothing is below the membrane: eliminating these would fill the matrix"),
    "portfolio": (1, "the budget is an equation"),
    "traffic": (3, "what comes to a crossing leaves it"),
    "svm": (1, "the weights of both sides balance"),
    "lasso": (12, "coefficients have no bounds; their penalty is a level"),
}
"""How many unknowns have no bounds, and the equation that asks for each: any others could be eliminated."""


def small(name):
    """The scene at a size for tests."""
    return make(name, SMALL.get(name))
