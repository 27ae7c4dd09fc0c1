"""Every campaign of the reliability report at a size for the suite; `make reliability` runs them at length."""

import pytest

import continuation
from continuation import adapters, controllers, correctors, predictors
from problems import bifurcation, lcp, nonlinear, orbits

from . import hostile, run
from .campaigns import Found
from .points import POINTS

SMOKE = {campaign: point.number for point in reversed(POINTS) for campaign in point.campaigns}
"""Each once: some serve two points."""


@pytest.mark.parametrize("campaign", SMOKE, ids=SMOKE.values())
def test_a_campaign(tmp_path, campaign):
    if campaign.needs:
        pytest.importorskip(campaign.needs)
    found = campaign.run(tmp_path, campaign.smoke)
    assert found.wrong == 0, found.text
    assert found.done >= campaign.smoke


RESULTS = {
    "Certificate", "Counts", "Decision", "ExactCertificate", "ExactPath", "Exhaustion", "Farkas", "FloatFarkas",
    "Gradient", "Interrupted", "Kind", "Knot", "LocatedEvent", "Outcome", "Path", "Preset", "Program",
    "Proof", "Sensitivity", "Solution", "Solutions", "Status", "Step", "StepMeasures",
    "Answers", "Diagram", "Correction", "ComplementaritySolution", "FixedPointHomotopy", "NewtonHomotopy",
    "BrownAlmostLinear", "InteriorHomotopy", "TwoVectorHomotopy", "Euclidean", "Circle", "Hermite",
    "Tangent", "Followed", "plot_orbits",
}  # fmt: skip
"""What is made by the package and handed over, made by a function that is in the table, or takes no argument."""


MODULES = (continuation, controllers, correctors, predictors, lcp, nonlinear, bifurcation, orbits)


@pytest.mark.parametrize("module", MODULES)
def test_everything_public_is_in_the_table(module):
    tried = {hostile.name_of(call) for call in hostile.calls()} | {"Tracer"}
    # What needs another library to refuse anything is tried in tests/continuation/adapters.
    left = RESULTS | set(adapters.__all__)
    known = {name for name in module.__all__ if name not in left and callable(getattr(module, name))}
    for name in known - tried:
        found = getattr(module, name)
        assert getattr(found, "_is_protocol", False) or (isinstance(found, type) and issubclass(found, Exception)), name


def test_the_tests_that_points_name_are_there():
    for point in POINTS:
        assert point.tests or point.campaigns
        for test in point.tests:
            assert (run.ROOT / test).exists(), test


def test_a_table_says_what_is_wrong():
    point = next(point for point in POINTS if point.number == "10")
    campaign, test = point.campaigns[0].run, point.tests[0]
    text, wrong = run.table([point], {campaign: Found(3, 1, "so many"), test: Found(5, 0, "5 tests pass")})
    assert wrong == 1
    assert "5 tests pass; so many; **1 WRONG** |" in text
