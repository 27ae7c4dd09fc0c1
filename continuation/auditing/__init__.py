"""A traced path examined afterwards with its homotopy: a retrace, points between its own, its length."""

from continuation.auditing.length import arclength
from continuation.auditing.retrace import Audit, audit, refine

__all__ = ["Audit", "arclength", "audit", "refine"]
