"""Checks, labels and plug-ins."""
