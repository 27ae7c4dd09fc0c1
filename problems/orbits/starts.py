"""First orbits, from Hopf points or simulations."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import eig
from scipy.optimize import brentq

from continuation.arguments.checks import expect
from continuation.arrays import ROOT_OF_ROUND_OFF, Array
from continuation.contraction import HALVING
from continuation.evaluation.products import sizes
from continuation.step.extent import REPLACED
from problems.orbits.arguments import spread
from problems.orbits.field import Field
from problems.orbits.grid import Grid

HOPF_PAIR = 1e-2
"""Largest real part over modulus of a Hopf pair known to few digits."""

LEAST_MOTION = 1e-2
"""Least relative scale: round-off must not measure a component at rest."""

NONLINEAR, RADII_TRIED = 0.1, 60
"""At an orbit's size nonlinear terms are between this part of the linear ones and all of them; the most radii tried."""

ONE_RETURN = 1e-3
"""The last return that misses by at most twice the least miss plus this, in standard deviations, ends a period."""

NO_RETURN = 0.3
"""Simulations whose best return misses by more have not settled."""


MESHES = 4
"""Meshes of a simulation's orbit; more change nothing (van der Pol)."""


def circle_at(field: Field, x: Array, p: float, grid: Grid) -> tuple[Array, Array, float, Array]:
    """First-order orbits about a Hopf point: x + radius Re (q exp(2 pi i t)), where f is nonlinear at radius 1.

    Returns x with exact zeros, Re q exp(2 pi i t) at nodes, period and scale. Raises `ValueError` if no pair of
    eigenvalues is near the imaginary axis.
    """
    matrix = field.derivatives(x[:, None], p)[0][0]
    off = _newton(matrix, field, x, p)
    while (rest := (x != 0.0) & (off > REPLACED * np.abs(x))).any():
        zeroed = np.where(rest, 0.0, x)
        there = field.derivatives(zeroed[:, None], p)[0][0]
        left = _newton(there, field, zeroed, p)
        # Least squares know a step to the round-off of its largest component.
        if not (left <= np.maximum(off, np.finfo(float).eps * off.max())).all():
            break
        x, matrix, off = zeroed, there, left
    values, dual, right = eig(matrix, left=True)
    off = np.where(values.imag > 0.0, np.abs(values.real) / np.maximum(np.abs(values), np.finfo(float).tiny), np.inf)
    k = int(np.argmin(off))
    if not off[k] <= HOPF_PAIR:
        found = f"{values[k]:.3g}" if np.isfinite(off[k]) else "none that is not real"
        raise ValueError(f"point: expected a pair of eigenvalues of f_x on the imaginary axis, found {found}")
    q, size = right[:, k], sizes(x)
    q = q / np.abs(q / size).max()
    turned = np.exp(2j * np.pi * grid.nodes)
    rate = dual[:, k].conj() / (np.vdot(dual[:, k], q) * abs(values[k]))

    def bent(r: float) -> Array:
        """Nonlinear part of f at that radius, in radii."""
        way = (q[:, None] * turned).real
        found: Array = (field(x[:, None] + r * way, p) - field(x[:, None], p)) / r - matrix @ way
        return found

    r = _nonlinear_at(1.0, lambda r: float(np.abs(rate @ bent(r)).max()))
    # Components at rest follow those that oscillate.
    follow = r * np.abs(np.linalg.lstsq(matrix, bent(r), rcond=None)[0]).max(axis=1)
    q, still = r * q, np.where(x != 0.0, LEAST_MOTION * size, follow)
    scale = np.maximum(np.abs(q), np.where(still > 0.0, still, LEAST_MOTION * size))
    return x, (q * turned[:, None]).real, float(2.0 * np.pi / values[k].imag), scale


def _nonlinear_at(guess: float, share_of: Callable[[float], float]) -> float:
    """The radius at which the nonlinear `share_of` f is between NONLINEAR and 1; the guess if f is linear."""
    r = guess
    with np.errstate(all="ignore"):
        for _ in range(RADII_TRIED):
            share = share_of(r)
            if NONLINEAR <= share <= 1.0:
                return r
            # Quadratic or cubic terms; outside its domain f is nonlinear enough.
            r *= 1.0 / min(max(np.sqrt(share / np.sqrt(NONLINEAR)), 0.1), 10.0) if share < np.inf else 0.1
    return guess


def units_at_rest(field: Field, states: Array, p: float, period: float, scale: Array, rest: Array) -> Array:
    """`scale` with units for components at `rest`: motions that change others, or themselves, in one period."""
    x = states.T
    by_x = field.derivatives(x, p)[0]

    def share_of(i: int, r: float) -> float:
        moved = x.copy()
        moved[i] += r
        bent = np.abs(field(moved, p) - field(x, p) - r * by_x[:, :, i].T).max(axis=1)
        sizes = np.where(rest, np.inf, scale)
        sizes[i] = r
        return period * float((bent / sizes).max())

    units = scale.copy()
    for i in np.flatnonzero(rest).tolist():
        units[i] = _nonlinear_at(float(scale[i]), partial(share_of, i))
    return units


def _newton(matrix: Array, field: Field, x: Array, p: float) -> Array:
    """Sizes of the components of Newton's step from an approximate equilibrium."""
    found: Array = np.abs(np.linalg.lstsq(matrix, field(x[:, None], p)[:, 0], rcond=None)[0])
    return found


def explained(field: Field, t: Array, x: Array, p: float) -> Array:
    """The simulation x with a constant for components whose changes are round-off.

    They are far smaller than others, and f does not explain half of them; nor may it where a spike has few samples.
    """
    slopes, change, mean, size = field(x.T, p).T, np.diff(x, axis=0), x.mean(axis=0), x.std(axis=0)
    left = change - 0.5 * np.diff(t)[:, None] * (slopes[1:] + slopes[:-1])
    noise = np.linalg.norm(left, axis=0) > HALVING * np.linalg.norm(change, axis=0)
    noise &= size < ROOT_OF_ROUND_OFF * size.max()
    return np.where(noise, np.where(np.abs(mean) > size, mean, 0.0), x)


def one_period(field: Field, t: Array, x: Array, p: float, grid: Grid) -> tuple[Array, float, Grid]:
    """A simulation's last period: states at nodes, period and grid.

    The mesh equidistributes the mean of time and arc length.
    """
    spline = CubicHermiteSpline(t, x, field(x.T, p).T)
    end, scale = x[-1], spread(x)
    normal = field(x[-1:].T, p)[:, 0] / scale**2

    def ahead(time: float) -> float:
        return float((spline(time) - end) @ normal)

    g = (x - end) @ normal
    rising = np.flatnonzero((g[:-2] < 0.0) & (g[1:-1] >= 0.0))
    returns = np.array([brentq(ahead, t[k], t[k + 1]) for k in rising])
    # A simulation of one period returns to its beginning.
    for times in (returns, t[:1]):
        missed = np.linalg.norm((spline(times) - end) / scale, axis=-1)
        if missed.min(initial=np.inf) <= NO_RETURN:
            break
    settled = missed.min(initial=np.inf) <= NO_RETURN
    expect(settled, "x", "a simulation that ends on a periodic orbit, once round or more", x)
    begin = float(times[np.flatnonzero(missed <= 2.0 * missed.min() + ONE_RETURN)[-1]])
    T = float(t[-1]) - begin
    fine = np.linspace(0.0, 1.0, 50 * grid.intervals + 1)
    states = spline(begin + T * fine)
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(states / scale, axis=0), axis=1)))
    mesh = np.interp(np.linspace(0.0, 1.0, grid.intervals + 1), 0.5 * (fine + way / way[-1]), fine)
    mesh[0], mesh[-1] = 0.0, 1.0
    made = Grid(mesh, grid.degree)
    return spline(begin + T * made.nodes) - made.nodes[:, None] * (states[-1] - states[0]), T, made
