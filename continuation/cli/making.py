"""Homotopies from names and options of the shell."""

from __future__ import annotations

import ast
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from continuation.arguments import plugins
from continuation.cli.parser import PlugInError, UsageError, told

DOOR = (
    "homotopy", "start", "residual", "jacobian", "target", "max_step", "finish", "events", "metric", "box", "observe",
    "parameter_name", "names", "units",
)  # fmt: skip
"""Names that begin a complaint about a homotopy."""


def importable(name: str) -> None:
    """Make ``module:object`` importable from the working directory."""
    if ":" in name and os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())


def homotopy_of(
    name: str, texts: Sequence[str], known: Mapping[str, Any] | None = None, group: str = plugins.GROUP
) -> tuple[Any, Mapping[str, Any]]:
    """The homotopy or scene for NAME KEY=VALUE ..., and its options; `known` gives defaults."""
    importable(name)
    with unknown(name):
        factory = plugins.find(name, group)
    written = {option.name: option.annotation for option in plugins.options(factory)}
    values = {**(known or {}), **_values(texts, written)}
    try:
        with refused(name):
            return plugins.called(name, factory, values), values
    except UsageError as complained:
        error = complained.__cause__
        if not isinstance(error, (TypeError, ValueError)):
            raise
        key, _, complaint = str(error).partition(": ")
        # Other errors concern the whole homotopy.
        raise UsageError(*((key, complaint) if key in {*values, *written} else (name, error))) from error


def _values(texts: Sequence[str], annotations: Mapping[str, str]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not key.isidentifier():
            raise UsageError("KEY=VALUE", f"expected an option like n=10, found {text!r}")
        if key in values:
            raise UsageError(key, "expected one value, found two")
        values[key] = value if annotations.get(key, "").startswith("str") else _literal(value)
    return values


def _literal(text: str) -> Any:
    try:
        return ast.literal_eval({"none": "None", "true": "True", "false": "False"}.get(text, text))
    except (ValueError, SyntaxError):
        return text


@contextmanager
def unknown(name: str) -> Iterator[None]:
    """Report an unknown name."""
    try:
        yield
    except plugins.PluginError as error:
        raise UsageError(name, str(error).removeprefix(f"{name}: ")) from error


@contextmanager
def refused(name: str) -> Iterator[None]:
    """Report errors of trace and plug-in in one line."""
    try:
        yield
    except (UsageError, OSError):
        raise
    except Exception as error:
        if isinstance(error, (TypeError, ValueError)) and str(error).partition(":")[0] in DOOR:
            raise UsageError(name, error) from error
        raise PlugInError(name, told(error)) from error
