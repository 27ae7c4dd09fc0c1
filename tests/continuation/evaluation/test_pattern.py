"""Sparse derivatives of a residual: the pattern is found, coloured, checked at each evaluation, and grows."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given
from hypothesis import strategies as st

from continuation import from_functions, trace
from continuation.evaluation.derivatives import from_residual
from continuation.evaluation.pattern import found
from continuation.linear import Banded

from ...util import benchmark, path_of

alone = benchmark("no_jacobian.py")


def look(matrix):
    """The pattern of a matrix, and how many directions it took."""
    spent = []

    def touched(labels, count):
        spent.append(count)
        return np.stack([matrix[:, labels == k].any(axis=1) for k in range(count)], axis=1)

    return found(touched, len(matrix)), sum(spent)


@given(st.integers(9, 300), st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_the_pattern_of_any_matrix_with_few_entries_is_found_or_given_up_at_the_price_of_a_dense_one(n, width, seed):
    generator = np.random.default_rng(seed)
    offsets = generator.integers(-n + 1, n, width) if seed % 2 else generator.integers(-3, 4, width)
    parts = [np.eye(n, k=offset, dtype=bool) & (generator.random((n, 1)) < 0.9) for offset in offsets]
    matrix = np.logical_or.reduce(parts)
    pattern, spent = look(matrix)
    assert spent <= n
    if pattern is not None:
        assert (pattern.matrix(np.ones(pattern.rows.size)).toarray() == matrix).all()
        for group in range(pattern.count):
            assert matrix[:, pattern.groups == group].sum(axis=1).max() <= 1


@pytest.mark.parametrize(
    ("name", "size"),
    [("bratu-1d", 80), ("bratu-2d", 9), ("swift-hohenberg", 100), ("allen-cahn", 9), ("brusselator", 40)],
)
@pytest.mark.parametrize("way", ["alone", "known", "differences"])
def test_the_same_path_as_with_the_jacobian(name, size, way, monkeypatch):
    kind = next(problem.func for key, problem in alone.PROBLEMS.items() if key.startswith(name))
    monkeypatch.setitem(alone.PROBLEMS, "small", partial(kind, size))
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
    y, lam = homotopy.start()
    return from_residual(homotopy.residual, homotopy.start())(y, lam)[0]


N = 100
WHOLE = np.random.default_rng(1).random((N, N)) + N * np.eye(N)


@pytest.mark.parametrize(
    ("homotopy", "kind"),
    [
        (alone.plain(alone.Bratu1D(64)), Banded),
        (alone.plain(alone.Bratu1D(63)), np.ndarray),
        (alone.plain(alone.Bratu2D(10)), sp.sparray),
        (from_functions(lambda y, lam: WHOLE @ y - lam, start=(np.zeros(N), 0.0)), np.ndarray),
        # One equation with all unknowns makes groups of one column each.
        (from_functions(lambda y, lam: np.append(y[1:] ** 3 - lam, y.sum()), start=(np.zeros(N), 0.0)), np.ndarray),
    ],
    ids=["band", "small", "sparse", "full", "a full row"],
)
def test_bands_are_banded_and_small_or_full_ones_dense(homotopy, kind):
    assert isinstance(structure(homotopy), kind)


def test_what_is_zero_at_the_start_is_seen():
    n = 70
    homotopy = from_functions(
        lambda y, lam: y + y * np.concatenate((y[1:], y[:1])) - lam, start=(np.zeros(n), 0.0), target=1.0
    )
    path = trace(homotopy)
    assert path.counts.notes == {"H' by jets in 2 groups of columns"}
    np.testing.assert_allclose(path.endpoint.y, (np.sqrt(5.0) - 1.0) / 2.0, rtol=0, atol=1e-12)


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("far", [1.0, 1e-2])
def test_a_pattern_that_changes_is_noticed(far, compiled):
    def residual(y, lam):
        """Each unknown minds the next one, and from lam = 0.5 on the first one too."""
        near = y + 0.3 * np.sin(np.concatenate((y[1:], y[:1]))) - lam
        return near + (far * (y[0] - 0.2 * y) * (lam - 0.5) if lam > 0.5 else 0.0 * y)

    homotopy = alone.plain(from_functions(residual, start=(np.zeros(90), 0.0), target=1.0), compiled=compiled)
    derivative = from_residual(homotopy.residual, homotopy.start())
    before, after = (derivative(np.linspace(0.0, 1.0, 90), lam)[0].toarray() for lam in (0.25, 0.75))
    assert before[5, 0] == 0.0
    np.testing.assert_allclose(after[2:-1, 0], 0.25 * far, rtol=1e-6)
    path = path_of(homotopy)
    assert np.abs(residual(path.endpoint.y, 1.0)).max() <= 1e-8
    assert "changed" in str(path.counts)


@pytest.mark.parametrize("sparsity", [np.eye(3), np.ones(80), "tridiagonal", sp.eye_array(81)])
def test_a_sparsity_of_another_shape_is_refused(sparsity):
    with pytest.raises((TypeError, ValueError), match=r"sparsity: expected a matrix of shape \(80, 80\)"):
        trace(alone.plain(alone.Bratu1D(80), sparsity=sparsity))


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12])
def test_units_of_unknowns_and_equations_do_not_matter(unit, compiled):
    n, bratu = 80, alone.Bratu1D(80)
    units = np.where(np.arange(n) % 2, unit, 1.0)
    y = 0.5 * np.sin(np.arange(n) + 1.0)
    scaled = from_functions(lambda y, lam: bratu.residual(y / units, lam) * units[::-1], start=(y * units, 1.0))
    exact = bratu.jacobian(y, 1.0)[0].toarray() * units[::-1, None] / units
    np.testing.assert_allclose(structure(alone.plain(scaled, compiled=compiled)).toarray(), exact, rtol=1e-7, atol=0)


def with_products(differential, one):
    """A residual alone, with products with H' of its own."""
    residual = alone.plain(one, compiled=True).residual
    return SimpleNamespace(
        start=one.start, residual=residual, target=one.target, differential=partial(differential, one)
    )


def exactly(one, y, lam, v):
    H_y, H_lam = one.jacobian(y, lam)
    return H_y @ v[:-1] + H_lam * v[-1]


def differenced(one, y, lam, v):
    """No better than differences."""
    ahead, behind = (one.residual(y + h * v[:-1], lam + h * v[-1]) for h in (1e-6, -1e-6))
    return (ahead - behind) / 2e-6


@pytest.mark.parametrize(
    ("one", "make", "apart", "more", "mended"),
    [
        *((kind, partial(with_products, exactly), 1e-13, 150, False)
          for kind in (alone.Bratu1D(80), alone.Bratu1D(10), alone.Bratu2D(9))),
        (alone.Bratu1D(80), partial(with_products, differenced), 1e-9, np.inf, False),
        # A wrong sparsity is mended.
        (alone.Bratu1D(80), lambda one: alone.plain(one, sparsity=np.eye(80)), 1e-13, np.inf, True),
    ],
    ids=["band", "dense", "sparse", "differences", "wrong sparsity"],
)  # fmt: skip
def test_products_of_ones_own_and_a_wrong_sparsity_give_the_same_path(one, make, apart, more, mended):
    path, own = (trace(each, **alone.options(type(one), "FAST")) for each in (make(one), one))
    assert alone.folds_apart(path, own) <= apart
    assert path.counts.residuals <= own.counts.residuals + more
    assert path.counts.residuals < 40 * path.counts.jacobians
    assert ("changed" in str(path.counts)) == mended
