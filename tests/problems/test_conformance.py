"""Every plug-in of ours, and every other homotopy of `problems`, passes the whole conformance suite."""

from functools import partial
from itertools import cycle

import numpy as np
import pytest
import scipy.sparse as sp
from attrs import evolve

from continuation import from_functions
from continuation.arguments.plugins import available, find
from continuation.testing import check_homotopy
from problems import lcp, scenes
from problems.bifurcation import (
    Aircraft,
    Bratu1D,
    Bratu2D,
    Circle,
    Cusp,
    ExponentialCosine,
    FreudensteinRoth,
    Pitchfork,
)
from problems.lcp import LCP, MixedLCP
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.nonlinear import (
    InteriorHomotopy,
    MixedComplementarity,
    NormalMap,
    bratu_under_obstacle,
    brown,
    fixed_point,
    newton,
)
from problems.scenes.scene import conditions

from .lcp.mixed.util import EVERY_KIND
from .scenes.util import small
from .util import BOUNDED, BOX, FORMS, chain, cubic, cubic_slope, exponential, kojima_shindo

SMALL = {
    "aircraft": {}, "bratu-1d": {"n": 8}, "bratu-2d": {"m": 4}, "brown-fixed-point": {"n": 4}, "circle": {}, "cusp": {},
    "exponential-cosine": {"n": 3}, "freudenstein-roth": {}, "kkt": {}, "kmm": {},
    "periodic-orbit": {"intervals": 6, "radius": 0.3}, "pitchfork": {}, "wang": {}, "xu": {}, "yu": {}, "zhao": {},
}  # fmt: skip
"""All that is registered, at a size at which its matrices may be dense."""


START, Q = np.full(6, 0.1), np.array([-1.0, 2.0, -0.5, 1.0, -2.0, 0.3])
SCATTERED = 0.2 * sp.random_array((24, 24), density=0.2, rng=np.random.default_rng(6)) + sp.eye_array(24)
"""Not banded, with a dominant diagonal."""
KEPT = {name: form(chain(6)) for name, form in FORMS.items()}
TWO_SIDES = lcp.from_qp(np.diag([2.0, 1.0]), [-3.0, 1.0], [[1.0, 2.0]], [1.0], rows_lower=-1, lower=0).problem
EITHER = (EVERY_KIND, evolve(EVERY_KIND, A=sp.csr_array(EVERY_KIND.A)))
"""Dense and sparse."""


def circle(y, lam):
    return y**2 + lam**2 - 1.0


def loaded(x, lam):
    """Plain numpy, for jets."""
    return x**3 + x - lam * np.array([1.0, 2.0]) + 0.5


MADE = {
    **{name: partial(find(name), **options) for name, options in SMALL.items()},
    **{f"one unknown: {kind.__name__}": partial(kind, 1) for kind in (Bratu1D, Bratu2D, ExponentialCosine)},
    "a pitchfork with an imperfection": partial(Pitchfork, 0.1),
    "a cusp without folds": partial(Cusp, -1.0),
    "newton": partial(newton, brown(3), np.full(3, 0.8), brown(3).jacobian),
    "newton without a derivative": partial(newton, brown(3), np.full(3, 0.8)),
    **{
        f"{make.__name__}, {form}": partial(make, cubic, START, lambda x, form=form: cubic_slope(form, x))
        for make in (fixed_point, newton) for form in FORMS
    },
    # The matrix is one and the same each time: blending leaves it alone.
    **{
        f"{make.__name__}, {name}, kept": partial(
            make, lambda x: chain(x.size) @ x - 1.0, START, lambda x, name=name: KEPT[name]
        )
        for make in (fixed_point, newton) for name in FORMS
    },
    "kkt, off the feasible set": partial(lcp.KKTHomotopy, LCP(chain(6).toarray(), Q), x0=START),
    "kkt, not refined": partial(lcp.KKTHomotopy, LCP(chain(6).toarray(), Q), refine=False),
    "kkt, banded": partial(lcp.KKTHomotopy, LCP(chain(6), Q)),
    "kkt, sparse": partial(lcp.KKTHomotopy, LCP(sp.csr_array(SCATTERED), np.resize(Q, 24))),
    "kkt, a degenerate end": partial(find("kkt"), example=7),
    "kkt, two turning points": partial(find("kkt"), example=10),
    "wang, sparse": partial(lcp.WangHomotopy, LCP(chain(6), Q)),
    "wang, a row of two sides": partial(HOMOTOPIES["wang"].make, TWO_SIDES, None),
    **{
        f"{name}, bounds": partial(HOMOTOPIES[name].from_x0, problem, None, lcp.Structure(problem))
        for name, problem in zip(BOUNDED, cycle(EITHER))
    },
    "interior points, bounds": partial(InteriorHomotopy, MixedComplementarity(exponential, **BOX)),
    "interior points": partial(InteriorHomotopy, MixedComplementarity(kojima_shindo, lower=np.zeros(4))),
    "an obstacle": partial(bratu_under_obstacle, 9, 2.0, target=6.0),
    **{
        f"a normal map, {name}": partial(
            NormalMap.affine, form(chain(6)), np.ones(6), np.linspace(-2.0, -3.0, 6), x0=np.zeros(6), lam0=0.0,
            upper=0.7, target=1.0,
        ) for name, form in FORMS.items()
    },
    "a normal map without a derivative": partial(NormalMap, loaded, x0=np.zeros(2), lam0=0.0, target=1.0),
    **{
        f"scene: {name}": small(name).problem
        for name in scenes.available() if not isinstance(conditions(scenes.make(name).problem()), MixedLCP)
    },
    "functions": partial(from_functions, circle, start=([1.0], 0.0), target=None),
    "functions, derivative": partial(
        from_functions, lambda y, lam: y - lam * np.cos(y),
        lambda y, lam: (np.diag(1.0 + lam * np.sin(y)), -np.cos(y)), start=([0.0, 0.0], 0.0), target=1.0,
    ),
}  # fmt: skip
UNNAMED = {"picklable": "a lambda has no name to be imported by"}
FAILING = {
    "functions, derivative": UNNAMED,
    **{
        f"{make.__name__}, {form}{kept}": UNNAMED
        for make in (fixed_point, newton)
        for form in FORMS
        for kept in ("", ", kept")
    },
}


def test_every_plugin_of_ours_is_examined():
    ours = {name for name, plugin in available().items() if plugin.origin.startswith("pseudoarclength ")}
    assert ours == set(SMALL)


@pytest.mark.parametrize("name", MADE)
def test_it_passes_every_check(name):
    check_homotopy(MADE[name](), expected_failed_checks=FAILING.get(name))


WILD = (
    *(family(n) for n in (1, 6) for family in (Bratu1D, Bratu2D, ExponentialCosine)),
    Circle(), Cusp(), Cusp(splitting=-0.7), Pitchfork(), Pitchfork(imperfection=0.1), Pitchfork(imperfection=-2.0),
    FreudensteinRoth(), Aircraft(), Aircraft(elevator=-0.05),
    *(make(brown(4), np.zeros(4), brown(4).jacobian) for make in (fixed_point, newton)),
)  # fmt: skip


@pytest.mark.parametrize("homotopy", WILD, ids=repr)
@pytest.mark.parametrize("size", [1e3, 1e200, 1e300, np.inf, np.nan])
def test_wild_iterates_make_no_noise(homotopy, size):
    # Warnings are errors in this suite. Cosines alone do not overflow.
    y = np.full(homotopy.start()[0].shape, size)
    for lam in (0.0, 0.5, 1.0, size):
        found = homotopy.residual(y, lam)
        assert found.shape == y.shape
        assert not np.isfinite(found).all() or size == 1e3 or isinstance(homotopy, ExponentialCosine)
        homotopy.jacobian(y, lam)
