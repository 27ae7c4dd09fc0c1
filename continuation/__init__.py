"""Pseudo-arclength continuation with pluggable parts.

``continuation.trace(homotopy)`` follows the zero curve of H(y, lam) from its start to its target.
"""

from continuation.audit import arclength, audit, refine
from continuation.branch import BranchPoint, branch_directions, switch_branch
from continuation.budget import Budget
from continuation.checks import check_jacobian
from continuation.citation import cite
from continuation.evaluation import Counts
from continuation.events import Monitor, TargetValue, TurningPoint
from continuation.homotopy import Homotopy, from_functions
from continuation.path import Kind, LocatedEvent, Path, Step
from continuation.presets import CONSERVATIVE, DEFAULT, FAST, SERIES, Preset
from continuation.status import Status
from continuation.tolerance import Tolerance
from continuation.trace import trace
from continuation.tracer import Observer, Tracer

__version__ = "0.1.0"

__all__ = [
    "CONSERVATIVE",
    "DEFAULT",
    "FAST",
    "SERIES",
    "BranchPoint",
    "Budget",
    "Counts",
    "Homotopy",
    "Kind",
    "LocatedEvent",
    "Monitor",
    "Observer",
    "Path",
    "Preset",
    "Status",
    "Step",
    "TargetValue",
    "Tolerance",
    "Tracer",
    "TurningPoint",
    "arclength",
    "audit",
    "branch_directions",
    "check_jacobian",
    "cite",
    "from_functions",
    "refine",
    "switch_branch",
    "trace",
]
