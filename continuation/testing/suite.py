"""Selection and execution of checks."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from operator import attrgetter
from typing import Any

from attrs import evolve, field, frozen

from continuation.testing import derivatives, paths, pieces, protocol
from continuation.testing.subject import CheckFailure, Examination, Subject

PASSED, FAILED, EXPECTED, NOT_RUN = "passed", "failed", "failed as expected", "not run"


@frozen(eq=False)
class Check:
    """One check of one homotopy: call it.

    Attributes
    ----------
    name : str
    capability : str
        The checked attribute; empty if always there.
    after : str
        The check that must pass first, or empty.
    """

    name: str
    _examine: Examination = field(repr=False)
    capability: str = ""
    after: str = "start"
    _subject: Subject | None = field(default=None, repr=False)

    def __call__(self) -> None:
        """Run the check.

        Raises
        ------
        CheckFailure
            An AssertionError that names the broken promise.
        """
        if self._subject is not None:
            self._examine(self._subject)

    def __str__(self) -> str:
        return self.name


CHECKS = (
    Check("start", attrgetter("start"), after=""),
    Check("residual", protocol.residual),
    Check("repeatable", protocol.repeatable),
    Check("jacobian_types", protocol.jacobian_types, "jacobian"),
    Check("jacobian", derivatives.jacobian, "jacobian", "jacobian_types"),
    Check("differential", derivatives.differential, "differential"),
    Check("bordered", derivatives.bordered, "bordered"),
    Check("start_on_path", attrgetter("first")),
    Check("metric", protocol.metric, "metric"),
    Check("max_step", paths.max_step, "max_step"),
    Check("picklable", protocol.picklable),
    Check("pieces", pieces.pieces, "piece"),
    Check("derivatives_of_pieces", pieces.derivatives_of_pieces, "piece", "pieces"),
    Check("taylor", derivatives.taylor, "taylor", "start_on_path"),
    Check("trace", attrgetter("path"), after="start_on_path"),
    Check("refinement", partial(paths.audited, "refinement", False), after="trace"),
    Check("reversal", partial(paths.audited, "reversal", True), after="trace"),
    Check("resume", paths.resumed, after="trace"),
)
"""Cheap checks first."""


@frozen
class Result:
    """A check's name, outcome and message."""

    name: str
    outcome: str
    message: str = ""


def homotopy_checks(homotopy: Any, *, steps: int | None = None) -> tuple[Check, ...]:
    """Checks that the homotopy's capabilities select.

    Only checks call the homotopy, so a fault fails its tests, not their collection::

        @pytest.mark.parametrize("check", homotopy_checks(Spring()), ids=str)
        def test_spring(check):
            check()

    Parameters
    ----------
    homotopy : Homotopy
        A small instance: matrices become dense, and paths are traced about ten times.
    steps : int, optional
        Default: 60, or 12 without a target.
    """
    subject = Subject(homotopy, steps)
    called_for = (rule for rule in CHECKS if not rule.capability or subject.has(rule.capability))
    return tuple(evolve(rule, subject=subject) for rule in called_for)


def run_checks(
    homotopy: Any, *, expected_failed_checks: Mapping[str, str] | None = None, steps: int | None = None
) -> tuple[Result, ...]:
    """Run all checks that apply.

    Parameters
    ----------
    homotopy : Homotopy
    expected_failed_checks : mapping of str to str, optional
    steps : int, optional
        As for `check_homotopy`.

    Raises
    ------
    ValueError
        If an expected failure is no check.
    """
    expected = dict(expected_failed_checks or {})
    known = [rule.name for rule in CHECKS]
    unknown = [name for name in expected if name not in known]
    if unknown:
        raise ValueError(f"expected_failed_checks: expected names among {', '.join(known)}, found {unknown[0]!r}")
    results: dict[str, Result] = {}
    for check in homotopy_checks(homotopy, steps=steps):
        name, reason = check.name, expected.get(check.name)
        before = results.get(check.after)
        if before is not None and before.outcome != PASSED:
            results[name] = Result(name, NOT_RUN, f"it needs {check.after}, which did not pass")
            continue
        outcome, message = PASSED, ""
        try:
            check()
        except CheckFailure as failure:
            outcome, message = FAILED, str(failure)
        if reason is not None:
            passes = f"expected to fail ({reason}), but it passes: take it off the list"
            outcome, message = (EXPECTED, f"{message} ({reason})") if outcome == FAILED else (FAILED, passes)
        results[name] = Result(name, outcome, message)
    return tuple(results.values())


def check_homotopy(
    homotopy: Any, *, expected_failed_checks: Mapping[str, str] | None = None, steps: int | None = None
) -> tuple[Result, ...]:
    """Check whether a homotopy fulfils the engine's requirements.

    Parameters
    ----------
    homotopy : Homotopy
    expected_failed_checks : mapping of str to str, optional
        Checks known to fail, and why.
    steps : int, optional
        As for `homotopy_checks`.

    Raises
    ------
    CheckFailure
        An AssertionError, one line for each unexpected failure.
    ValueError
        If an expected failure is no check.
    """
    results = run_checks(homotopy, expected_failed_checks=expected_failed_checks, steps=steps)
    failed = [result for result in results if result.outcome == FAILED]
    if failed:
        lines = [f"{type(homotopy).__name__} fails {len(failed)} of {len(results)} checks:"]
        lines += [f"  {result.name}: {result.message.removeprefix(f'{result.name}: ')}" for result in failed]
        raise CheckFailure("\n".join(lines))
    return results
