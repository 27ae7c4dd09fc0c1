"""What is tried, and in what order: `AUTOMATIC` for ``homotopy="auto"``, `NAMED` for a homotopy by name (at the end).

Each entry says when it is tried, what it does, and what is said where that settled the problem: by a solution, or by a
proof that there is none. Another attempt is one more entry in its place, and its function.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import frozen

from continuation.step.presets import FAST
from problems.lcp.active_set.finish import below_zero
from problems.lcp.active_set.iteration import Policy
from problems.lcp.active_set.multigrid_guess import guess
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.certificate import certify
from problems.lcp.proof.farkas import infeasibility
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint, strictly_feasible_start
from problems.lcp.proof.verdict import LARGEST_DECIDED
from problems.lcp.reference.enumeration import decidable, exhaust
from problems.lcp.search import said
from problems.lcp.search.case import Case
from problems.lcp.search.conditions import (
    always,
    as_given,
    game_perhaps,
    has_coarser_problems,
    in_a_box,
    monotone,
    near,
    pivotable,
    provable,
    reflectable,
    scaled,
    stopped,
    tiny,
    wang_may_do,
    with_rows,
    zero_solves,
)
from problems.lcp.search.limits import (
    AT_GUESS,
    FEW_GROUPS,
    FEW_PIECES,
    FIRST,
    FIRST_ROUND,
    FIRST_ROUNDS,
    FIRST_SHARE,
    FIRST_WORK,
    FROM_ZERO,
    LARGE_TREE,
    LARGEST_EARLY_PROOF,
    LARGEST_MADE_DENSE,
    LEAST_START,
    MOST_AUGMENTED,
    MOST_ROUNDS,
    MOST_WORK,
    MOST_Z_STEPS,
    PROOF_SHARE,
    REFLECTED_SHARE,
    SMALL_TREE,
    WHILE_REGULAR,
)
from problems.lcp.search.pivots import by_guess, by_lemke, by_lemke_howson
from problems.lcp.search.reflections import rounds_within
from problems.lcp.search.restarts import FAR_STARTS, NEAR_STARTS, first_patience


@frozen
class Attempt:
    """One entry of a strategy.

    Attributes
    ----------
    name : str
    when : callable
        Whether it is tried.
    run : callable
        Tries it; whether that settled the problem.
    said : str
        What is said then, with attributes of the case in braces.
    """

    name: str
    when: Callable[[Case], bool]
    run: Callable[[Case], bool]
    said: str


# -- the attempts ---------------------------------------------------------------------------------------------


def _made_dense(case: Case) -> bool:
    case.search.make_dense()
    return False


def _rescaled(case: Case) -> bool:
    case.search.rescale()
    if case.search.scaled is not None and case.x0 is not None:
        case.x0 = case.search.scaled.u(case.x0)
    return False


def _zero(case: Case) -> bool:
    case.search.accept(certify(case.problem, case.problem.near_zero))
    return case.search.solved


def _from_coarser_problems(case: Case) -> bool:
    return case.search.settle(guess(case.problem, case.factoring, case.search.counts), FIRST)


def _proximally_from_zero(case: Case) -> bool:
    return case.search.settle_proximally(case.first_state)


def _from_zero(case: Case) -> bool:
    policy = FROM_ZERO
    if case.known.z_matrix:
        policy = Policy(steps=min(case.problem.n, MOST_Z_STEPS))
    elif as_given(pivotable)(case) and case.problem.n <= LARGEST_MADE_DENSE and not case.known.negative_diagonal:
        policy = WHILE_REGULAR
    return case.search.settle(case.first_state, policy)


def _further(case: Case) -> bool:
    finish = case.search.finish
    assert finish is not None
    assert finish.stopped is not None
    return case.search.settle(finish.stopped, FROM_ZERO)


def _from_x0(case: Case) -> bool:
    assert case.x0 is not None
    return case.search.settle(case.problem.states(case.x0, case.problem.w(case.x0)), FIRST)


def _from_guess(case: Case) -> bool:
    assert case.guess is not None
    x, w = case.guess.x, case.guess.w
    return case.search.settle(case.problem.states(x, w), AT_GUESS) or by_guess(case.search, case.guess)


def _proximally_from_last(case: Case) -> bool:
    return case.search.settle_proximally()


def _descent(case: Case) -> bool:
    return case.search.descend(case.first_state)


def _augmented(case: Case) -> bool:
    n = case.problem.primal
    below = 0.0 if case.semidefinite else below_zero(case.problem.A[:n][:, :n])
    return case.search.augment(below, MOST_AUGMENTED)


def _by_lemke_howson(case: Case) -> bool:
    return by_lemke_howson(case.search, case.seed)


def _by_lemke(case: Case) -> bool:
    case.pivoted = True
    return by_lemke(case.search, case.seed)


def _proof(case: Case) -> bool:
    case.proof_sought = True
    case.search.proof = infeasibility(case.problem, PROOF_SHARE * case.search.seconds_left)
    return case.search.proof is not None


def _all_faces(case: Case) -> bool:
    case.search.exhaustion = found = exhaust(case.problem, case.search.seconds_left, filtered=True)
    if found is None:
        return False
    if found.point is not None and np.isfinite(found.point).all():
        case.search.accept(certify(case.problem, found.point))
    return True


def _feasible_start(case: Case) -> bool:
    """Find x0; where it is proved that there is none, that proof may settle the problem."""
    try:
        assert isinstance(case.problem, LCP)
        case.x0 = strictly_feasible_start(case.problem)
    except NoStrictlyFeasiblePoint as error:
        case.reason = str(error)
        if error.certificate is not None and error.certificate.no_feasible_point:
            case.search.proof = error.certificate
        return True
    return False


def _path(name: str = "", patient: bool = False, **options: Any) -> Callable[[Case], bool]:
    """The path of a homotopy by name, or of the one that was asked for."""

    def run(case: Case) -> bool:
        case.followed = name or case.asked
        start = case.x0
        if start is not None and case.problem.standard and not start.all():
            start = np.where(start > 0.0, start, LEAST_START * natural_units(case.problem)[0])
        homotopy = HOMOTOPIES[case.followed].from_x0(case.problem, start, case.search.structure)
        if name and not np.isfinite(homotopy.start()[0]).all():  # products with x0 overflow
            homotopy = HOMOTOPIES[name].from_x0(case.problem, None, case.search.structure)
        patience = first_patience(case.problem.n) if patient and case.hurried else None
        return case.search.follow(homotopy, patience=patience, **options)

    return run


def _restarts(case: Case) -> bool:
    # Of a matrix that a homotopy by name was chosen for nothing was found out.
    bands = NEAR_STARTS if case.facts is not None and case.facts.nonnegative else FAR_STARTS
    case.tried = case.search.restart(case.asked, case.seed, case.restarts, case.executor, bands)
    return case.search.solved


def _small_tree(case: Case) -> bool:
    return case.problem.n > FEW_GROUPS[0] and case.groupable(SMALL_TREE)


def _reflected(case: Case) -> bool:
    most = FIRST_ROUND if case.groupable(SMALL_TREE) else FIRST_ROUNDS
    return case.reflect(rounds_within(case.problem.n, FIRST_WORK, most), FIRST_SHARE)


def _reflected_further(case: Case) -> bool:
    return case.reflect(rounds_within(case.problem.n, MOST_WORK, MOST_ROUNDS), REFLECTED_SHARE)


# -- the order of them ---------------------------------------------------------------------------------------

WITHOUT_PATH: tuple[Attempt, ...] = (
    Attempt("x = 0", lambda c: c.problem.standard and zero_solves(c), _zero, "q >= 0, so x = 0 is a solution."),
    Attempt(
        "the point nearest to zero",
        lambda c: not c.problem.standard and zero_solves(c),
        _zero,
        "The point nearest to zero is a solution.",
    ),
    Attempt("a problem nearby", near, _from_guess, "Solved from the solution of a problem nearby, before any path."),
    Attempt("active sets, from x0", lambda c: c.x0 is not None, _from_x0, said.SETTLED),
    Attempt("active sets, from coarser problems", has_coarser_problems, _from_coarser_problems, said.SETTLED),
    Attempt("Lemke and Howson, as given", as_given(game_perhaps), _by_lemke_howson, said.LEMKE_HOWSON),
    Attempt("Lemke, at once", as_given(lambda c: pivotable(c) and c.contact_perhaps), _by_lemke, said.LEMKE),
    Attempt(
        "active sets of A + shift I, from x = 0", lambda c: c.definite_perhaps, _proximally_from_zero, said.SETTLED
    ),
    Attempt("active sets, from x = 0", always, _from_zero, said.SETTLED),
    Attempt("active sets of A + shift I, from the last", monotone, _proximally_from_last, said.SETTLED_SHIFTED),
    Attempt("Lemke, as given", as_given(scaled(pivotable)), _by_lemke, said.LEMKE),
    Attempt("active sets, further", stopped, _further, said.SETTLED),
    Attempt("proof, at once", tiny, _proof, said.PROVED),
    Attempt("few faces, at once", tiny, _all_faces, said.TRIED),
    Attempt("units of its own", lambda c: c.search.postponed, _rescaled, ""),
    Attempt("descent in a box", in_a_box, _descent, said.DESCENDED),
    Attempt("dense from here on", lambda c: c.problem.sparse and c.problem.n <= LARGEST_MADE_DENSE, _made_dense, ""),
    Attempt("Lemke and Howson", scaled(game_perhaps), _by_lemke_howson, said.LEMKE_HOWSON),
    Attempt("Lemke", scaled(pivotable), _by_lemke, said.LEMKE),
    Attempt("proof, early", lambda c: c.problem.n <= LARGEST_EARLY_PROOF and not c.proof_sought, _proof, said.PROVED),
    Attempt("few groups of faces", lambda c: c.groupable(FEW_GROUPS), lambda c: c.branch(FEW_GROUPS), said.BRANCHED),
    Attempt("reflections", reflectable, _reflected, said.REFLECTED),
    Attempt("some groups of faces", _small_tree, lambda c: c.branch(SMALL_TREE), said.BRANCHED),
    Attempt(
        "few pieces", lambda c: not c.problem.standard and decidable(c.problem, FEW_PIECES), _all_faces, said.TRIED
    ),
    Attempt("augmented Lagrangian", with_rows, _augmented, said.AUGMENTED),
)
"""What is cheap and cannot mislead."""

# The end of Wang's path solves the problem, where it has one; the KKT path has an end, which need not solve it.
PATHS: tuple[Attempt, ...] = (
    Attempt("Wang's path", wang_may_do, _path("wang", preset=FAST), said.FOLLOWED),
    Attempt("KKT path, first", lambda c: not wang_may_do(c), _path("kkt", True, preset=FAST), said.FOLLOWED),
    Attempt("proof", lambda c: c.in_budget and not c.proof_sought and provable(c), _proof, said.PROVED),
    Attempt("KKT path", lambda c: c.in_budget and wang_may_do(c), _path("kkt", preset=FAST), said.FOLLOWED),
    Attempt("groups of faces", lambda c: c.groupable(LARGE_TREE), lambda c: c.branch(LARGE_TREE), said.BRANCHED),
    Attempt("all faces", lambda c: c.in_budget and decidable(c.problem, LARGEST_DECIDED), _all_faces, said.TRIED),
    Attempt("reflections, further", reflectable, _reflected_further, said.REFLECTED),
    Attempt("restarts", lambda c: c.restarts > 0, _restarts, said.RESTARTED),
)
"""Any of these may cost the whole budget."""

AUTOMATIC = (*WITHOUT_PATH, *PATHS)
"""For any matrix."""

NAMED: tuple[Attempt, ...] = (
    Attempt(
        "feasible start", lambda c: c.x0 is None and HOMOTOPIES[c.asked].feasible, _feasible_start, "{case.reason}"
    ),
    Attempt("path", always, _path(), said.FOLLOWED),
    Attempt("proof", provable, _proof, said.PROVED),
    Attempt("restarts", lambda c: c.restarts > 0, _restarts, said.RESTARTED),
)
"""For a homotopy that was asked for."""


def _exactly(case: Case) -> bool:
    search = case.search
    found = exhaust(case.problem, search.seconds_left, filtered=True)
    if found is None or found.point is None or not np.isfinite(found.point).all():
        return False
    end = certify(case.problem, found.point)
    if search.confirmed(end):
        search.exhaustion = found
        search.ends.clear()
        search.accept(end)
    return search.exhaustion is found


EXACTLY = Attempt(
    "all faces, for an exact solution",
    lambda c: decidable(c.problem, LARGEST_DECIDED) and (c.search.scaled is None or c.search.scaled.exact),
    _exactly,
    said.TRIED,
)
"""Where active sets end within a singular face, which holds no solution of the data as given, another one may."""


def settled_by(case: Case, strategy: tuple[Attempt, ...]) -> Attempt | None:
    """Try one after another; the attempt that settled the problem, or None.

    Parameters
    ----------
    case : Case
        Takes up what is found.
    strategy : tuple of Attempt
    """
    return next((one for one in strategy if one.when(case) and one.run(case)), None)
