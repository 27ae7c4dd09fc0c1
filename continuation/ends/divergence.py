"""Whether a path runs off to infinity."""

from __future__ import annotations

from continuation.arrays import Array, largest

DECADES = 3
"""Decades of growth without progress of the parameter after which a path counts as divergent."""

DECADE, FAR, STILL = 10.0, 1e3, 1e-3
"""The growth between two marks; the least growth beyond the start, that of DECADES; and the parameter's progress from
mark to mark, relative to max(1, |lam|), that is none: for y ~ 1 / (lam* - lam) it falls tenfold with each decade."""

HORIZON = 1e12
"""Growth of y, relative to its start, at which a path counts as divergent."""


def divergence(
    divergence_monitor: tuple[float, float, float], u: Array, start_norm: float
) -> tuple[tuple[float, float, float], bool]:
    """Follow the growth of y by decades: (norm at the last mark, parameter there, decades stalled), and the verdict.

    A path diverges when y has grown by three decades in a row, beyond a thousand times its start, while the parameter
    moved by less than a thousandth in each, or when it is beyond the horizon, whatever the parameter does.
    """
    mark, lam, stalled = divergence_monitor
    size = largest(u[:-1])
    if mark == 0.0:
        return (max(size, 1.0), float(u[-1]), 0.0), False
    if size < DECADE * mark:
        return divergence_monitor, False
    still = abs(float(u[-1]) - lam) <= STILL * max(1.0, abs(float(u[-1])))
    stalled = stalled + 1.0 if still else 0.0
    far = size > FAR * (1.0 + start_norm)
    return (size, float(u[-1]), stalled), (stalled >= DECADES and far) or size > HORIZON * (1.0 + start_norm)
