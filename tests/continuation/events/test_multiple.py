"""Multiple branch points: all branches that leave, or a message that says the dimension."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation import Kind, branch_directions, from_functions, switch_branch, trace

TRANSCRITICAL = from_functions(
    lambda y, lam: np.stack([y[0] * (lam - y[0] - 0.3 * y[1]), y[1] * (lam - y[1] - 0.6 * y[0])]),
    start=(np.zeros(2), -1.0),
    target=1.0,
)
ROUND_ABOUT = from_functions(
    lambda y, lam: lam * y - y * (y[0] * y[0] + y[1] * y[1]), start=(np.zeros(2), -1.0), target=1.0
)


def forks(ranks, structure=np.asarray, unit=1.0):
    """Pitchforks at 0 and one elsewhere, of a parameter in such a unit."""
    places = np.array(ranks * [0.0] + [5.0])
    return from_functions(
        lambda y, lam: (lam / unit - places) * y - y**3,
        lambda y, lam: (structure(np.diag(lam / unit - places - 3.0 * y * y)), y / unit),
        start=(np.zeros(places.size), -unit),
        target=unit,
    )


def cross(homotopy, within=1e-10):
    (event,) = trace(homotopy).events
    assert event.kind == Kind.SINGULAR_POINT
    assert np.abs(event.u).max() < within
    return event


@pytest.mark.parametrize(
    ("ranks", "structure", "unit"), [(2, sp.csc_array, 1e-5), (2, np.asarray, 1e5), (3, np.asarray, 1.0)]
)
def test_the_branches_of_pitchforks_at_one_place_are_in_all_signs(ranks, structure, unit):
    homotopy = forks(ranks, structure, unit)
    event = cross(homotopy, within=1e-10 * max(unit, 1.0))
    known, *others = branch_directions(homotopy, event)
    np.testing.assert_allclose(np.abs(known) / np.linalg.norm(known), np.eye(ranks + 2)[-1], atol=1e-4)
    assert len(others) == (3**ranks - 1) // 2
    ends = [trace(homotopy, start=start).endpoint.u for start in switch_branch(homotopy, event)]
    states = {tuple(np.round(end / np.append(np.ones(ranks + 1), unit), 8) + 0.0) for end in ends}
    signs = np.array(np.meshgrid(*ranks * [[-1.0, 0.0, 1.0]])).reshape(ranks, -1).T
    assert states == {(*s, 0.0, 1.0) for s in signs.tolist() if any(s)}


# y1 (lam - y1 - 0.3 y2) = 0, y2 (lam - y2 - 0.6 y1) = 0: three lines besides the trunk; y_k (y_k^2 - lam^2) = 0: eight.
BOTH = np.linalg.solve([[1.0, 0.3], [0.6, 1.0]], np.ones(2))
EIGHT = [[a, b, 1.0] for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0) if a or b]


@pytest.mark.parametrize(
    ("homotopy", "lines", "within"),
    [
        (TRANSCRITICAL, [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [*BOTH, 1.0]], 1e-8),
        (from_functions(lambda y, lam: y * (y**2 - lam**2), start=(np.zeros(2), -1.0), target=1.0), EIGHT, 1e-6),
        # A point of order four is known to 1e-4.
        (
            from_functions(
                lambda y, lam: y * (y - lam) * (y + 0.7 * lam) * (y - 2.3 * lam), start=(np.zeros(1), -1.0), target=1.0
            ),
            [[1.0, 1.0], [-0.7, 1.0], [2.3, 1.0]],
            1e-3,
        ),
    ],
    ids=["three lines", "eight lines", "three in a plane"],
)
def test_branches_have_the_directions_of_the_branching_equations(homotopy, lines, within):
    _, *others = branch_directions(homotopy, cross(homotopy, within))
    assert len(others) == len(lines)
    for line in lines:
        assert max(abs(line @ v) / np.linalg.norm(line) for v in others) == pytest.approx(1.0, abs=within)


@pytest.mark.parametrize(
    ("look", "homotopy", "words"),
    [
        (switch_branch, forks(4), "^the kernel of H' has dimension 5 there; up to 4 are resolved"),
        (
            branch_directions,
            ROUND_ABOUT,
            "^the kernel .* 3 there, and its branches do not leave one by one: there is a continuum",
        ),
    ],
    ids=["too large a kernel", "a continuum"],
)
def test_what_is_not_resolved_is_said_with_its_dimension(look, homotopy, words):
    event = cross(homotopy)
    with pytest.raises(ArithmeticError, match=words):
        look(homotopy, event)
