"""Progress on stderr: a bar of tqdm on a terminal where that is installed, else lines."""

from __future__ import annotations

import sys
import time
from typing import Any, TextIO

from continuation.path import LocatedEvent, Step
from continuation.step.tracer import Tracer

SECONDS = 10.0
"""Time between two lines."""


class Progress:
    """Shows steps, parameter, step length and ending.

    `stream`: stderr by default. `label`: Begins every line.
    """

    def __init__(self, stream: TextIO | None = None, label: str = "path") -> None:
        self.stream, self.label = sys.stderr if stream is None else stream, label
        self._bar = _bar(self.stream, label)
        self._shown = time.monotonic()

    def step(self, tracer: Tracer, step: Step) -> None:
        """Show the step, at intervals."""
        text = f"lam = {step.lam:.4g}, step length {step.step_length:.2g}"
        if self._bar is not None:
            self._bar.set_postfix_str(text, refresh=False)
            self._bar.update(step.index - self._bar.n)
        elif time.monotonic() - self._shown >= SECONDS:
            self._write(f"{step.index} steps, {text}")

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Do nothing."""

    def end(self, tracer: Tracer) -> None:
        """Show the last point and the status."""
        path = tracer.path
        where = f"{path.endpoint.index} steps, lam = {path.endpoint.lam:.4g}" if path.steps else "no point"
        if self._bar is not None:
            self._bar.close()
        self._write(f"{where}, {path.status.name} in {path.seconds:.2f} s")

    def _write(self, text: str) -> None:
        self._shown = time.monotonic()
        self.stream.write(f"{self.label}: {text}\n")
        self.stream.flush()


def _bar(stream: TextIO, label: str) -> Any:
    try:
        from tqdm import tqdm
    except ImportError:
        return None
    looks = "{desc}: {n_fmt} steps [{elapsed}]{postfix}"
    return tqdm(desc=label, file=stream, leave=False, delay=1.0, bar_format=looks) if stream.isatty() else None
