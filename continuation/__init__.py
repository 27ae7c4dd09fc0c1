"""Pseudo-arclength continuation with pluggable parts.

``continuation.trace(homotopy)`` follows the zero curve of H(y, lam) from its start to its target.
"""

from continuation.auditing import audit, refine
from continuation.branch_switching import branch_directions, switch_branch
from continuation.budget import Budget
from continuation.certificate import Proof, certify
from continuation.citation import cite
from continuation.controllers import Controller
from continuation.correctors import Corrector
from continuation.counts import Counts
from continuation.curves import Curve, Family
from continuation.evaluation.evaluator import EvaluationError
from continuation.evaluation.functions import from_functions
from continuation.evaluation.jacobian_check import check_jacobian
from continuation.events import Event, KinkPoint, Monitor, TargetValue, TurningPoint
from continuation.events.branch_point import BranchPoint
from continuation.guard import Guard
from continuation.homotopy import Homotopy
from continuation.interrupted import Interrupted
from continuation.kinks.start import kink_rays
from continuation.length import arclength
from continuation.metric import Automatic, Euclidean, Metric
from continuation.path import LocatedEvent, Path, Step
from continuation.predictors import Predictor
from continuation.presets import CONSERVATIVE, DEFAULT, FAST, SERIES, Preset
from continuation.status import Kind, Status
from continuation.step.options import Options
from continuation.step.settings import Settings
from continuation.step.tracer import Observer, Tracer
from continuation.tolerance import Tolerance
from continuation.tracing import solve_at, trace, trace_both
from continuation.version import __version__

__all__ = [
    "CONSERVATIVE",
    "DEFAULT",
    "FAST",
    "SERIES",
    "Automatic",
    "BranchPoint",
    "Budget",
    "Controller",
    "Corrector",
    "Counts",
    "Curve",
    "Euclidean",
    "EvaluationError",
    "Event",
    "Family",
    "Guard",
    "Homotopy",
    "Interrupted",
    "Kind",
    "KinkPoint",
    "LocatedEvent",
    "Metric",
    "Monitor",
    "Observer",
    "Options",
    "Path",
    "Predictor",
    "Preset",
    "Proof",
    "Settings",
    "Status",
    "Step",
    "TargetValue",
    "Tolerance",
    "Tracer",
    "TurningPoint",
    "__version__",
    "arclength",
    "audit",
    "branch_directions",
    "certify",
    "check_jacobian",
    "cite",
    "from_functions",
    "kink_rays",
    "refine",
    "solve_at",
    "switch_branch",
    "trace",
    "trace_both",
]
