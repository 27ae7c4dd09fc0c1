"""Ends at which the path is not a function of the parameter that Newton's method could find."""

from types import SimpleNamespace

import numpy as np
import pytest

import continuation
from continuation import DEFAULT, FAST, SERIES, Status
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies import KKTHomotopy, WangHomotopy

from ...util import by_preset, path_of
from ..util import scalar
from .test_ends import power

every_preset = by_preset(FAST, DEFAULT, SERIES)

COUPLED = continuation.from_functions(
    lambda y, lam: np.array([y[0] ** 2 - lam, y[1] ** 2 - 2.0 * lam * (1.0 + y[0])]), start=([1.0, 2.0], 1.0)
)
MIXED = continuation.from_functions(
    lambda y, lam: np.array([(y[0] - 1.0) ** 2 - lam * (1.0 + y[1]), y[1] - np.sin(y[0]) - lam]),
    start=([1.75, 1.23], 0.25),
)
# x = 0 and w = 0 at once in both components: x ~ sqrt(lam).
DOUBLE = WangHomotopy(LCP(np.array([[2.0, 1.0], [1.0, 2.0]]), np.zeros(2)), x0=[1.0, 2.0])


@every_preset
@pytest.mark.parametrize(
    ("homotopy", "y", "winding", "within"),
    [
        *((power(w), [0.0], w, 1e-11) for w in (2, 3, 4)),
        (COUPLED, [0.0, 0.0], 2, 1e-11),
        (MIXED, [1.0, np.sin(1.0)], 2, 1e-11),
        (DOUBLE, np.zeros(4), 2, 1e-10),
    ],
    ids=["root", "third root", "fourth root", "two coupled roots", "root and regular components", "two zeros at once"],
)
def test_a_singular_end_is_the_limit_of_a_power_series(homotopy, y, winding, within, preset):
    path = continuation.trace(homotopy, preset=preset)
    assert (path.status, path.endpoint.lam) == (Status.REACHED_TARGET, 0.0)
    np.testing.assert_allclose(path.endpoint.y, y, rtol=0, atol=within)
    assert path.winding_number == winding
    assert path.end_error <= (1e-7 if homotopy is MIXED else 1e-8)
    assert f"^(1/{winding})" in path.message


@every_preset
@pytest.mark.parametrize("size", [0.0, 1.0, 10.0, 100.0])
def test_where_round_off_grows_towards_the_end_the_limit_has_more_digits_than_the_path(preset, size):
    """H_y = lam^2: round-off of `size` 1e-16 in H leaves y 1e-6 at lam = 1e-4, and at the target any y solves H = 0.

    So neither a landing nor a crossing there is an end; the limit is, to the tolerance.
    """
    homotopy = continuation.from_functions(
        lambda y, lam: np.array([(lam**2 * (y[0] - np.exp(lam)) + size) - size]),
        lambda y, lam: (np.array([[lam**2]]), np.array([2.0 * lam * (y[0] - np.exp(lam)) - lam**2 * np.exp(lam)])),
        start=([np.e], 1.0),
    )
    path = path_of(homotopy, preset=preset)
    assert path.end_error < 1e-8
    assert abs(path.endpoint.y[0] - 1.0) <= 10.0 * path.end_error + 1e-14


@every_preset
def test_a_limit_that_does_not_satisfy_the_equations_is_no_end(preset):
    """A homotopy that jumps at the target itself: the path has the limit 0, where H(0, 0) = -1."""
    homotopy = scalar(
        lambda y, lam: y - lam if lam > 0.0 else y - 1.0, lambda y, lam: (1.0, -1.0), start=(1.0, 1.0), target=0.0
    )
    path = path_of(homotopy, preset=preset, status=Status.STEP_TOO_SMALL)
    # It is followed to the jump and no farther, and nothing is claimed of an end.
    np.testing.assert_allclose(path.endpoint.u, 0.0, rtol=0, atol=1e-9)
    assert (path.end_error, path.winding_number) == (None, None)


# -- ends behind a place where two branches nearly meet ------------------------------------------------------------


def nearly_meeting(c, d):
    """(y - c)^2 = (lam - c)^2 + d^2 from the upper branch at lam = 1: it turns off at lam = c, d from the other one."""
    return SimpleNamespace(
        target=0.0,
        start=lambda: (np.array([c + np.hypot(1.0 - c, d)]), 1.0),
        residual=lambda y, lam: (y - c) ** 2 - (lam - c) ** 2 - d**2,
        max_step=lambda u, v: u[-1] / -v[-1] if v[-1] < 0.0 else np.inf,
    )


@every_preset
@pytest.mark.parametrize(("c", "ratio"), [(3e-3, 0.1), (1e-4, 0.3), (1e-5, 0.1), (1e-6, 0.3), (1e-6, 0.1)])
def test_a_path_that_turns_off_next_to_the_end_is_followed(c, ratio, preset):
    """The other branch is ten tolerances away, or more: nearer ones count as a branch point, which is passed."""
    path = path_of(nearly_meeting(c, c * ratio), preset=preset)
    # Straight on it would be 0, about.
    np.testing.assert_allclose(path.endpoint.y, c + np.hypot(c, c * ratio), rtol=1e-6)


class Unoriented(KKTHomotopy):
    def bordered(self, y, lam, border):
        """The factors do not tell the sign of the determinant, as those of an operator."""
        return SimpleNamespace(sign=0, solve=super().bordered(y, lam, border).solve)


ENDS = {
    (4, 44): [0.0, 0.0, 1.37548783, 0.0],
    (2, 24): [0.0364452589, 0.0],
    (2, 71): [0.0, 0.0304732589],
    (8, 71): [0.0, 0.703214829, 0.260473035, 0.0, 0.00736690494, 0.0, 0.0, 0.000650188398],
    (8, 73): [1.07894192, 0.415154404, 0.0, 0.000491435512, 1.31928004, 0.0, 0.10408397, 0.484365887],
    (2, 49): [0.0443357891, 0.0],
}
"""By n and seed, from CONSERVATIVE with steps of at most 0.05 and no target, where lam = 1e-12."""


@pytest.mark.parametrize(
    ("make", "n", "seed", "preset"),
    [
        *((KKTHomotopy, *case, preset) for case in ENDS for preset in (FAST, DEFAULT, SERIES)),
        # Not enough on (8, 73): there the other branch is a millionth of the path away.
        *((Unoriented, *case, DEFAULT) for case in ENDS if case != (8, 73)),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_the_path_of_a_random_problem_is_followed_to_its_own_end(make, n, seed, preset):
    """Straight on, one component or another would be half of what it is.

    Where no orientation is known, the path between samples is looked at.
    """
    rng = np.random.default_rng([seed, n])
    path = path_of(make(LCP(rng.normal(size=(n, n)), rng.normal(size=n))), preset=preset)
    np.testing.assert_allclose(path.endpoint.y[:n], ENDS[n, seed], atol=1e-7)
