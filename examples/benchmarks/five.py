"""One model five times: in numpy with its Jacobian, in JAX, CasADi and SymPy, and as a residual alone.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/five.py [WAY ...] [--rounds 5] [--points 64]

The Brusselator with diffusion, 2 x 64 unknowns, and a network of three layers at rest. Processor seconds a path, the
least of several rounds; "made": the time to make the homotopy, compilation included. Missing libraries are left out.
"""

from functools import partial
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import scipy.sparse as sp
from campaign import Campaign, asked, timed

import continuation

A, DX, DY, ENDS = 2.0, 0.008, 0.004, 1.2


def brusselator(n):
    """x' = DX x'' + A - (B + 1) x + x^2 y, y' = DY y'' + B x - x^2 y, x = ENDS A, y = B / A at the ends; B from 4."""
    h2 = (1.0 / (n + 1)) ** 2
    L = sp.csc_array(sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(n, n)) / h2)
    start, target = (np.repeat([A, 4.0 / A], n), 4.0), 6.2

    def residual(np, y, lam):
        x, z = y[:n], y[n:]
        made, zero = x * x * z, 0.0 * x[:1]
        bent = []
        for w, end in ((x, ENDS * A), (z, lam / A)):
            whole = np.concatenate((zero + end, w, zero + end))
            bent.append((whole[:-2] - 2.0 * w + whole[2:]) / h2)
        return np.concatenate((DX * bent[0] + A - (lam + 1.0) * x + made, DY * bent[1] + lam * x - made))

    def jacobian(y, lam):
        x, z = y[:n], y[n:]
        parts = [[2.0 * x * z - lam - 1.0, x * x], [lam - 2.0 * x * z, -x * x]]
        blocks = [[sp.diags_array(part) for part in row] for row in parts]
        blocks[0][0], blocks[1][1] = blocks[0][0] + DX * L, blocks[1][1] + DY * L
        return sp.csc_array(sp.block_array(blocks)), np.concatenate((-x, x + DY / A * (-L @ np.ones(n))))

    return residual, jacobian, start, target


def network(n, seed=13):
    """y = W3 tanh(W2 tanh(W1 y + lam b)): a network of three layers at rest, from no input to a strong one."""
    random = np.random.default_rng(seed)
    W1, W2, W3 = (2.5 * random.standard_normal((n, n)) / np.sqrt(n) for _ in range(3))
    b = random.standard_normal(n)

    def residual(np, y, lam):
        return y - np.matmul(W3, np.tanh(np.matmul(W2, np.tanh(np.matmul(W1, y) + lam * b))))

    def jacobian(y, lam):
        one = np.tanh(W1 @ y + lam * b)
        two = np.tanh(W2 @ one)
        inner = (W3 * (1.0 - two**2)) @ (W2 * (1.0 - one**2))
        return np.eye(n) - inner @ W1, -inner @ b

    return residual, jacobian, (np.zeros(n), 0.0), 4.0


def ways(model):
    """By name: how to make the homotopy."""
    residual, jacobian, start, target = model

    def in_numpy(y, lam):
        return residual(np, y, lam)

    def by_jax(kind):
        import jax

        jax.config.update("jax_enable_x64", True)
        return continuation.from_jax(lambda y, lam: residual(jax.numpy, y, lam), start, target=target, jacobian=kind)

    def by_casadi():
        import casadi as ca

        y, lam = ca.SX.sym("y", start[0].size), ca.SX.sym("lam")
        written = SimpleNamespace(concatenate=lambda parts: ca.vertcat(*parts), tanh=ca.tanh, matmul=ca.mtimes)
        return continuation.from_casadi(ca.Function("H", [y, lam], [residual(written, y, lam)]), start, target=target)

    def by_sympy():
        import sympy

        y, lam = sympy.symbols(f"y:{start[0].size}"), sympy.Symbol("lam")
        written = SimpleNamespace(concatenate=np.concatenate, matmul=np.matmul, tanh=np.vectorize(sympy.tanh, "O"))
        return continuation.from_sympy(list(residual(written, np.array(y), lam)), y, lam, start, target=target)

    made = {
        "numpy": lambda: continuation.from_functions(in_numpy, jacobian, start=start, target=target),
        "jax": lambda: by_jax("dense"), "jax sparse": lambda: by_jax("sparse"),
        "casadi": by_casadi, "sympy": by_sympy,
        "residual only": lambda: continuation.from_functions(in_numpy, start=start, target=target),
    }  # fmt: skip
    return {name: make for name, make in made.items() if name.split()[0] == "residual" or find_spec(name.split()[0])}


def judge(made, way, rounds):
    """The path of one of the homotopies in words, with the seconds to make it; the milliseconds of the path."""
    preset, name = way
    homotopy, making = timed(made[name])
    work = partial(continuation.trace, homotopy, preset=preset)
    _, first = timed(work)
    path, least = timed(work, rounds)
    return f"{path.status.name}, made in {making + first - least:.2f} s, {len(path.turning_points)} folds; " \
           f"{path.counts}", 1e3 * least  # fmt: skip


if __name__ == "__main__":
    names, _, options = asked(rounds=5, points=64)
    models = {"Brusselator": brusselator(options.points), "network": network(4)}
    presets = {preset.name: preset for preset in (continuation.FAST, continuation.SERIES)}
    Campaign(
        {title: lambda number, seed, model=model: [ways(model)] for title, model in models.items()},
        lambda made, way: judge(made, way, options.rounds),
        {f"{title} {name}": (preset, name) for title, preset in presets.items() for name in names or ways(network(4))},
        "ms",
    ).run(1)
