"""Jets go through numpy as arrays do: each operation against numpy itself, on the values of the polynomials."""

import copy
import operator

import numpy as np
import pytest
import scipy.sparse as sp

from continuation.jets import Jet, jacobian, variable

ORDER = 6
RNG = np.random.default_rng(7)


def evaluate(jet, s):
    """The polynomials' values at s."""
    return sum(c * s**k for k, c in enumerate(jet.c))


def polynomial(*shape):
    """A jet of degree 2 in s, so that products of up to three are exact at order 6."""
    c = np.zeros((ORDER + 1, *shape))
    c[:3] = RNG.integers(-4, 5, (3, *shape))
    return Jet(c)


X, Y, Z = polynomial(3), polynomial(3), polynomial()
M, P, T = polynomial(2, 3), polynomial(3, 3), polynomial(2, 3, 4)
A, V = RNG.integers(-3, 4, (3, 3)).astype(float), np.array([1.0, -2.0, 3.0])
MASK = np.array([True, False, True])


def assert_same_as_numpy(f, *jets):
    """f(jets) at s is f of the values at s, and the gradients agree with the series along a direction."""
    found = f(*jets)
    for s in (0.0, 1.0, -0.5):
        expected = np.asarray(f(*(evaluate(jet, s) for jet in jets)))
        assert found.shape == expected.shape
        np.testing.assert_allclose(evaluate(found, s), expected, rtol=1e-12, atol=1e-12)

    # the other algebra: f as a function of the flat vector of all entries
    ends = np.cumsum([jet.size for jet in jets])

    def flat(u):
        parts = [u[end - jet.size : end].reshape(jet.shape) for jet, end in zip(jets, ends)]
        return f(*parts)

    u0, u1 = (np.concatenate([jet.c[k].ravel() for jet in jets]) for k in (0, 1))
    np.testing.assert_allclose(jacobian(flat, u0) @ u1, found.c[1], rtol=1e-12, atol=1e-12)


def assigned(x, y, z, m):
    """Into arrays like a jet."""
    r, n = np.zeros_like(x), np.zeros_like(m)
    r[0] = x[1] * x[2]
    r[1:] = y[:2]
    r[-1] = 5.0
    n[:, MASK] = x[:2]
    n[..., 1] = z
    n[1] += [1.0, 2.0, 3.0]
    n[0, 0] = x[0]
    return r + n


def viewed(x):
    """Views share memory, entries do not."""
    x = x.copy()
    first, rest = x[0] + 0.0, x[1:]
    rest *= 2
    rest.reshape(2, 1)[0, 0] = 7.0
    x[0] = 9.0 + first
    x[0], x[1] = x[1] + 0.0, x[0] + 0.0
    x -= 1.0
    x /= 2.0
    x **= 2
    x.T[...] += first
    return x


OPERATIONS = {
    "assignment": (assigned, (X, Y, Z, M)),
    "views": (viewed, (X,)),
    "operators": (lambda x, y: +x - y * x + 2 * x - y / 2 + (1 - x) * (-y) + V * x - x * A[0], (X, Y)),
    "scalars": (lambda z, x: z * x + np.float64(2) * z - z * np.arange(3) + True * x, (Z, X)),
    "lists": (lambda x: x + list(V) - np.multiply([2.0, 0, 1], x), (X,)),
    "broadcast": (lambda x, m, t: (m * x + x - m)[:, :, None] + t[:, :, :1] * m[:, :, None], (X, M, T)),
    "constants broadcast": (lambda z, x: z + V + A * x[:, None] + (np.ones((2, 1, 3)) - x), (Z, X)),
    "power": (lambda x: x**2 + x**3.0 - x**1 + x**0 + x ** np.array([1, 2, 3]), (X,)),
    "matrix times vector": (lambda x: A @ x + x @ A, (X,)),
    "matrix times matrix": (lambda m, p: m @ p @ A + m @ A, (M, P)),
    "vector times matrix": (lambda x, p: x @ p + p @ x + V @ p, (X, P)),
    "vector times vector": (lambda x, y: x @ y + V @ x + x @ V, (X, Y)),
    "stacks of matrices": (lambda t, m: m @ t + np.ones((2, 1, 2)) @ t[:1, :2], (T, M)),
    "index": (lambda x: x[0] * x[-1], (X,)),
    "slices": (lambda m: m[0, ::2] + m[1, :2] - m[..., 1][0], (M,)),
    "new axis": (lambda x: x[:, None] * x[None, :] + x[np.newaxis], (X,)),
    "mask": (lambda x: x[MASK], (X,)),
    "fancy": (lambda t: t[[0, 1], :, [2, 3]] + t[1, :, [0, 1]] + t[:, [0, 1, 2], [1, 2, 3]], (T,)),
    "mask of two axes": (lambda p: p[A > 0], (P,)),
    "iteration": (lambda x: sum(x) + sum(a * b for a, b in zip(x, reversed(x))), (X,)),
    "unpacking": (lambda x: np.stack([x[0], *x[1:]]), (X,)),
    "T": (lambda m: m.T @ m, (M,)),
    "transpose": (lambda t: t.transpose(2, 0, 1) + t.transpose((2, 0, 1)) + np.transpose(t, (2, 0, 1)), (T,)),
    "reshape": (lambda m: m.reshape(3, 2) @ m.reshape((2, -1)) + m.ravel()[:3] + np.reshape(m, 6)[3:], (M,)),
    "flatten": (lambda m: m.flatten() + np.ravel(m), (M,)),
    "sum": (
        lambda t: t.sum() + np.sum(t, axis=0)[0, 0] + t.sum(axis=(1, 2), keepdims=True) + t.sum(axis=-1)[0, 0],
        (T,),
    ),
    "mean": (lambda m: m.mean() + np.mean(m, axis=0) + m.mean(axis=1, keepdims=True), (M,)),
    "prod": (lambda m, x: np.prod(m, axis=0) + m.prod(axis=0, keepdims=True) + x.prod(), (M, X)),
    "prod of a scalar": (lambda z: np.prod(z), (Z,)),
    "diff": (lambda m: np.diff(m) + np.diff(m, 1, 0)[:, :2] + np.diff(m, n=2, axis=1), (M,)),
    "dot": (lambda x, p: np.dot(p, x) + x.dot(p) + np.dot(A, x) + np.dot(2.0, x) * np.dot(V, x), (X, P)),
    "vdot": (lambda m: np.vdot(m, m) + np.vdot(np.ones((2, 3)), m), (M,)),
    "outer": (lambda x, m: np.outer(x, m) + np.outer(V, m), (X, M)),
    "einsum": (lambda m, x: np.einsum("ij,j->i", m, x) + np.einsum("ij, j", m, V) + np.einsum("ij->i", m), (M, X)),
    "einsum with dots": (lambda t, p: np.einsum("...ij,ki->...kj", t, p) + np.einsum("iij->j", t[:, :2]), (T, P)),
    "einsum of many": (
        lambda m, x: (
            np.einsum("ij,j,ik->k", m, x, A[:2]) + np.einsum("i,i,i", V, x, x) + np.einsum("...i,i,i->...i", m, x, V)[1]
        ),
        (M, X),
    ),
    "concatenate": (lambda x, y: np.concatenate([[0.0], x, V, y[:1]]), (X, Y)),
    "concatenate axes": (lambda m: np.concatenate((m, m), axis=-1)[:, 2:4] + np.concatenate([m, m], None)[:2], (M,)),
    "scalar jets in lists": (lambda x, z: np.concatenate([[z, 1.0], x]), (X, Z)),
    "stack": (lambda x, y: np.stack([x, y, V]) + np.stack((x, V, y), axis=1) + np.stack([x[0], x[1], 2.0]), (X, Y)),
    "hstack": (lambda x, z: np.hstack([1.0, x, z]), (X, Z)),
    "hstack and vstack": (lambda m, x: np.hstack([m, m])[:, :3] + np.vstack([x, m])[1:], (M, X)),
    "column_stack": (lambda x, p: np.column_stack([x, V, p]), (X, P)),
    "append": (lambda x, z, m: np.append(np.append(x, z), [1.0, 2]) + np.append(m, m, axis=0).ravel()[:6], (X, Z, M)),
    "roll": (lambda m: np.roll(m, 1) + np.roll(m, -1, axis=1) + np.roll(m, (1, 2), (0, 1)), (M,)),
    "flip": (lambda m: np.flip(m) + np.flip(m, 0) + m[::-1, ::-1], (M,)),
    "take": (lambda m: np.take(m, [0, 2], axis=1) + np.take(m, [1, 5]), (M,)),
    "tile and repeat": (lambda x: np.tile(x, 2) + np.repeat(x, 2) + np.tile(x, (2, 2)), (X,)),
    "diag": (lambda x: np.diag(x) + np.diag(np.diag(x)) + np.diag(x[1:], 1), (X,)),
    "triangles": (lambda p: np.tril(p) * np.triu(p, -1) + np.rot90(p) + np.swapaxes(p, 0, 1), (P,)),
    "pad": (lambda x: np.pad(x, 1) + np.pad(x, (2, 0), mode="edge") + np.pad(x, 1, mode="wrap"), (X,)),
    "split": (lambda x: np.split(x, 3)[1] * np.split(x, [1])[1], (X,)),
    "where": (lambda x, m: np.where(MASK, x, 0.0) + np.where([[True], [False]], m, x) + np.where(MASK, 1.0, x), (X, M)),
    "shapes": (lambda m: np.squeeze(np.expand_dims(m, (0, 2)), axis=0) + np.squeeze(m[None]), (M,)),
    "broadcast_to": (lambda x, z: np.broadcast_to(x, (2, 3)) * np.broadcast_to(z, 3), (X, Z)),
    "atleast": (lambda x, z: np.atleast_1d(z) * np.atleast_2d(x) + np.atleast_1d(x, z)[0], (X, Z)),
    "likes": (lambda m: np.zeros_like(m) + np.ones_like(m, dtype=float) * m - np.full_like(m, 2.0), (M,)),
    "full_like": (lambda x, z: np.full_like(x, z) + np.full(3, z), (X, Z)),
    "copy": (lambda x: np.copy(x) + x.copy(), (X,)),
    "object arrays": (lambda x, y: np.array([x[0], 1.0, y[1]]) * x + np.array([x[0], y[1] + 1, y[2]]) ** 2 * V, (X, Y)),
    "object arrays on the left": (
        lambda x, y: np.array([x[0], y[1], y[2]]) @ x + np.square(np.array([y[2]]))[0],
        (X, Y),
    ),
    "positive and square": (lambda x: np.positive(x) + np.square(x) - np.negative(x), (X,)),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_same_as_numpy(name):
    f, jets = OPERATIONS[name]

    def gathered(*arguments):
        result = f(*arguments)
        jet = next((a for a in arguments if isinstance(a, Jet)), None)
        return result if jet is None or isinstance(result, Jet) else np.stack(list(result))

    assert_same_as_numpy(gathered, *jets)


SIGNED = Jet([[-2.0, 1.0, 3.0], [1.0, 2.0, -1.0]])


@pytest.mark.parametrize(
    ("f", "expected"),
    [
        (lambda x: x > 0, [False, True, True]),
        (lambda x: np.ones(3) <= x, [False, True, True]),
        (lambda x: Jet([[0.0, 1, 3], [0, 0, 0]]) == x, [False, True, True]),
        (lambda x: x != 1, [True, False, True]),
        (lambda x: np.less(x, 0), [True, False, False]),
        (lambda x: np.abs(x), [[2, 1, 3], [-1, 2, -1]]),
        (lambda x: np.fabs(x), [[2, 1, 3], [-1, 2, -1]]),
        (lambda x: np.maximum(x, 0.5), [[0.5, 1, 3], [0, 2, -1]]),
        (lambda x: np.minimum(2.0, x), [[-2, 1, 2], [1, 2, 0]]),
        (lambda x: np.clip(x, -1, 2), [[-1, 1, 2], [0, 2, 0]]),
        (lambda x: np.where(x > 0, x, 0.0), [[0, 1, 3], [0, 2, -1]]),
        (lambda x: x[x > 0], [[1, 3], [2, -1]]),
        (lambda x: x[0] < x[1] < x[2], True),
        (lambda x: bool(x[0]), True),
        (lambda x: max(x, key=lambda entry: entry.c[0]), [3, -1]),
    ],
)
def test_values_choose_by_the_leading_coefficient(f, expected):
    found = f(SIGNED)
    np.testing.assert_array_equal(getattr(found, "c", found), expected)


def test_object_arrays_of_scalar_jets_keep_the_series_in_elementary_functions():
    y = variable([0.3, 0.6], [1.0, 1.0], 8)
    entries = np.array([y[0], y[1] * 2])
    assert entries.dtype == object
    for f in (np.exp, np.sin, np.log, np.sqrt, np.tanh, np.cbrt, np.arctan, np.log1p):
        assert all(np.array_equal(a.c, f(b).c) for a, b in zip(f(entries), entries))
    assert np.array_equal((np.exp(entries) + y).c, np.stack([np.exp(y[0]) + y[0], np.exp(2 * y[1]) + y[1]]).c)
    assert np.array_equal(np.asarray(y[0])[()].c, y[0].c)
    assert np.array_equal((np.asarray(y[0]) * y).c, (y[0] * y).c)


def test_jets_of_order_zero_are_numbers():
    x = Jet([[1.0, 2.0, 3.0]])
    assert np.array_equal((x * x + np.square(x) / x - x**3).c, [[1 + 1 - 1, 4 + 2 - 8, 9 + 3 - 27]])
    assert np.array_equal((A @ x).c, [A @ x.c[0]])
    assert np.array_equal(np.log(x).c, np.log(x.c))


def test_out_may_be_a_jet():
    out = np.empty_like(X)
    assert np.add(X, Y, out=out) is out
    assert np.array_equal(out.c, X.c + Y.c)


def test_a_jet_does_not_keep_its_makers_memory():
    c = np.ones((3, 2))
    jet = Jet(c)
    c[:] = 0
    assert jet.c.all()
    assert (jet.shape, jet.ndim, jet.size, len(jet), jet.order, jet.dtype) == ((2,), 1, 2, 2, 2, float)
    assert (np.shape(jet), np.ndim(jet), np.size(jet), np.size(M, 1)) == ((2,), 1, 2, 3)
    assert repr(jet) == "Jet(shape=(2,), order=2, leading=array([1., 1.]))"
    assert all(isinstance(other, Jet) for other in (jet[0], copy.copy(X), copy.deepcopy(Z)))
    assert copy.deepcopy(X).c is not X.c


@pytest.mark.parametrize("make", [sp.csr_array, sp.csc_matrix, sp.dia_array])
def test_sparse_products(make):
    for product in (make(A) @ X, make(A).dot(X), X @ make(A).T, np.matmul(make(A), X)):
        np.testing.assert_allclose(product.c, (A @ X).c, atol=1e-13)
    with pytest.raises(TypeError, match="sparse product with an array of 2 axes"):
        M @ make(A)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: np.asarray(X), "cannot become a plain array.*leave out numpy.asarray"),
        (lambda: np.array([X, Y]), r"np\.stack"),
        (lambda: np.array(X, dtype=object), "cannot become a plain array"),
        (lambda: float(Z), "cannot become a float"),
        (
            lambda: operator.setitem(np.zeros(3), 0, Z),
            r"assignment into a float array.*np\.stack.*np\.concatenate.*np\.zeros_like",
        ),
        (lambda: operator.setitem(np.zeros(3), slice(None), X), r"np\.zeros_like"),
        (lambda: operator.setitem(np.zeros(3), slice(1, 3), Z), r"assignment into a float array"),
        (lambda: operator.iadd(np.zeros(3), X), r"numpy\.add cannot write a Jet into a plain array"),
        (lambda: np.linalg.det(P), r"^jets do not know numpy\.linalg\.det; .* or give a jacobian"),
        (lambda: np.linalg.solve(A, X), r"numpy\.linalg\.solve"),
        (lambda: np.sort(X), r"numpy\.sort"),
        (lambda: np.floor(X), r"numpy\.floor"),
        (lambda: np.floor_divide(X, 2), r"numpy\.floor_divide"),
        (lambda: np.fft.fft(X), r"numpy\.fft\.fft"),
        (lambda: np.max(X), r"numpy\.max"),
        (lambda: np.add.reduce(X), r"numpy\.add\.reduce"),
        (lambda: np.add(X, Y, where=MASK), r"numpy\.add with where"),
        (
            lambda: np.sum(X, where=MASK),
            r"numpy\.sum with these arguments \(got an unexpected keyword argument 'where'\)",
        ),
        (lambda: np.linalg.norm(X, 1), r"numpy\.linalg\.norm with ord=1"),
        (lambda: np.linalg.norm(P, "nuc"), r"numpy\.linalg\.norm with ord='nuc'"),
        (lambda: np.reshape(M, (3, 2), order="F"), r"numpy\.reshape with these arguments"),
        (lambda: np.pad(X, 1, mode="linear_ramp"), r"numpy\.pad with mode='linear_ramp'"),
        (lambda: np.einsum(X, [0], X, [0]), r"numpy\.einsum without subscripts"),
        (lambda: np.where(X, 1.0, X), r"numpy\.where"),
        (lambda: np.tile(V, X), r"numpy\.tile with a jet"),
        (lambda: np.full_like(V, Z), r"numpy\.copyto"),
        (lambda: np.zeros_like(X, dtype=int), "dtype int64"),
        (lambda: X * 1j, "a jet met complex of dtype complex128"),
        (lambda: X + "a", "a jet met str"),
        (lambda: X * sp.csr_array(A), "a jet met csr_array"),
        (lambda: iter(Z), "not iterable"),
        (lambda: hash(X), "unhashable"),
    ],
)
def test_what_is_not_known_names_itself(call, message):
    with pytest.raises(TypeError, match=message):
        call()


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: bool(X), ValueError, "ambiguous"),
        # An index does not reach the coefficients.
        (lambda: operator.setitem(np.empty_like(X), (0, 1), 1.0), IndexError, "indices"),
        (lambda: operator.setitem(np.empty_like(X), 3, 1.0), IndexError, "out of bounds"),
        (lambda: X + np.ones(4), ValueError, r"broadcast|operands"),
        (lambda: A @ X[:2], ValueError, r"mismatch|size"),
        (lambda: A @ Z, ValueError, r"numpy\.matmul: a scalar"),
        (lambda: np.split(X, 2), ValueError, r"equal division"),
        (lambda: X[:0].mean(), ValueError, r"numpy\.mean"),
        (lambda: X.astype(float), AttributeError, "astype"),
    ],
)
def test_other_errors_are_those_of_arrays(call, error, message):
    with pytest.raises(error, match=message):
        call()
