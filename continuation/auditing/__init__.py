"""Checks of a traced path with its homotopy: retrace, refined points, length."""

from continuation.auditing.length import arclength
from continuation.auditing.retrace import Audit, audit, refine

__all__ = ["Audit", "arclength", "audit", "refine"]
