"""Pictures of a path with matplotlib, which is imported only when one is drawn.

A picture is a line, its events, and names for the axes: what the line is against (`across`), which number of each point
is drawn, and which parts are solid. Colours are Okabe and Ito's, which colour-blind readers tell apart; line styles
repeat the distinction.
"""

from continuation.plot.along import plot_components, plot_heat, plot_profiles, plot_steps
from continuation.plot.bifurcation import plot_bifurcation
from continuation.plot.drawing import KINK, MOST_COMPONENTS, TURN, require_matplotlib

__all__ = [
    "KINK",
    "MOST_COMPONENTS",
    "TURN",
    "plot_bifurcation",
    "plot_components",
    "plot_heat",
    "plot_profiles",
    "plot_steps",
    "require_matplotlib",
]
