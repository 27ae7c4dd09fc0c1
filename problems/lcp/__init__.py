"""The LCP(q, A) and all that solves it."""

from problems.hypothesis_hook import register
from problems.lcp.classes import classify
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.data.program import Program, from_lp, from_qp
from problems.lcp.homotopies import (
    KKTHomotopy,
    KojimaMegiddoMizunoHomotopy,
    Structure,
    TwoVectorHomotopy,
    WangHomotopy,
    XuHomotopy,
    YuHomotopy,
    ZhaoHomotopy,
    default_start,
    random_start,
)
from problems.lcp.parametric.along import along
from problems.lcp.parametric.exact import ExactPath, UnprovenError, prove_path
from problems.lcp.parametric.sensitivity import Gradient, NotDifferentiableError, Sensitivity
from problems.lcp.parametric.solutions import Solutions, solutions
from problems.lcp.proof.certificate import Certificate, ExactCertificate, certify, certify_exactly
from problems.lcp.proof.farkas import Farkas, FloatFarkas, farkas
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint, strictly_feasible_start
from problems.lcp.reference.enumeration import Exhaustion, solve_by_enumeration
from problems.lcp.search.many import Answers, solve_many
from problems.lcp.search.outcome import Outcome, Solution
from problems.lcp.search.sequence import Solver
from problems.lcp.search.solver import solve

__all__ = [
    "LCP", "Answers", "Certificate", "ExactCertificate", "ExactPath", "Exhaustion", "Farkas", "FloatFarkas", "Gradient",
    "KKTHomotopy", "KojimaMegiddoMizunoHomotopy", "MixedLCP", "NoStrictlyFeasiblePoint", "NotDifferentiableError",
    "Outcome", "Program", "Sensitivity", "Solution", "Solutions", "Solver", "Structure", "TwoVectorHomotopy",
    "UnprovenError", "WangHomotopy", "XuHomotopy", "YuHomotopy", "ZhaoHomotopy", "along", "certify", "certify_exactly",
    "classify", "default_start", "farkas", "from_lp", "from_qp", "prove_path", "random_start",
    "solutions", "solve", "solve_by_enumeration", "solve_many", "strictly_feasible_start",
]  # fmt: skip

register()
