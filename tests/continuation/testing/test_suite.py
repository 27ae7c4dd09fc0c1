"""The suite as a whole: what runs, what is said, and failures that are expected."""

import pytest

from continuation.testing import CheckFailure, check_homotopy, homotopy_checks, run_checks
from continuation.testing.suite import CHECKS

from .util import Interior, NoSolution, WrongSeries, interior

SMOOTH = [rule for rule in CHECKS if rule.capability not in ("switches", "piece")]
CAPABILITIES = {rule.capability for rule in SMOOTH} - {""}


def test_a_right_homotopy_passes_every_check():
    results = check_homotopy(Interior())
    assert [result.name for result in results] == [rule.name for rule in SMOOTH]
    assert {result.outcome for result in results} == {"passed"}


def test_all_that_is_wrong_is_said_at_once():
    with pytest.raises(CheckFailure) as caught:
        check_homotopy(WrongSeries())
    first, *others = str(caught.value).splitlines()
    assert first == f"WrongSeries fails 1 of {len(SMOOTH)} checks:"
    assert others[0].startswith("  taylor: at the start the residual along the series falls like h^")


def test_only_the_capabilities_that_are_there_are_checked():
    names = [str(check) for check in homotopy_checks(NoSolution())]
    assert "jacobian" not in names
    assert "target" not in names
    assert CAPABILITIES.isdisjoint(names)


def test_nothing_is_called_while_the_checks_are_collected():
    assert len(homotopy_checks(interior(start=pytest.fail, residual=pytest.fail))) == len(SMOOTH)


def test_what_depends_on_a_failed_check_is_not_run():
    results = {result.name: result for result in run_checks(interior(start=None))}
    assert results.pop("start").outcome == "failed"
    assert {result.outcome for result in results.values()} == {"not run"}
    assert results["residual"].message == "it needs start, which did not pass"


def test_a_failure_may_be_expected_with_its_reason():
    results = check_homotopy(WrongSeries(), expected_failed_checks={"taylor": "known, issue 12"})
    outcome = next(result for result in results if result.name == "taylor")
    assert outcome.outcome == "failed as expected"
    assert outcome.message.endswith("(known, issue 12)")


@pytest.mark.parametrize(
    ("name", "error", "said"),
    [
        ("taylor", CheckFailure, r"taylor: expected to fail .* but it passes: take it off the list"),
        ("tailor", ValueError, r"expected_failed_checks: expected names among .*, found 'tailor'"),
    ],
)
def test_a_failure_that_cannot_come_is_reported(name, error, said):
    with pytest.raises(error, match=said):
        check_homotopy(Interior(), expected_failed_checks={name: "known"})


@pytest.mark.parametrize(("steps", "few"), [(2, True), (None, False)])
def test_fewer_steps_are_looked_at_when_asked(steps, few):
    seen = set()
    watched = interior(observe=lambda self, y, lam: seen.add(lam) or Interior.observe(self, y, lam))
    next(check for check in homotopy_checks(watched, steps=steps) if str(check) == "trace")()
    # A path is traced once to see how long it is, and once with short steps.
    assert (len(seen) <= 6) is few
