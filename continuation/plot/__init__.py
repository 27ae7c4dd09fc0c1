"""Pictures of paths; matplotlib is imported on drawing. Okabe and Ito's colours suit colour-blind readers."""

from continuation.plot.along import plot_components, plot_profiles, plot_steps
from continuation.plot.bifurcation import plot_bifurcation
from continuation.plot.drawing import KINK, MOST_COMPONENTS, TURN, require_matplotlib

__all__ = [
    "KINK",
    "MOST_COMPONENTS",
    "TURN",
    "plot_bifurcation",
    "plot_components",
    "plot_profiles",
    "plot_steps",
    "require_matplotlib",
]
