"""
What an orbit costs: collocation, a boundary value solver, shooting
===================================================================

Left, the normal form of a Hopf point, whose orbits are circles: N intervals with polynomials of degree m. Between the
mesh points the error falls with the order m + 1, at these (dashed) with the order 2 m.

Right, the period of van der Pol's oscillator at mu = 1, 6.663286859323131, to more and more digits, each method from
the same rough simulation. For one stable orbit of two unknowns ``scipy.integrate.solve_bvp`` is quickest: collocation
finds a mesh four times first. Shooting by ``DOP853`` and Newton's method on the return loses orbits that are unstable.
Times are those of one machine.
"""

import time

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import fsolve

from problems.orbits import PeriodicOrbit
from problems.orbits.models import normal_form, van_der_pol

TRUE = 6.663286859323131
rough = solve_ivp(lambda t, x: van_der_pol(x, 1.0), (0.0, 40.0), [2.0, 0.0], rtol=1e-4, atol=1e-4, max_step=0.1)


def collocation(intervals, degree):
    return PeriodicOrbit.from_solution(van_der_pol, rough.t, rough.y.T, 1.0, intervals=intervals, degree=degree).period


def boundary_value_solver(tolerance):
    t = rough.t[rough.t > rough.t[-1] - TRUE]
    s = np.linspace(0.0, 1.0, 50)
    guess = np.stack([np.interp(s, (t - t[0]) / TRUE, y[-t.size :]) for y in rough.y])
    found = solve_bvp(
        lambda s, x, p: p[0] * van_der_pol(x, 1.0),
        lambda a, b, p: np.array([*(a - b), a[1] - guess[1, 0]]),
        s, guess, p=[TRUE + 0.01], tol=tolerance, max_nodes=100000,
    )  # fmt: skip
    return found.p[0]


def shooting(tolerance):
    begin, fixed = rough.y[:, -1], rough.y[1, -1]

    def missed(u):
        x = np.array([u[0], fixed])
        end = solve_ivp(
            lambda t, x: van_der_pol(x, 1.0), (0.0, u[1]), x, method="DOP853", rtol=tolerance, atol=tolerance
        ).y[:, -1]
        return end - x

    return fsolve(missed, [begin[0], TRUE + 0.01], xtol=tolerance)[1]


LADDERS = {
    "collocation, m = 2": [(collocation, (N, 2)) for N in (10, 20, 40, 80)],
    "collocation, m = 4": [(collocation, (N, 4)) for N in (8, 12, 20, 40, 80)],
    "collocation, m = 6": [(collocation, (N, 6)) for N in (6, 9, 13, 20)],
    "solve_bvp": [(boundary_value_solver, (tolerance,)) for tolerance in (1e-3, 1e-5, 1e-7, 1e-9)],
    "shooting, DOP853": [(shooting, (tolerance,)) for tolerance in (1e-5, 1e-7, 1e-9, 1e-11)],
}
figure, (orders, axes) = plt.subplots(1, 2, figsize=(10.5, 4.2), layout="constrained")
COUNTS = (4, 6, 8, 12, 16, 24)
for degree, colour in ((2, "C0"), (3, "C1"), (4, "C2")):
    between, at_mesh = [], []
    for count in COUNTS:
        orbit = PeriodicOrbit.from_hopf(normal_form, ([0.0, 0.0], 0.0), radius=0.4, intervals=count, degree=degree)
        y, p = orbit.start()
        # As complex numbers: a circle of known radius, turned round from the direction in which it begins.
        first = orbit.at(y, [0.0]) @ [1.0, 1j]
        first *= np.sqrt(0.5 - np.sqrt(0.25 + p)) / abs(first)
        for times, errors in ((np.linspace(0.0, 1.0, 2001), between), (orbit.mesh, at_mesh)):
            errors.append(np.abs(orbit.at(y, times) @ [1.0, 1j] - first * np.exp(2j * np.pi * times)).max())
    orders.loglog(COUNTS, between, "o-", color=colour, label=f"m = {degree}")
    orders.loglog(COUNTS, at_mesh, "o--", color=colour)
    slopes = [np.log(errors[0] / errors[-1]) / np.log(COUNTS[-1] / COUNTS[0]) for errors in (between, at_mesh)]
    print(f"m = {degree}: order {slopes[0]:.1f} between the mesh points, {slopes[1]:.1f} at them")
orders.set(xlabel="intervals", ylabel="error of the orbit")
orders.legend(frameon=False, fontsize="small")

# What each digit of the period takes; in one block with the other, since both are parts of one figure.
for (name, ladder), marker in zip(LADDERS.items(), "os^Dv"):
    errors, seconds = [], []
    for method, arguments in ladder:
        begin = time.perf_counter()
        errors.append(max(abs(method(*arguments) - TRUE), 1e-15))
        seconds.append(time.perf_counter() - begin)
    axes.loglog(errors, seconds, marker=marker, label=name)
    print(f"{name:18}", "  ".join(f"{error:.0e}" for error in errors))
axes.invert_xaxis()
axes.set(xlabel="error of the period", ylabel="seconds")
axes.legend(frameon=False, fontsize="small")
