"""Progress on stderr: a live line on a terminal, else lines."""

from __future__ import annotations

import sys
import time
from typing import Any, TextIO

from continuation.path import LocatedEvent, Step
from continuation.step.tracer import Tracer

LIVE_SECONDS = 0.1

PLAIN_SECONDS = 10.0


class Progress:
    """Shows steps, parameter, step length and ending.

    `stream`: stderr by default. `label`: Begins every line.
    """

    def __init__(self, stream: TextIO | None = None, label: str = "path") -> None:
        self.stream = sys.stderr if stream is None else stream
        self.label = label
        self._live = self.stream.isatty()
        self._bar: Any = None
        self._shown = time.monotonic() if not self._live else 0.0
        self._width = 0

    def step(self, tracer: Tracer, step: Step) -> None:
        """Show the step, at intervals."""
        now = time.monotonic()
        if now - self._shown < (LIVE_SECONDS if self._live else PLAIN_SECONDS):
            return
        self._shown = now
        text = f"lam = {step.lam:.4g}, step length {step.step_length:.2g}"
        turns = len(tracer.path.turning_points)
        if turns:
            text += f", {turns} turning point{'s' if turns > 1 else ''}"
        self._show(step.index, text)

    def event(self, tracer: Tracer, event: LocatedEvent) -> None:
        """Do nothing."""

    def end(self, tracer: Tracer) -> None:
        """Show the last point and the status."""
        path = tracer.path
        steps, lam = (path.endpoint.index, f"lam = {path.endpoint.lam:.4g}") if path.steps else (0, "no point")
        self._show(steps, f"{lam}, {path.status.name} in {path.seconds:.2f} s", last=True)

    def _show(self, steps: int, text: str, last: bool = False) -> None:
        if self._live and self._bar is None:
            self._bar = _tqdm(self.stream, self.label)
        if self._bar is not None:
            self._bar.n = steps
            self._bar.set_postfix_str(text)
            if last:
                self._bar.close()
                self._bar = None
            return
        line = f"{self.label}: {steps} steps, {text}"
        if not self._live:
            self.stream.write(f"{line}\n")
        else:
            # Blanks erase a longer line.
            self.stream.write(f"\r{line:<{self._width}}" + ("\n" if last else ""))
            self._width = len(line)
        self.stream.flush()


def _tqdm(stream: TextIO, label: str) -> Any:
    try:
        from tqdm import tqdm
    except ImportError:
        return None
    return tqdm(desc=label, unit=" steps", file=stream, bar_format="{desc}: {n_fmt} steps [{elapsed}]{postfix}")


class SweepProgress:
    """Counts finished paths: ``trace_many(..., progress=SweepProgress())``.

    Parameters
    ----------
    stream : text stream, optional
        stderr by default.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self.stream = sys.stderr if stream is None else stream
        self._live, self._begun, self._shown = self.stream.isatty(), time.monotonic(), -PLAIN_SECONDS

    def __call__(self, done: int, total: int) -> None:
        """Show the count, at intervals.

        Parameters
        ----------
        done, total : int
        """
        now = time.monotonic()
        if done < total and now - self._shown < (LIVE_SECONDS if self._live else PLAIN_SECONDS):
            return
        self._shown = now
        text = f"sweep: {done} of {total} paths, {now - self._begun:.1f} s"
        end = "\n" if done == total or not self._live else ""
        self.stream.write(("\r" if self._live else "") + text + end)
        self.stream.flush()
