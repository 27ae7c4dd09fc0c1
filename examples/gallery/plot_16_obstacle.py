"""
Under an obstacle: a fold that becomes a kink
=============================================

Bratu's problem once more, with a lid on it: :math:`u'' + \\lambda e^u = 0` where :math:`u < \\psi`, and :math:`u \\le
\\psi` everywhere. The map is piecewise smooth, and the path has kinks: one wherever another node comes to rest on the
lid. Turning points are circles, kinks are diamonds.
"""

import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import KINK, TURN
from problems.nonlinear import bratu_under_obstacle

psi, n = 2.0, 39
homotopy = bratu_under_obstacle(n, psi, target=8.0)
path = continuation.trace(homotopy)
for event in path.events[:3]:
    print(f"{event.name} at lambda = {event.lam:.6f}, switches {event.switches}")

# %%
# The path comes back from its fold until the middle touches the lid. There it turns again, in a kink, since a held
# middle can bear more load. In the limit of a fine mesh that is at :math:`\lambda_c = 8 e^{-\psi} \mathrm{arcosh}^2
# e^{\psi/2}`.

exact = 8 * np.exp(-psi) * np.arccosh(np.exp(psi / 2)) ** 2
print(f"turning kink at {path.kinks[0].lam:.6f}, exact {exact:.6f}")

figure, left = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
u = np.array([path(s) for s in np.linspace(0, path.arclength[-1], 400)])
left.plot(u[:, -1], np.trapezoid(homotopy.x(u[:, :-1]), axis=1) / (n + 1), color="#0072B2")
for events, mark, name in ((path.turning_points, TURN, "fold"), (path.kinks, KINK, "kinks")):
    height = [homotopy.x(event.y).sum() / (n + 1) for event in events]
    left.plot([event.lam for event in events], height, label=name, **mark)
left.set(xlabel=r"$\lambda$", ylabel=r"$\int u$")
left.legend(frameon=False)

# %%
# The solutions at the fold, at the turning kink, and at the end, where a good part rests on the lid.

figure, right = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
x = np.linspace(0, 1, n + 2)
for name, event, style in (
    ("at the fold", path.turning_points[0], ":"),
    ("at the turning kink", path.kinks[0], "--"),
    ("at the end", path.endpoint, "-"),
):
    label = rf"{name}, $\lambda$ = {event.lam:.3f}"
    right.plot(x, np.pad(homotopy.x(event.y), 1), style, color="#D55E00", label=label)
right.axhline(psi, color="0.6", linewidth=0.8)
right.set(xlabel="$x$", ylabel="$u$")
right.legend(frameon=False, fontsize="small", loc="lower center")
