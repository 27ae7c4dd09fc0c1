"""Homotopies from names and options of the shell."""

from __future__ import annotations

import ast
import os
import sys
from collections.abc import Mapping, Sequence
from typing import Any

from continuation.arguments import plugins
from continuation.cli.parser import UsageError


def plug_in(name: str, group: str = plugins.GROUP) -> plugins.Factory:
    """The plug-in of a name; ``module:object`` may be in the working directory."""
    if ":" in name and os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())
    return plugins.find(name, group)


def homotopy_of(
    name: str, texts: Sequence[str], known: Mapping[str, Any] | None = None, group: str = plugins.GROUP
) -> tuple[Any, Mapping[str, Any]]:
    """The homotopy or scene for NAME KEY=VALUE ..., and its options; `known` gives defaults."""
    factory = plug_in(name, group)
    written = {name: option.annotation for name, option in plugins.options(factory).items()}
    values = {key: value for key, value in (known or {}).items() if key in written}
    typed: set[str] = set()
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not key.isidentifier():
            raise UsageError("KEY=VALUE", f"expected an option like n=10, found {text!r}")
        if key in typed:
            raise UsageError(key, "expected one value, found two")
        typed.add(key)
        values[key] = value if str(written.get(key)).startswith(("str", "<class 'str'")) else _literal(value)
    try:
        return plugins.called(name, factory, values), values
    except (TypeError, ValueError) as error:
        key, _, complaint = str(error).partition(": ")
        # Other errors concern the whole homotopy.
        raise UsageError(*((key, complaint) if key in {*values, *written} else (name, error))) from error


def _literal(text: str) -> Any:
    try:
        return ast.literal_eval({"none": "None", "true": "True", "false": "False"}.get(text, text))
    except (ValueError, SyntaxError):
        return text
