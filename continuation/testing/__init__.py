"""The conformance suite: whether a homotopy fulfils what the engine requires.

``check_homotopy(instance)`` runs it; ``homotopy_checks(instance)`` is for ``pytest.mark.parametrize``; from a shell it
is ``continuation check module:Class``. Checks are chosen by the capabilities that the homotopy has. Each compares two
answers at a few places on a path and beside it: an answer with the form it is to have, with what it was before, with
the derivative of another, or a path with the same path traced otherwise.
"""

from continuation.testing.subject import CheckFailure
from continuation.testing.suite import Check, Result, check_homotopy, homotopy_checks, run_checks

__all__ = ["Check", "CheckFailure", "Result", "check_homotopy", "homotopy_checks", "run_checks"]
