"""One name, one number: a constant that decides something is not called as another one that is not it."""

import ast
import importlib
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[1]


def _names(statement: ast.stmt) -> list[str]:
    targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
    named = [one for target in targets for one in (target.elts if isinstance(target, ast.Tuple) else [target])]
    return [one.id for one in named if isinstance(one, ast.Name) and one.id.isupper() and not one.id.startswith("_")]


def _number(value: object) -> bool:
    return all(isinstance(one, int | float) for one in (value if isinstance(value, tuple) else (value,)))


def test_one_name_one_number() -> None:
    values: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for package in ("continuation", "problems"):
        for file in sorted((ROOT / package).rglob("*.py")):
            module = ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
            for name in (name for statement in ast.parse(file.read_text()).body for name in _names(statement)):
                value = getattr(importlib.import_module(module), name)
                if _number(value):
                    values[name][repr(value)].append(module)
    assert len(values) > 300
    assert {name: dict(found) for name, found in values.items() if len(found) > 1} == {}
