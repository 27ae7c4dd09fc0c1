"""The conformance suite for homotopies.

Run ``check_homotopy(instance)``, ``continuation check module:Class`` in a shell, or ``homotopy_checks(instance)`` with
``pytest.mark.parametrize``. The homotopy's capabilities select the checks.
"""

from continuation.testing.subject import CheckFailure
from continuation.testing.suite import Check, Result, check_homotopy, homotopy_checks, run_checks

__all__ = ["Check", "CheckFailure", "Result", "check_homotopy", "homotopy_checks", "run_checks"]
