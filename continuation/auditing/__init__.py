"""Retraces and refined points of a path."""

from continuation.auditing.retrace import Audit, audit, refine

__all__ = ["Audit", "audit", "refine"]
