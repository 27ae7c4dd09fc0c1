"""
Scenes: small models of many fields
===================================

Every scene of :code:`problems.scenes`, at its default parameters: what its solution looks like.
"""

import math

import matplotlib.pyplot as plt

from problems import scenes


def draw(*names):
    """Solve the scenes, and draw each in a panel of its own."""
    rows = math.ceil(len(names) / 2)
    _, panels = plt.subplots(rows, 2, figsize=(10, 3.4 * rows), layout="constrained", squeeze=False)
    for name, axes in zip(names, panels.ravel()):
        scene = scenes.make(name)
        scene.draw(scenes.solve(scene), axes)
        axes.set_title(" - ".join(filter(None, (name, axes.get_title()))), fontsize="medium")
    for axes in panels.ravel()[len(names) :]:
        axes.remove()


# %%
# Contact with friction. The arch stands, as a line of thrust fits into it; the rod has two possible forces.

draw("block", "box", "puck", "painleve-rod", "arch", "pile")

# %%
# Obstacles: a string above a floor, a membrane over a ball, a bar that is twisted until it yields, a layer under a lid,
# and the oil film of a bearing.

draw("string", "membrane", "torsion", "bratu-lid", "bearing")

# %%
# Structures: bars that yield one after another up to their collapse, and a shallow truss that snaps onto a stop.

draw("truss", "snap-through")

# %%
# Finance: below which price to exercise an American put, and a portfolio on its frontier.

draw("american-put", "portfolio")

# %%
# Economics: traffic, producers, markets, and the three equilibria of a game.

draw("braess", "traffic", "cournot", "spatial-prices", "game")

# %%
# Data: a penalised regression, a spectrum in parts, a curve that may only rise, a border between clouds, a signal with
# jumps.

draw("lasso", "unmixing", "isotonic", "svm", "denoising")

# %%
# Circuits, control, and a mixture that boils.

draw("diode-bridge", "converter", "regulator", "flash-drum")
