r"""
Ten thousand at once, on a device
=================================

An exothermic reaction in a stirred tank, :math:`x' = -x + D (1 - x) e^T`, :math:`T' = -T + 18 D (1 - x) e^T - c T`.
JAX has the residual; one path is traced. Where one machine's paths are not enough, Newton's corrector starts from it
for 10,000 pairs of :math:`D` and :math:`c` together, as one compiled program, on whatever device JAX finds.
"""

import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np

import continuation
from continuation.plot import plot_bifurcation

jax.config.update("jax_enable_x64", True)


def tank(y, damkohler, cooling):
    rate = damkohler * (1.0 - y[0]) * jnp.exp(y[1])
    return jnp.stack([-y[0] + rate, -y[1] + 18.0 * rate - cooling * y[1]])


usual = 2.0
homotopy = continuation.from_jax(lambda y, lam: tank(y, lam, usual), ([0.0, 0.0], 0.0), target=0.2)
path = continuation.trace(homotopy)
folds = [point.lam for point in path.turning_points]
print(path.status.name, f"{len(path)} points, folds at", np.round(folds, 6))

# %%
# The corrector: eight increments of Newton's method, for all pairs together. What did not converge is known by its
# residual, and would be traced by itself.


def newton(y, damkohler, cooling):
    def increment(y, _):
        return y - jnp.linalg.solve(jax.jacfwd(tank)(y, damkohler, cooling), tank(y, damkohler, cooling)), None

    y, _ = jax.lax.scan(increment, y, None, length=8)
    return y, jnp.abs(tank(y, damkohler, cooling)).max()


# The cold branch, up to its fold, is where the path begins: of each D the nearest point of it is the start.
cold = path.arclength <= path.turning_points[0].arclength
D, c = (values.ravel() for values in np.meshgrid(np.linspace(0.0, 0.9 * folds[0], 100), np.linspace(2.0, 3.0, 100)))
nearest = np.abs(path.lam[cold][:, None] - D).argmin(axis=0)
y, left = jax.jit(jax.vmap(newton))(path.y[cold][nearest], D, c)
found = np.asarray(left) < 1e-10
print(f"{found.sum()} of {found.size} pairs, the largest residual of them {np.asarray(left)[found].max():.0e}")

figure, (one, other) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
plot_bifurcation(path, one, value=1)
temperatures = np.where(found, np.asarray(y)[:, 1], np.nan).reshape(100, 100)
mesh = other.pcolormesh(D[:100], c[::100], temperatures)
figure.colorbar(mesh, label="temperature")
other.set(xlabel="D", ylabel="c", title="the cold branch")
