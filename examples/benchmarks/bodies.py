"""Families of `outside.py`: one time step of stacks, arches and piles of rigid bodies in the plane, n = 40 to 520."""

import numpy as np

from continuation.arrays import Array
from problems.lcp import LCP
from problems.scenes.planar import Body, Contact, free_motion, time_step

STEP, GRAVITY = 0.01, 9.81
"""In seconds and m/s^2."""


def moved(bodies: list[Body], contacts: list[Contact], friction: float, start: Array, push: float = 0.0) -> LCP:
    """One step from velocities, under gravity, with a horizontal force on the last body."""
    A, J, inverse = time_step(bodies, contacts, friction)
    force = np.concatenate([[0.0, -GRAVITY * mass, 0.0] for mass, *_ in bodies])
    force[-3] += push
    return LCP(A, free_motion(J @ (start + STEP * inverse * force)))


def stacks(k: int, r: np.random.Generator) -> LCP:
    """Boxes of side 1 on each other, each on two corners; friction 0.3 to 1.2, the uppermost pushed with 0 to 20 N."""
    boxes = (5, 10, 20, 30, 60)[k % 5]
    bodies: list[Body] = [(1.0, 1.0 / 6.0, 0.0, j + 0.5) for j in range(boxes)]
    contacts: list[Contact] = [(j, j - 1, side, float(j), 0.0, 1.0) for j in range(boxes) for side in (-0.5, 0.5)]
    return moved(bodies, contacts, r.uniform(0.3, 1.2), np.zeros(3 * boxes), r.uniform(0.0, 20.0))


def arches(k: int, r: np.random.Generator) -> LCP:
    """A half circle of stones between radius 1 and 1.15 to 1.5, each on two corners of the next."""
    stones = (5, 11, 25, 40, 61)[k % 5]
    angles, width = np.linspace(np.pi, 0.0, stones + 1), np.pi / stones
    friction, outer = r.uniform(0.3, 1.2), r.uniform(1.15, 1.5)
    middle, mass = 0.5 * (1.0 + outer), 0.5 * width * (outer**2 - 1.0)
    inertia = mass * ((outer - 1.0) ** 2 + (middle * width) ** 2) / 12.0
    bodies = [(mass, inertia, middle * np.cos(t), middle * np.sin(t)) for t in 0.5 * (angles[1:] + angles[:-1])]
    contacts: list[Contact] = []
    for j, t in enumerate(angles):
        a, b, side = (j, j - 1, 1.0) if j < stones else (stones - 1, -1, -1.0)
        c, s = np.cos(t), np.sin(t)
        contacts += [(a, b, radius * c, radius * s, side * s, -side * c) for radius in (1.0, outer)]
    return moved(bodies, contacts, friction, np.zeros(3 * stones))


def piles(k: int, r: np.random.Generator) -> LCP:
    """Bodies of random sizes, places and velocities, each on the ground and on one more, at one or two points."""
    count, friction = (5, 10, 20, 30, 40)[k % 5], r.uniform(0.3, 1.2)
    bodies = [(r.uniform(0.5, 2.0), r.uniform(0.05, 0.3), *r.uniform(0.0, 5.0, 2)) for _ in range(count)]
    contacts: list[Contact] = []
    for a, (_, _, x, y) in enumerate(bodies):
        for b in (-1, int(r.integers(count))):
            b = -1 if a == b else b
            low, high = (0.3 * np.pi, 0.7 * np.pi) if b < 0 else (0.0, 2.0 * np.pi)
            angle, reach = r.uniform(low, high), r.uniform(0.2, 0.6)
            for t in (angle, angle + 0.3)[: r.integers(1, 3)]:
                c, s = np.cos(t), np.sin(t)
                contacts.append((a, b, x - reach * c, y - reach * s, c, s))
    return moved(bodies, contacts, friction, r.normal(0.0, 0.3, 3 * count))
