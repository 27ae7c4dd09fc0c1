"""Sparse derivatives of a residual: the pattern is found, coloured, checked at each evaluation, and grows."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st

from continuation import from_functions, trace
from continuation.counts import Counts
from continuation.evaluation.derivatives import from_residual
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.pattern import found
from continuation.linear import Banded

from ...util import benchmark

alone = benchmark("no_jacobian.py")


def looks(matrix, spent):
    def touched(labels, count):
        spent.append(count)
        return np.stack([matrix[:, labels == k].any(axis=1) for k in range(count)], axis=1)

    return touched


@given(st.integers(9, 300), st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_the_pattern_of_any_matrix_with_few_entries_is_found_or_given_up_at_the_price_of_a_dense_one(n, width, seed):
    generator = np.random.default_rng(seed)
    offsets = generator.integers(-n + 1, n, width) if seed % 2 else generator.integers(-3, 4, width)
    matrix = np.zeros((n, n), bool)
    for offset in offsets:
        matrix |= np.eye(n, k=offset, dtype=bool) & (generator.random((n, 1)) < 0.9)
    spent = []
    pattern = found(looks(matrix, spent), n)
    assert sum(spent) <= n
    if pattern is None:
        return
    assert (pattern.matrix(np.ones(pattern.rows.size)).toarray() == matrix).all()
    for group in range(pattern.count):
        assert matrix[:, pattern.groups == group].sum(axis=1).max() <= 1


def test_the_looks_for_a_band_are_few():
    spent = []
    n = 1024
    matrix = sp.diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(n, n)).toarray() != 0.0
    pattern = found(looks(matrix, spent), n)
    assert pattern.count == 3
    assert sum(spent) <= 64


def test_a_full_matrix_is_known_by_its_blocks():
    spent = []
    assert found(looks(np.ones((2000, 2000), bool), spent), 2000) is None
    assert sum(spent) <= 240


@pytest.mark.parametrize("name", ["bratu-1d", "bratu-2d", "swift-hohenberg", "allen-cahn", "brusselator"])
@pytest.mark.parametrize("way", ["alone", "known", "differences"])
def test_the_same_path_as_with_the_jacobian(name, way, monkeypatch):
    size = {"bratu-1d": 80, "bratu-2d": 9, "swift-hohenberg": 100, "allen-cahn": 9, "brusselator": 40}[name]
    kind = next(kind for key, (kind, _) in alone.PROBLEMS.items() if key.startswith(name))
    monkeypatch.setitem(alone.PROBLEMS, "small", (kind, size))
    found = alone.measured("small", 1, which=("own", way))
    (own, _), (path, _) = found["own"], found[way]
    assert path.status is own.status
    assert [event.kind for event in path.events] == [event.kind for event in own.events]
    # Differences have ten digits, and a fold's parameter twice as many as its point.
    assert alone.folds_apart(path, own) <= (1e-9 if way == "differences" else 1e-13)
    # Nothing dense: of each derivative a few residuals, and some to find the pattern, or the steps of differences.
    each = 22 if way == "differences" else 2
    assert path.counts.residuals <= own.counts.residuals + each * path.counts.jacobians + 300


def structure(homotopy):
    evaluator = Evaluator(homotopy, Counts())
    u = evaluator.start()
    return evaluator.derivative(u[:-1], float(u[-1]))[0]


def test_bands_are_banded_and_small_or_full_ones_dense():
    assert isinstance(structure(alone.Plain(alone.Bratu1D(64))), Banded)
    assert isinstance(structure(alone.Plain(alone.Bratu1D(63))), np.ndarray)
    assert sp.issparse(structure(alone.Plain(alone.Bratu2D(10))))
    n = 100
    whole = np.random.default_rng(1).random((n, n)) + n * np.eye(n)
    assert isinstance(structure(from_functions(lambda y, lam: whole @ y - lam, start=(np.zeros(n), 0.0))), np.ndarray)
    # One equation with all unknowns makes groups of one column each.
    mean = from_functions(lambda y, lam: np.append(y[1:] ** 3 - lam, y.sum()), start=(np.zeros(n), 0.0))
    assert isinstance(structure(mean), np.ndarray)


def test_what_is_zero_at_the_start_is_seen():
    n = 70
    homotopy = from_functions(
        lambda y, lam: y + y * np.concatenate((y[1:], y[:1])) - lam, start=(np.zeros(n), 0.0), target=1.0
    )
    assert structure(homotopy).nnz == 2 * n
    path = trace(homotopy)
    assert path.counts.notes == {"H' by jets in 2 groups of columns"}
    np.testing.assert_allclose(path.endpoint.y, (np.sqrt(5.0) - 1.0) / 2.0, rtol=0, atol=1e-12)


def neighbours(n, far, when):
    """Each unknown minds the next one, and beyond `when` another one too."""

    def residual(y, lam):
        near = y + 0.3 * np.sin(np.concatenate((y[1:], y[:1]))) - lam
        return near + (far * (y[0] - 0.2 * y) * (lam - when) if lam > when else 0.0 * y)

    return residual


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("far", [1.0, 1e-2])
def test_a_pattern_that_changes_is_noticed(far, compiled):
    n = 90
    residual = neighbours(n, far, 0.5)
    homotopy = alone.Plain(from_functions(residual, start=(np.zeros(n), 0.0), target=1.0), compiled=compiled)
    derivative = from_residual(homotopy.residual, homotopy.start())
    y = np.linspace(0.0, 1.0, n)
    before, after = (derivative(y, lam)[0].toarray() for lam in (0.25, 0.75))
    assert before[5, 0] == 0.0
    np.testing.assert_allclose(after[2:-1, 0], 0.25 * far, rtol=1e-6)
    assert any("changed" in note for note in derivative.notes)
    path = trace(homotopy)
    assert path.success
    assert np.abs(residual(path.endpoint.y, 1.0)).max() <= 1e-8
    assert any("changed" in note for note in path.counts.notes)
    assert "changed" in str(path.counts)


def test_a_wrong_sparsity_is_mended():
    n = 80
    bratu = alone.Bratu1D(n)
    path = trace(alone.Plain(bratu, sparsity=np.eye(n)), **alone.options(bratu, "FAST"))
    assert alone.folds_apart(path, trace(bratu, **alone.options(bratu, "FAST"))) <= 1e-13
    assert any("changed" in note for note in path.counts.notes)


@pytest.mark.parametrize("sparsity", [np.eye(3), np.ones(80), "tridiagonal", sp.eye_array(81)])
def test_a_sparsity_of_another_shape_is_refused(sparsity):
    with pytest.raises((TypeError, ValueError), match=r"sparsity: expected a matrix of shape \(80, 80\)"):
        trace(alone.Plain(alone.Bratu1D(80), sparsity=sparsity))


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12])
def test_units_of_unknowns_and_equations_do_not_matter(unit, compiled):
    n = 80
    units = np.where(np.arange(n) % 2, unit, 1.0)
    bratu = alone.Bratu1D(n)

    def residual(y, lam):
        return bratu.residual(y / units, lam) * units[::-1]

    y = 0.5 * np.sin(np.arange(n) + 1.0)
    homotopy = alone.Plain(from_functions(residual, start=(y * units, 1.0)), compiled=compiled)
    derivative = from_residual(homotopy.residual, homotopy.start())
    exact = bratu.jacobian(y, 1.0)[0].toarray() * units[::-1, None] / units
    np.testing.assert_allclose(derivative(y * units, 1.0)[0].toarray(), exact, rtol=1e-7, atol=0)


def test_products_of_ones_own_make_the_matrix():
    class Products(alone.Plain):
        def differential(self, y, lam, v):
            H_y, H_lam = self.of.jacobian(y, lam)
            return H_y @ v[:-1] + H_lam * v[-1]

    for kind, size in ((alone.Bratu1D, 80), (alone.Bratu1D, 10), (alone.Bratu2D, 9)):
        one = kind(size)
        path, own = (trace(each, **alone.options(one, "FAST")) for each in (Products(one, compiled=True), one))
        assert alone.folds_apart(path, own) <= 1e-13
        assert path.counts.residuals <= own.counts.residuals + 150


def test_products_that_are_no_better_than_differences_miss_nothing():
    class Differenced(alone.Plain):
        def differential(self, y, lam, v):
            ahead, behind = (self.residual(y + h * v[:-1], lam + h * v[-1]) for h in (1e-6, -1e-6))
            return (ahead - behind) / 2e-6

    bratu = alone.Bratu1D(80)
    path = trace(Differenced(bratu), **alone.options(bratu, "FAST"))
    assert path.success
    assert path.counts.residuals < 40 * path.counts.jacobians
    assert alone.folds_apart(path, trace(bratu, **alone.options(bratu, "FAST"))) <= 1e-9
