"""Every public function says what its parameters are: a numpydoc section that names each of them.

Public is what a package of `continuation` or `problems` lists in `__all__`: functions, and the methods of classes. A
method that a protocol asks for (`prepare`, `residual`) may leave the description to the protocol.
"""

from __future__ import annotations

import importlib
import inspect
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = sorted(
    ".".join(file.parent.relative_to(ROOT).parts)
    for top in ("continuation", "problems")
    for file in (ROOT / top).rglob("__init__.py")
)


def documented(owner):
    """The names in the Parameters (or, for data, Attributes) section of a docstring."""
    text = inspect.cleandoc(owner.__doc__ or "")
    found = re.search(r"^(?:Parameters|Attributes)\n-+\n(.*?)(?=^\S[^\n]*\n-+\n|\Z)", text, re.DOTALL | re.MULTILINE)
    lines = found[1].splitlines() if found else []
    heads = [line.split(":")[0] for line in lines if line and not line[0].isspace()]
    return {name.strip(" *") for head in heads for name in head.split(",")}


def parameters(function):
    """What a caller gives; in place of ``**options: Unpack[Options]``, every option, where it has no entry itself."""
    names = set()
    for name, parameter in inspect.signature(function).parameters.items():
        unpacked = re.fullmatch(r"Unpack\[(\w+)\]", str(parameter.annotation))
        if unpacked and name not in documented(function):
            names |= set(inspect.unwrap(function).__globals__[unpacked[1]].__annotations__)
        else:
            names.add(name)
    return names - {"self", "cls"}


def public(package):
    """(label, object) of everything that a package exports."""
    module = importlib.import_module(package)
    for name in getattr(module, "__all__", ()):
        value = getattr(module, name)
        if inspect.isfunction(value) or inspect.isclass(value):
            yield f"{package}.{name}", value


def methods(cls):
    """The public functions among the attributes of a class, by name; those of a class method unwrapped."""
    for name, value in vars(cls).items():
        function = value.__func__ if isinstance(value, (staticmethod, classmethod)) else value
        if not name.startswith("_") and inspect.isfunction(function):
            yield name, function


@cache
def protocols():
    """What the protocols of all modules say of the methods that they ask for: method name to documented names."""
    found = {}
    for package in PACKAGES:
        for module in (inspect.getmodule(value) for _, value in public(package)):
            for value in vars(module).values():
                if inspect.isclass(value) and getattr(value, "_is_protocol", False):
                    for name, function in methods(value):
                        found.setdefault(name, set()).update(documented(function))
    return found


def functions(package):
    """(label, function, what the protocols say of it) of every function and method that a package exports."""
    for label, value in public(package):
        if inspect.isfunction(value):
            yield label, value, set()
        else:
            for name, function in methods(value):
                yield f"{label}.{name}", function, protocols().get(name, set())


@pytest.mark.parametrize("package", PACKAGES)
def test_every_parameter_is_documented(package):
    missing = {label: parameters(f) - documented(f) - said for label, f, said in functions(package)}
    assert {label: names for label, names in missing.items() if names} == {}
