"""One time step of rigid bodies in the plane with friction, as an LCP."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from continuation.arrays import Array
from problems.scenes.scene import Unknown

Body = tuple[float, float, float, float]
"""Mass, moment of inertia, place."""

Contact = tuple[int, int, float, float, float, float]
"""Body, other body (-1 for ground), place, normal towards the first body."""


def time_step(bodies: Sequence[Body], contacts: Sequence[Contact], friction: float) -> tuple[Array, Array, Array]:
    """Stewart and Trinkle's LCP matrix with Coulomb friction, J, and inverse masses.

    The unknowns are all normal impulses, tangential impulses right and left, and slip velocities. The matrix is
    copositive, so Lemke's method always finds a solution. J gives alternating normal and tangential velocities.

    References
    ----------
    Stewart and Trinkle, Int. J. Numer. Methods Eng. 39 (1996); Anitescu and Potra, Nonlinear Dynamics 14 (1997).
    """
    inverse = np.concatenate([[1.0 / m, 1.0 / m, 1.0 / i] for m, i, _, _ in bodies])
    J = np.zeros((2 * len(contacts), inverse.size))
    for c, (a, b, px, py, nx, ny) in enumerate(contacts):
        for body, sign in ((a, 1.0), (b, -1.0)):
            if body >= 0:
                dx, dy = px - bodies[body][2], py - bodies[body][3]
                part = slice(3 * body, 3 * body + 3)
                J[2 * c, part] += sign * np.array([nx, ny, dx * ny - dy * nx])
                J[2 * c + 1, part] += sign * np.array([ny, -nx, -dx * nx - dy * ny])
    W, one = (J * inverse) @ J.T, np.eye(len(contacts))
    NN, NT, TN, TT = W[::2, ::2], W[::2, 1::2], W[1::2, ::2], W[1::2, 1::2]
    zero = 0.0 * one
    A = np.block([[NN, NT, -NT, zero], [TN, TT, -TT, one], [-TN, -TT, TT, one], [friction * one, -one, -one, zero]])
    return A, J, inverse


def free_motion(u: Array) -> Array:
    """The LCP's q from impulse-free velocities, alternating normal and tangential."""
    return np.concatenate([u[::2], u[1::2], -u[1::2], np.zeros(u.size // 2)])


def impulses(x: Array) -> Array:
    """Alternating normal and tangential impulses of a solution, shape (2 c,)."""
    c = x.size // 4
    return np.stack([x[:c], x[c : 2 * c] - x[2 * c : 3 * c]], axis=1).ravel()


def contact_unknowns(contacts: int) -> tuple[Unknown, ...]:
    """Unknowns of a time step."""
    return (
        Unknown("normal impulses", contacts, "what keeps bodies apart"),
        Unknown("tangential impulses", 2 * contacts, "friction, one for each of the two directions of an edge"),
        Unknown("slip velocities", contacts, "whether a contact slides, where friction is at its limit"),
    )
