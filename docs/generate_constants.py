"""The constants that decide in `continuation`, with their reasons, and what fails when one is doubled or halved.

``python docs/generate_constants.py`` writes `docs/constants.md` from the sources and from `docs/constants.json`, where
trials are kept. ``python docs/generate_constants.py try FILES TESTS...`` makes those of files, a pattern: in a copy of
the project each of their constants is doubled, and halved, and the tests are run until one fails.
"""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "docs" / "constants.json"
PAGE = ROOT / "docs" / "constants.md"

HEAD = """# Constants that decide

Every module-level number of `continuation` that decides something, with the reason that stands beside it in the
source; a reason that is given once for several names stands at the last of them. Under "twice" and "half" is the first
test that fails when the constant is doubled or halved, as `docs/generate_constants.py` tried it with the tests of its
room, or with half a minute of the tests that reach it: "nothing" where they pass, a dash where it was not tried. Of
proofs it is said how many of 102 paths were proved, and with how many boxes, where that changed. This page is made by
that script.

"""


def constants(text: str) -> Iterator[tuple[str, ast.expr, str]]:
    """Name, value and reason of each: capitals that hold a number, with the docstring behind them."""
    body = ast.parse(text).body
    for statement, after in zip(body, [*body[1:], None]):
        if isinstance(statement, ast.Assign):
            target, value = statement.targets[0], statement.value
        elif isinstance(statement, ast.AnnAssign) and statement.value is not None:
            target, value = statement.target, statement.value
        else:
            continue
        said = after.value if isinstance(after, ast.Expr) else None
        reason = " ".join(said.value.split()) if isinstance(said, ast.Constant) and isinstance(said.value, str) else ""
        several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
        pairs: Any = zip(target.elts, value.elts) if several else [(target, value)]
        for name, number in pairs:
            if isinstance(name, ast.Name) and name.id == name.id.upper() and any(map(_is_number, ast.walk(number))):
                yield name.id, number, reason


def _is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def changed(text: str, value: ast.expr, twice: bool) -> str | None:
    """The source with another value; None where the value is no number by itself."""
    before = ast.get_source_segment(text, value)
    number = isinstance(value, ast.Call) and getattr(value.func, "id", "") == "float"
    if before is None or (isinstance(value, ast.Tuple | ast.List | ast.Dict | ast.Call | ast.Set) and not number):
        return None
    whole = isinstance(value, ast.Constant) and isinstance(value.value, int)
    after = f"2 * ({before})" if twice else f"max(1, ({before}) // 2)" if whole else f"0.5 * ({before})"
    lines = text.splitlines(keepends=True)
    begin = sum(map(len, lines[: value.lineno - 1])) + value.col_offset
    return text[:begin] + after + text[begin + len(before or "") :]


def tries(files: str, tests: list[str]) -> None:
    """Keep, by name, the first test that fails when a constant of the files is doubled, and halved."""
    with tempfile.TemporaryDirectory() as place:
        subprocess.run(f"git ls-files | tar -cf - -T - | tar -xf - -C {place}", shell=True, cwd=ROOT, check=True)
        surroundings = {**os.environ, "PYTHONPATH": place, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
        for file in sorted(Path(place).glob(files)):
            text = file.read_text(encoding="utf8")
            for name, value, _ in constants(text):
                for how in ("twice", "half"):
                    other = changed(text, value, how == "twice")
                    if other is None:
                        continue
                    file.write_text(other, encoding="utf8")
                    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
                    ran = subprocess.run(command, cwd=place, env=surroundings, capture_output=True, text=True)
                    ends = [line for line in ran.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
                    failed = [line.split()[1] for line in ends]
                    said = "nothing" if ran.returncode == 0 else failed[0].split("::")[-1] if failed else "import"
                    key = f"{file.relative_to(place)}:{name}"
                    print(key, how, said, flush=True)
                    kept = read()
                    kept.setdefault(key, {})[how] = said
                    KEPT.write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", encoding="utf8")
                file.write_text(text, encoding="utf8")


def read() -> dict[str, dict[str, str]]:
    """What was tried so far."""
    found: dict[str, dict[str, str]] = json.loads(KEPT.read_text(encoding="utf8")) if KEPT.exists() else {}
    return found


def page() -> str:
    """The table."""
    kept = read()
    rooms: dict[str, list[str]] = defaultdict(list)
    for file in sorted((ROOT / "continuation").rglob("*.py")):
        text, key = file.read_text(encoding="utf8"), str(file.relative_to(ROOT))
        for name, value, reason in constants(text):
            said = " ".join((ast.get_source_segment(text, value) or "").split())
            told = kept.get(f"{key}:{name}", {})
            cells = f"`{name}`", f"`{said}`", reason, told.get("twice", "-"), told.get("half", "-")
            rooms[key].append(" | ".join(cell.replace("|", "\\|") for cell in cells))
    parts = [HEAD]
    for key, rows in rooms.items():
        parts.append(f"## `{key}`\n\n| name | value | reason | twice | half |\n| --- | --- | --- | --- | --- |\n")
        parts.append("".join(f"| {row} |\n" for row in rows) + "\n")
    return "".join(parts).rstrip() + "\n"


def main() -> None:
    """Try, or write the page."""
    if sys.argv[1:2] == ["try"]:
        tries(sys.argv[2], sys.argv[3:])
    PAGE.write_text(page(), encoding="utf8")


if __name__ == "__main__":
    main()
