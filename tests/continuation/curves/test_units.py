"""The same answers in other units, drawn over twelve orders: y -> D y + c, H -> D H, lam -> lam / a, mu -> mu / m."""

from functools import partial

import numpy as np
import pytest
import scipy.sparse as sp

import continuation
from continuation import Curve, Kind, from_functions

from .util import (
    coupled,
    cusp_form,
    first_fold,
    gelfand,
    imperfect,
    named,
    takens_bogdanov,
    van_der_pol,
)

TIGHT = {"tolerance": 1e-12}


class Units:
    """A family in other units; the equations are scaled as y is, so that eigenvalues are what they were."""

    parameter_name = "mu"

    def __init__(self, family, value, seed, shifted=True):
        generator, n = np.random.default_rng(seed), np.size(family(value).start()[0])
        self.family = family
        self.d = 10.0 ** generator.uniform(-6, 6, n)
        self.c = self.d * generator.uniform(-3, 3, n) * shifted
        self.a, self.m = 10.0 ** generator.uniform(-6, 6, 2)
        self.value = value / self.m

    def __call__(self, mu):
        own = self.family(mu * self.m)

        def derivative(y, lam):
            H_y, H_lam = own.jacobian((y - self.c) / self.d, lam * self.a)
            return sp.csc_array(sp.diags_array(self.d) @ H_y @ sp.diags_array(1.0 / self.d)), self.d * H_lam * self.a

        return from_functions(
            lambda y, lam: self.d * own.residual((y - self.c) / self.d, lam * self.a),
            derivative if getattr(own, "jacobian", None) else None,
            start=self.told(*own.start()),
            target=None,
        )

    def told(self, y, lam):
        """A point in these units."""
        return self.d * y + self.c, lam / self.a

    def back(self, u):
        """Rows (y, lam, ..., mu) in the units of the family."""
        n, u = self.d.size, np.atleast_2d(u)
        return np.column_stack([(u[:, :n] - self.c) / self.d, u[:, n] * self.a, u[:, n + 1 : -1], u[:, -1] * self.m])

    def box(self, low, high):
        """Of mu."""
        return {"lam": (None if low is None else low / self.m, None if high is None else high / self.m)}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(("family", "value", "columns"), [(cusp_form, 1.0, (1, 2)), (imperfect, 0.1, (2, 1))])
def test_the_fold_curve_through_a_cusp(seed, family, value, columns):
    units = Units(family, value, seed)
    fold = first_fold(units(units.value), direction=0 if family is cusp_form else -1)
    path = continuation.trace_both(Curve(units, fold), box=units.box(-4.0, 4.0), **TIGHT)
    a, b = units.back(path.u)[:, columns].T
    assert np.abs(27.0 * a**2 - 4.0 * b**3).max() <= 1e-10
    assert a.min() < 0.0 < a.max()
    (cusp,) = named(path, "cusp")
    assert np.abs(units.back(cusp.u)).max() <= 1e-10


def test_the_cusp_and_the_end_of_the_perturbed_gelfand_problem():
    units = Units(gelfand, 0.2, 0, shifted=False)
    curve = Curve(units, first_fold(units(units.value)))
    path = continuation.trace(curve, box=units.box(0.15, None), **TIGHT)
    (cusp,), (turn,) = named(path, "cusp"), path.turning_points
    for event in (cusp, turn):
        ((*_, height, delta, eps),) = units.back(event.u)
        # By Gauss' formula for the time map, in 50 digits.
        assert abs(eps - 0.245780427232365629) <= 1e-11
        assert abs(delta - 1.30737356367320925) <= 1e-11
        assert abs(height - 4.89654789987477872) <= 1e-9
    end = continuation.trace(curve, target=0.0, **TIGHT).endpoint
    assert abs(end.u[-2] * units.a - 0.8784576797812903) <= 1e-11


@pytest.mark.parametrize("seed", [0, 1, 10, 12, 17, 25, 53, 54, 144])
def test_what_stands_still_is_not_measured_by_round_off(seed):
    # All but k and the frequency keep their values, which are no round numbers here.
    units = Units(van_der_pol, 1.0, seed)
    path = continuation.trace(Curve(units, Kind.HOPF, units.told(np.zeros(2), 0.05)), box=units.box(None, 1.5))
    found = units.back(path.u)
    assert np.abs(found[:, :3]).max() <= 1e-10
    assert np.abs(found[:, 3] - np.sqrt(found[:, 4])).max() <= 1e-10
    assert found[-1, 4] == pytest.approx(1.5)


@pytest.mark.parametrize("seed", range(2))
def test_a_fold_curve_meets_a_hopf_curve_once(seed):
    units = Units(takens_bogdanov, 1.0, seed)
    fold = first_fold(units(units.value), target=0.5 / units.a)
    path = continuation.trace(Curve(units, fold), direction=-1, box=units.box(-1.0, None), **TIGHT)
    (point,) = named(path, "Bogdanov-Takens")
    assert np.abs(units.back(point.u)).max() <= 1e-10


@pytest.mark.parametrize(("seed", "sparse"), [(0, False), (1, False), (0, True)])
def test_branch_points_of_a_symmetric_problem(seed, sparse):
    units = Units(partial(coupled, sparse=sparse), 1.0, seed, shifted=False)
    trunk = continuation.trace(units(units.value), direction=-1, box={"lam": (2.5 / units.a, None)})
    (point,) = [event for event in trunk.events if event.kind == Kind.BRANCH_POINT]
    path = continuation.trace(Curve(units, point), box=units.box(None, 5.0), **TIGHT)
    y, _, lam, mu = units.back(path.u).T
    assert np.abs(lam - 3.0 * mu).max() <= 1e-10
    assert np.abs(y**2 - mu).max() <= 1e-10
    assert mu[-1] == pytest.approx(5.0)
    assert len(path) < 10
