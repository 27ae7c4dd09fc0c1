"""Multiple branch points: all branches that leave, or a message that says the dimension."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation import Kind, branch_directions, from_functions, switch_branch, trace
from continuation.linear.nullspace import kernels


def forks(ranks, more=1):
    places = np.array(ranks * [0.0] + more * [5.0])
    return from_functions(
        lambda y, lam: (lam - places) * y - y**3,
        lambda y, lam: (np.diag(lam - places - 3.0 * y * y), y.copy()),
        start=(np.zeros(places.size), -1.0),
        target=1.0,
    )


def cross(homotopy):
    (event,) = trace(homotopy).events
    assert event.kind == Kind.SINGULAR_POINT
    assert np.abs(event.u).max() < 1e-10
    return event


@pytest.mark.parametrize("structure", [np.asarray, sp.csc_array], ids=["dense", "sparse"])
@pytest.mark.parametrize("lost", [0, 1, 2, 3, 4])
def test_kernels_are_those_of_the_singular_value_decomposition(structure, lost):
    generator = np.random.default_rng(lost)
    n = 12
    left, right = (np.linalg.qr(generator.standard_normal((k, k)))[0] for k in (n, n + 1))
    values = np.append(np.zeros(lost), np.linspace(0.5, 3.0, n - lost))
    matrix = left @ np.column_stack([np.diag(values), np.zeros(n)]) @ right.T
    kernel, co = kernels(structure(matrix))
    assert (kernel.shape, co.shape) == ((n + 1, lost + 1), (n, lost))
    assert np.abs(matrix @ kernel).max() < 1e-12
    assert np.abs(co.T @ matrix).max(initial=0.0) < 1e-12


@pytest.mark.parametrize("ranks", [2, 3])
def test_the_branches_of_pitchforks_at_one_place_are_in_all_signs(ranks):
    homotopy = forks(ranks)
    event = cross(homotopy)
    known, *others = branch_directions(homotopy, event)
    np.testing.assert_allclose(np.abs(known), np.eye(ranks + 2)[-1], atol=1e-4)
    assert len(others) == (3**ranks - 1) // 2
    states = set()
    for start in switch_branch(homotopy, event):
        end = trace(homotopy, start=start).endpoint
        assert end.lam == 1.0
        states.add(tuple(np.round(end.y, 8) + 0.0))
    signs = np.array(np.meshgrid(*ranks * [[-1.0, 0.0, 1.0]])).reshape(ranks, -1).T
    assert states == {(*s, 0.0) for s in signs.tolist() if any(s)}


def test_transcritical_branches_have_the_directions_of_the_quadratic_equations():
    # y1 (lam - y1 - c y2) = 0, y2 (lam - y2 - d y1) = 0: three lines besides the trunk.
    c, d = 0.3, 0.6
    homotopy = from_functions(
        lambda y, lam: np.stack([y[0] * (lam - y[0] - c * y[1]), y[1] * (lam - y[1] - d * y[0])]),
        start=(np.zeros(2), -1.0),
        target=1.0,
    )
    event = cross(homotopy)
    both = np.linalg.solve([[1.0, c], [d, 1.0]], np.ones(2))
    lines = [np.array([1.0, 0.0, 1.0]), np.array([0.0, 1.0, 1.0]), np.append(both, 1.0)]
    _, *others = branch_directions(homotopy, event)
    assert len(others) == 3
    for line in lines:
        assert max(abs(float(line @ v)) / np.linalg.norm(line) for v in others) == pytest.approx(1.0, abs=1e-8)


def test_a_kernel_that_is_too_large_is_said_with_its_dimension():
    homotopy = forks(4)
    with pytest.raises(ArithmeticError, match="kernel of H' has dimension 5 there; up to 4 are resolved"):
        switch_branch(homotopy, cross(homotopy))


def test_a_continuum_of_branches_is_said_with_its_dimension():
    homotopy = from_functions(
        lambda y, lam: lam * y - y * (y[0] * y[0] + y[1] * y[1]), start=(np.zeros(2), -1.0), target=1.0
    )
    with pytest.raises(ArithmeticError, match="dimension 3 there, and its branches do not leave one by one"):
        branch_directions(homotopy, cross(homotopy))
