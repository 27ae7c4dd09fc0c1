"""What cannot go well ends with the status that says why, and without a warning."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from continuation import Budget, Status, Tracer, from_functions, trace
from continuation.controllers import Fixed
from continuation.evaluation.errors import EvaluationError
from continuation.predictors import Tangent
from problems.bifurcation import Circle, Cusp, FreudensteinRoth

from ...util import path_of
from ..util import scalar

DEPENDENT = from_functions(
    lambda y, lam: np.array([y[0] + y[1] - lam, 2.0 * (y[0] + y[1] - lam)]), start=([0.0, 0.0], 0.0), target=1.0
)
# Its own factorisation solves nothing.
ZEROS = SimpleNamespace(
    start=lambda: (np.zeros(1), 0.0),
    residual=lambda y, lam: y - lam,
    bordered=lambda y, lam, border: SimpleNamespace(solve=lambda r, rho: np.zeros(2), sign=1),
)
FAR, SINGULAR = Status.START_NOT_ON_PATH, Status.SINGULAR_START


@pytest.mark.parametrize(
    ("homotopy", "status", "words"),
    [
        (scalar(lambda y, lam: y * y - lam * lam, lambda y, lam: (2.0 * y, -2.0 * lam)), SINGULAR, "start"),
        (scalar(lambda y, lam: y * y + lam * lam, lambda y, lam: (2.0 * y, 2.0 * lam)), SINGULAR, "start"),
        (scalar(lambda y, lam: 0.0 * y, lambda y, lam: (0.0, 0.0)), SINGULAR, "start"),
        (DEPENDENT, SINGULAR, "start"),
        (ZEROS, SINGULAR, "the tangent vanishes"),
        (scalar(lambda y, lam: y * y + 1.0, lambda y, lam: (2.0 * y, 0.0), start=(1.0, 0.0)), FAR, "corrector says"),
        (scalar(lambda y, lam: y * np.nan, lambda y, lam: (1.0, 0.0)), FAR, "not finite"),
    ],
    ids=[
        "crossing",
        "isolated",
        "nothing",
        "dependent rows",
        "solves give zero",
        "far from any path",
        "without a value",
    ],
)
def test_a_start_from_which_no_path_leaves(homotopy, status, words):
    path = trace(homotopy)
    assert (path.status, len(path)) == (status, 0)
    assert words in path.message
    # Nor does one in a direction.
    u = np.append(*homotopy.start())
    assert not trace(homotopy, start=(u, np.ones(u.size))).success
    with pytest.raises(IndexError, match="no point"):
        _ = path.endpoint


def test_a_start_far_off_the_path_is_put_on_it():
    """Newton's first increment is 33; each of the next takes back a third of what is left."""
    path = path_of(scalar(lambda y, lam: y**3 - 1.0 - lam, start=(0.1, 0.0)))
    np.testing.assert_allclose(path.u[[0, -1], 0], (1.0, 2.0 ** (1.0 / 3.0)), rtol=1e-8)


@pytest.mark.parametrize(
    ("homotopy", "kink"),
    [
        (scalar(lambda y, lam: np.abs(y) - lam, start=(1.0, 1.0), target=-0.5), (0.0, 0.0)),
        (scalar(lambda y, lam: np.abs(y) - lam, lambda y, lam: (np.sign(y), -1.0), (1.0, 1.0), -0.5), (0.0, 0.0)),
        (scalar(lambda y, lam: y - 5.0 * np.maximum(0.0, lam - 0.3)), (0.0, 0.3)),
    ],
    ids=["abs", "abs with derivative", "kink"],
)
def test_a_path_ends_at_a_kink_and_says_so(homotopy, kink):
    path = path_of(homotopy, status=Status.STEP_TOO_SMALL)
    np.testing.assert_allclose(path.endpoint.u, kink, rtol=0, atol=1e-8)
    assert path.events == []
    # The attempts that failed there, the last of which the message names.
    assert str(path.rejected[-1]) in path.message
    # What was accepted lies on the path.
    assert max(np.abs(homotopy.residual(step.y, step.lam)).max() for step in path.steps) <= 1e-8


@pytest.mark.parametrize(
    ("residual", "slope"),
    [
        (lambda y, lam: y - lam if lam < 0.5 else y * np.nan, lambda y, lam: (1.0, -1.0)),
        (lambda y, lam: y - lam, lambda y, lam: (1.0 if lam < 0.5 else np.nan, -1.0)),
    ],
    ids=["residual", "Jacobian"],
)
def test_what_turns_nan_ends_the_domain(residual, slope):
    path = path_of(scalar(residual, slope), status=Status.LEFT_DOMAIN)
    assert 0.5 - 1e-8 <= path.endpoint.lam <= 0.5
    assert "not finite" in path.message


def root(y, lam):
    return 1.0, -0.5 / np.sqrt(lam)


def test_the_first_step_is_the_same_part_of_the_way_to_the_edge_of_any_domain():
    parts = []
    for edge in (1e-3, 0.37, 0.5, 3.1):
        homotopy = scalar(lambda y, lam, edge=edge: y - lam if lam < edge else y * np.nan, lambda y, lam: (1.0, -1.0))
        parts.append(trace(homotopy, target=None, direction=1, budget=Budget(steps=1)).endpoint.lam / edge)
    np.testing.assert_allclose(parts, parts[0], rtol=1e-3)


@pytest.mark.parametrize("target", [None, 10.0, 1e3])
@pytest.mark.parametrize("n", [1, 3, 40])
def test_the_first_step_knows_nothing_of_unknowns_that_stand_still(n, target):
    def residual(y, lam):
        return np.concatenate([y[:1] - np.exp(lam) + 1.0, y[1:] * (1.0 + y[0] ** 2)])

    alone, path = (
        trace(from_functions(residual, start=(np.zeros(size), 0.0), target=target), direction=1, budget=Budget(steps=1))
        for size in (1, n + 1)
    )
    assert 1.0 <= path.endpoint.lam / alone.endpoint.lam <= 2.5


def by_math(y, lam):
    return np.array([y[0] - math.sqrt(1.0 - float(np.real(lam)))])


@pytest.mark.parametrize(
    ("residual", "slope", "start", "target", "statuses", "within"),
    [
        (lambda y, lam: y - np.sqrt(1.0 - lam), None, (1.0, 0.0), 2.0, [Status.LEFT_DOMAIN], 1e-4),
        (by_math, None, (1.0, 0.0), 2.0, [Status.LEFT_DOMAIN], 1e-4),
        # A logarithm is named before the edge is met.
        (lambda y, lam: y + np.log(1.0 - lam), None, (0.0, 0.0), 2.0, [Status.DIVERGED], 1e-4),
        # H_lam is infinite on the edge itself.
        (lambda y, lam: y - np.sqrt(lam), root, (1.0, 1.0), -1.0, [Status.LEFT_DOMAIN], 1e-8),
        (lambda y, lam: y - np.sqrt(lam), root, (1.0, 1.0), 0.0, [Status.LEFT_DOMAIN, Status.REACHED_TARGET], 1e-8),
    ],
    ids=["sqrt", "math.sqrt", "log", "sqrt with a derivative", "target on the edge"],
)
def test_the_edge_of_the_domain_is_met_without_a_warning(residual, slope, start, target, statuses, within):
    path = trace(scalar(residual, slope, start, target), budget=Budget(steps=300))
    assert path.status in statuses
    # From inside; what is reached on the edge is the root there.
    inside = path.endpoint.lam if slope else 1.0 - path.endpoint.lam
    assert (0.0 if slope else -1e-12) <= inside <= within
    assert path.status is not Status.REACHED_TARGET or abs(path.endpoint.y[0]) <= 1e-6
    reasons = [attempt.reason for attempt in path.rejected]
    assert path.status is not Status.LEFT_DOMAIN or reasons[-1].leaves_domain


def test_an_exception_of_the_plug_in_is_its_own_and_the_path_is_kept():
    def residual(y, lam):
        if lam > 0.5:
            raise KeyError("a table ends here")
        return y - lam

    tracer = Tracer(scalar(residual, lambda y, lam: (1.0, -1.0)))
    with pytest.raises(KeyError, match="a table ends here"):
        tracer.run()
    assert tracer.path.status is Status.RAISED
    assert tracer.path.message.endswith("It says: KeyError: 'a table ends here'")
    assert len(tracer.path) > 1


class CurveUntil(Tangent):
    """Tangents up to a parameter value, and nothing beyond."""

    def prepare(self, evaluator, point, history):
        if point.lam > 0.2:
            raise EvaluationError("there is no curve")
        return super().prepare(evaluator, point, history)


def test_a_predictor_that_fails_is_named_and_no_step_is_blamed():
    path = path_of(
        scalar(lambda y, lam: y - lam, lambda y, lam: (1.0, -1.0)),
        predictor=CurveUntil(),
        status=Status.PREDICTOR_FAILED,
    )
    assert path.message.endswith("It says: there is no curve.")
    assert path.endpoint.lam > 0.2
    assert path.rejected == ()


@pytest.mark.parametrize(
    ("homotopy", "budget", "words"),
    [
        (Circle(), Budget(steps=5), "Reached: 5 steps"),
        (FreudensteinRoth(), Budget(factorizations=20), "20 factori"),
        (Circle(), Budget(seconds=1e-9), "seconds"),
    ],
)
def test_a_budget_is_named_and_looked_at_between_attempts(homotopy, budget, words):
    path = path_of(homotopy, budget=budget, status=Status.BUDGET_EXHAUSTED)
    assert words in path.message
    assert path.counts.accepted == len(path) - 1 <= budget.steps
    assert path.counts.factorizations < budget.factorizations + 15


def test_a_budget_also_ends_a_step_that_keeps_failing():
    homotopy = scalar(lambda y, lam: y - lam if lam < 0.5 else y * np.nan, lambda y, lam: (1.0, -1.0))
    path = trace(homotopy, controller=Fixed(), budget=Budget(factorizations=15))
    assert path.status in (Status.BUDGET_EXHAUSTED, Status.LEFT_DOMAIN)


class Interrupted(Cusp):
    """Ctrl-C is pressed at the k-th residual."""

    def __init__(self, k):
        super().__init__()
        object.__setattr__(self, "left", [k])

    def residual(self, y, lam):
        self.left[0] -= 1
        if self.left[0] == 0:
            raise KeyboardInterrupt
        return super().residual(y, lam)


@pytest.mark.parametrize("k", range(2, 100, 4))
def test_ctrl_c_loses_nothing(k):
    whole, tracer = trace(Cusp()), Tracer(Interrupted(k))
    with pytest.raises(KeyboardInterrupt) as interrupt:
        tracer.run()
    path = tracer.path
    assert path is interrupt.value.path
    assert path.status is Status.INTERRUPTED
    np.testing.assert_array_equal(path.u, whole.u[: len(path)] if len(path) else path.u)
    if tracer.state is not None:
        rest = path_of(Cusp(), state=tracer.state)
        np.testing.assert_array_equal(rest.u, whole.u[len(path) :])
        assert len(path.events) + len(rest.events) == len(whole.events)
