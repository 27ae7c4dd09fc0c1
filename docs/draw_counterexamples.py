"""The pictures of docs/the_paper_measured.md: stationary ends of the KKT path, and why they are no solutions."""

import numpy as np
from matplotlib.figure import Figure

from continuation import trace
from problems.lcp import LCP, KKTHomotopy
from problems.paper import COUNTEREXAMPLES

PATH, START, END = "#1f5fa8", "#444444", "#c2410c"
HILL = LCP([[-1]], [2])
OFFSETS = (0.2, 0.05, 1e-2, 1e-3)


def kkt_path(problem, x0):
    """From the paper's start, z1 = z2 = e."""
    return trace(KKTHomotopy(problem, x0))


def dense(path, points=400):
    """The path at equidistant arclengths, shape (points, 3n + 1)."""
    return path(np.linspace(0.0, path.arclength[-1], points))


def draw_plane(counterexample, extent, corner):
    """Left: the feasible set with the level lines of x'w, the path and its end. Right: x and w against lambda."""
    problem = counterexample.problem
    path = kkt_path(problem, counterexample.x0)
    points = dense(path)
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    plane, course = figure.subplots(1, 2)
    _objective(problem, extent, plane)
    plane.plot(points[:, 0], points[:, 1], color=PATH, lw=2, label="KKT path")
    plane.plot(*counterexample.x0, "o", color=START, label="start, $\\lambda=1$")
    end = path.endpoint.y[:2]
    plane.plot(*end, "*", ms=14, color=END, clip_on=False, zorder=5, label="end, $\\lambda=0$: $x'w > 0$")
    plane.set(xlabel="$x_1$", ylabel="$x_2$", xlim=extent[:2], ylim=extent[2:])
    plane.set_title("$x'w$ where $x \\geq 0$, $w \\geq 0$")
    plane.legend(loc=corner, fontsize="small", framealpha=1.0)
    lam = points[:, -1]
    w = points[:, :2] @ problem.A.T + problem.q
    for i, dashes in enumerate(("-", "--")):
        course.plot(lam, points[:, i], dashes, color=PATH, label=f"$x_{i + 1}$")
        course.plot(lam, w[:, i], dashes, color=END, label=f"$w_{i + 1}$")
    pair = int(np.argmax(np.minimum(end, problem.w(end))))
    course.set(xlim=(1.02, -0.02), ylim=(-0.1, None), xlabel="$\\lambda$")
    course.set_title(f"$x_{pair + 1}$ and $w_{pair + 1}$ both stay positive")
    course.legend(ncols=2, fontsize="small")
    return figure


def _objective(problem, extent, axes):
    """Level lines of x'w over the feasible set, the rest grey."""
    x1, x2 = np.meshgrid(np.linspace(*extent[:2], 300), np.linspace(*extent[2:], 300))
    x = np.stack([x1, x2], axis=-1)
    w = x @ problem.A.T + problem.q
    value = (x * w).sum(axis=-1)
    feasible = (np.minimum(x, w) >= 0).all(axis=-1)
    axes.contourf(x1, x2, np.where(feasible, np.nan, 1.0), levels=[0.5, 1.5], colors=["#e5e7eb"])
    inside = np.ma.masked_where(~feasible, value)
    axes.clabel(axes.contour(x1, x2, inside, levels=8, colors="#9ca3af", linewidths=0.8), fontsize=7)


def draw_order_one():
    """Left: the objective x (2 - x) of LCP(2, -1). Right: the paths from x0 = 1 and beside it, a pitchfork."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    objective, fork = figure.subplots(1, 2)
    x = np.linspace(0, 2, 200)
    objective.plot(x, x * (2 - x), color="#9ca3af")
    objective.plot([0, 2], [0, 0], "o", color=PATH, ms=8, clip_on=False, label="solutions")
    objective.plot([1], [1], "*", color=END, ms=14, label="stationary: the end from $x_0=1$")
    objective.set(xlabel="$x$", ylabel="$x w = x(2-x)$", ylim=(0, 1.25), title="A = (-1), q = 2")
    objective.legend(fontsize="small")
    for offset in OFFSETS:
        for side in (1, -1):
            points = dense(kkt_path(HILL, [1 + side * offset]))
            fork.plot(points[:, -1], points[:, 0], color=PATH, lw=1.2)
    fork.get_lines()[0].set_label("$x_0 = 1 \\pm$ " + ", ".join(f"{value:g}" for value in OFFSETS))
    middle = kkt_path(HILL, [1.0])
    fork.plot(middle.lam, middle.y[:, 0], color=END, lw=2, label="$x_0 = 1$")
    (branch,) = middle.events
    fork.plot(branch.lam, branch.y[0], "s", color=END, label="branch point, $\\lambda = 1/2$")
    fork.plot(0, 1, "*", color=END, ms=14, clip_on=False)
    fork.set(xlim=(1.02, -0.02), ylim=(-0.1, 2.8), xlabel="$\\lambda$", ylabel="$x$", title="the KKT paths")
    fork.legend(loc="upper left", fontsize="small")
    return figure


def figures():
    """By file name."""
    return {
        "counterexample_p0": draw_plane(COUNTEREXAMPLES[0], (0.0, 2.5, 0.6, 2.6), "upper right"),
        "counterexample_nondegenerate": draw_plane(COUNTEREXAMPLES[1], (1.5, 4.5, 0.0, 1.6), "upper left"),
        "counterexample_order_one": draw_order_one(),
    }
