"""Counted evaluations of a homotopy."""
