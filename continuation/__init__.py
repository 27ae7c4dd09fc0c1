"""Pseudo-arclength continuation with pluggable parts.

``continuation.trace(homotopy)`` follows the zero curve of H(y, lam). Names are imported at first use.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from continuation.version import __version__

if TYPE_CHECKING:
    from continuation.adapters import from_casadi, from_jax, from_sympy
    from continuation.auditing import arclength, audit, refine
    from continuation.branch_switching import branch_directions, switch_branch
    from continuation.budget import Budget
    from continuation.certificate import Proof, certify
    from continuation.citation import cite
    from continuation.controllers import Controller
    from continuation.correctors import Corrector
    from continuation.counts import Counts
    from continuation.curves import Curve, Family
    from continuation.diagrams import Deflated, Diagram, diagram
    from continuation.evaluation.errors import EvaluationError
    from continuation.evaluation.functions import from_functions
    from continuation.evaluation.jacobian_check import check_jacobian
    from continuation.events import Event, KinkPoint, Monitor, TargetValue, TurningPoint
    from continuation.events.branch_point import BranchPoint
    from continuation.homotopy import Homotopy
    from continuation.kinks.start import kink_rays
    from continuation.metric import Automatic, Euclidean, Metric
    from continuation.path import LocatedEvent, Path, Step
    from continuation.path.interrupted import Interrupted
    from continuation.predictors import Predictor
    from continuation.stability import HopfPoint, Stability
    from continuation.status import Kind, Status
    from continuation.step.guard import Guard
    from continuation.step.presets import CONSERVATIVE, DEFAULT, FAST, SERIES, Preset
    from continuation.step.tracer import Observer, Tracer
    from continuation.tolerance import Tolerance
    from continuation.tracing import Followed, follow, solve_at, trace, trace_both

_HOMES = {
    "adapters": "from_casadi from_jax from_sympy",
    "auditing": "arclength audit refine",
    "branch_switching": "branch_directions switch_branch",
    "budget": "Budget",
    "certificate": "Proof certify",
    "citation": "cite",
    "controllers": "Controller",
    "correctors": "Corrector",
    "counts": "Counts",
    "curves": "Curve Family",
    "diagrams": "Deflated Diagram diagram",
    "evaluation.errors": "EvaluationError",
    "evaluation.functions": "from_functions",
    "evaluation.jacobian_check": "check_jacobian",
    "events": "Event KinkPoint Monitor TargetValue TurningPoint",
    "events.branch_point": "BranchPoint",
    "step.guard": "Guard",
    "homotopy": "Homotopy",
    "path.interrupted": "Interrupted",
    "kinks.start": "kink_rays",
    "metric": "Automatic Euclidean Metric",
    "path": "LocatedEvent Path Step",
    "predictors": "Predictor",
    "step.presets": "CONSERVATIVE DEFAULT FAST SERIES Preset",
    "stability": "HopfPoint Stability",
    "status": "Kind Status",
    "step.tracer": "Observer Tracer",
    "tolerance": "Tolerance",
    "tracing": "Followed follow solve_at trace trace_both",
}

_HOME = {name: module for module, names in _HOMES.items() for name in names.split()}

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
    "Deflated",
    "Diagram",
    "Euclidean",
    "EvaluationError",
    "Event",
    "Family",
    "Followed",
    "Guard",
    "Homotopy",
    "HopfPoint",
    "Interrupted",
    "Kind",
    "KinkPoint",
    "LocatedEvent",
    "Metric",
    "Monitor",
    "Observer",
    "Path",
    "Predictor",
    "Preset",
    "Proof",
    "Stability",
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
    "diagram",
    "follow",
    "from_casadi",
    "from_functions",
    "from_jax",
    "from_sympy",
    "kink_rays",
    "refine",
    "solve_at",
    "switch_branch",
    "trace",
    "trace_both",
]


def __getattr__(name: str) -> Any:
    """Import a public name or a module of the package."""
    if name in _HOME:
        found = getattr(import_module(f"continuation.{_HOME[name]}"), name)
        globals()[name] = found
        return found
    if name.startswith("_") or find_spec(f"continuation.{name}") is None:
        raise AttributeError(f"module 'continuation' has no attribute {name!r}")
    return import_module(f"continuation.{name}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
