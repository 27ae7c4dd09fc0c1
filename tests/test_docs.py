"""The blocks of the README run, every command of a page exists, every page is reachable.

`make docs`, which CI runs too, runs the blocks of the other pages and the scripts of the gallery, warnings as errors.
"""

import ast
import re
import shlex
from fnmatch import fnmatch
from pathlib import Path

import pytest
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml

from continuation.cli import register
from continuation.cli.parser import Parser

from .util import load

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted(path for path in DOCS.rglob("*.md") if "generated" not in path.parts),
]
NAMES = [str(path.relative_to(ROOT)) for path in PAGES]
_SHELL = re.compile(r"^```sh\n(.*?)^```", re.MULTILINE | re.DOTALL)
_DISPLAYED = re.compile(r"```.*?```|`[^`\n]*`|\$\$(.+?)\$\$", re.DOTALL)
_INLINE = re.compile(r"```.*?```|`[^`\n]*`|\$\$.+?\$\$|(?<![\\$])\$(?!\s)([^$]+?)\$", re.DOTALL)
_TREE = re.compile(r"^```\{toctree\}\n(.*?)^```", re.MULTILINE | re.DOTALL)


executed = load(DOCS / "executed.py")


@pytest.mark.parametrize("page", PAGES[:2], ids=NAMES[:2])
def test_the_blocks_of_a_page_run(page, tmp_path):
    assert list(executed.run(page.read_text(encoding="utf-8"), tmp_path, page.name))


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_the_commands_and_files_of_a_page_exist_and_docutils_sets_its_formulas(page):
    text, parser = page.read_text(encoding="utf-8"), Parser(prog="continuation")
    register(parser.add_subparsers())
    for line in "".join(_SHELL.findall(text)).splitlines():
        words = shlex.split(line, comments=True)
        if words and words[0] == "continuation":
            parser.parse_args(words[1:])
    for formula in filter(None, _DISPLAYED.findall(text) + _INLINE.findall(text)):
        _set(formula, page)
    named = re.findall(r"\b(?:continuation|problems|tests|docs|examples)/[\w/*]+\.(?:py|md)\b", text)
    if page.name == "CONTRIBUTING.md":
        named += re.findall(r"`((?:continuation|problems|tests|docs)/[\w/*.]*)`", text)
    assert [name for name in named if not list(ROOT.glob(name))] == []


@pytest.mark.parametrize("room", ["continuation", "problems", "examples"])
def test_the_formulas_of_docstrings_are_ones_that_docutils_sets(room):
    for path in sorted((ROOT / room).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                for formula in re.findall(r":math:`(.+?)`", ast.get_docstring(node) or "", re.DOTALL):
                    _set(formula, path)


def _set(formula, path):
    try:
        tex2mathml(formula)
    except MathError as error:
        pytest.fail(f"{path.relative_to(ROOT)}: {formula}: {error}")


def test_every_page_is_in_the_table_of_contents():
    listed = {line for tree in _TREE.findall((DOCS / "index.md").read_text()) for line in tree.split("\n")}
    pages = {str(page.relative_to(DOCS).with_suffix("")) for page in PAGES if DOCS in page.parents} - {"index"}
    assert [page for page in pages if not any(fnmatch(page, pattern) for pattern in listed)] == []
