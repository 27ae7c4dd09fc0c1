"""Retraces, refined points and length of a path."""

from continuation.auditing.length import arclength
from continuation.auditing.retrace import Audit, audit, refine

__all__ = ["Audit", "arclength", "audit", "refine"]
