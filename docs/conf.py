"""Sphinx: pages in Markdown (MyST), their blocks executed, the reference from docstrings."""

import re
import shutil
import sys
from importlib.util import find_spec
from pathlib import Path

import attrs
from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx import addnodes

sys.path.insert(0, str(Path(__file__).parent))

import executed

import continuation
from continuation.status import Described

HERE = Path(__file__).parent

project = "continuation"
author = "The continuation developers"
release = version = continuation.__version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build", "generated"]
# The scripts are run by the build, in the order of their names; a failure of one fails the build.
sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    # An example that needs an extra is shown where it is installed.
    "ignore_pattern": "__init__" if find_spec("jax") else "_jax_",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "capture_repr": (),
    "download_all_examples": False,
    "min_reported_time": 3600,
    "write_computation_times": False,
    "notebook_extensions": set(),
    "show_signature": False,
    "image_srcset": ["2x"],
}
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
html_math_renderer = "mathml"
html_theme = "furo"
html_title = "continuation"
html_static_path = ["static", "images"]
html_css_files = ["custom.css"]
html_copy_source = False
html_show_copyright = False
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_default_options = {"members": True}
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True
# Pages on what was measured come and go with the measurements.
suppress_warnings = ["toc.empty_glob"]
pygments_style = "friendly"
pygments_dark_style = "github-dark"

GENERATED = HERE / "generated"


def show_results(app, docname, source):
    """Run the page, and put what its blocks print and draw after them."""
    if "```python\n" not in source[0]:
        return
    folder = GENERATED / docname
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    source[0] = executed.with_results(source[0], folder, f"{docname}.md", f"/generated/{docname}")


def plain_signs(app, what, name, obj, options, lines):
    """In our docstrings a bar is the absolute value and a star unpacks: neither is markup, outside of literals."""
    for number, line in enumerate(lines):
        parts = line.split("``")
        parts[::2] = [_LONE_STAR.sub(r"\\*", part.replace("|", r"\|")) for part in parts[::2]]
        lines[number] = "``".join(parts)


def members_in_sentences(app, what, name, obj, options, lines):
    """A list of an enumeration's members: each carries its description, which autodoc does not look for."""
    if what == "class" and issubclass(obj, Described):
        for member in obj:
            lines += [f"``{member.name}`` = {member.value}", f"    {member.__doc__}", ""]


def listed_already(app, what, name, obj, skip, options):
    """Members of an enumeration are in its own description."""
    return True if isinstance(obj, Described) else None


def whole_sentences(app, what, name, obj, options, lines):
    """Napoleon takes what precedes a colon for a type, and the first of two names as well: neither is meant here."""
    for number, line in enumerate(lines):
        lines[number] = _TWO_NAMES.sub(lambda found: found.group().replace(", ", ","), line)
    if what in ("property", "attribute") and lines and lines[-1].startswith(":type: "):
        lines[0] = f"{lines.pop().removeprefix(':type: ')}: {lines[0]}"


_TWO_NAMES = re.compile(r"^\s*:(?:ivar|vartype) [\w, ]+:")
_LONE_STAR = re.compile(r"(?<![\w*\\])\*(?=\w)(?![^*]*\*)")


def arguments_as_written(app, what, name, obj, options, signature, returns):
    """None for a protocol, which is not called; for an attrs class the defaults, not the code that makes them."""
    if what != "class":
        return None
    if getattr(obj, "_is_protocol", False):
        return "", None
    if not attrs.has(obj) or "attrs generated" not in obj.__init__.__code__.co_filename:
        return None
    fields = sorted((field for field in attrs.fields(obj) if field.init), key=lambda field: field.kw_only)
    positional = [_argument(field) for field in fields if not field.kw_only]
    keywords = [_argument(field) for field in fields if field.kw_only]
    return f"({', '.join([*positional, *(['*'] if keywords else []), *keywords])})", None


def _argument(field):
    if field.default is attrs.NOTHING:
        return field.alias
    made = isinstance(field.default, attrs.Factory)
    return f"{field.alias}={'...' if made else repr(field.default)}"


def words_are_words(app, doctree):
    """Take back the links that Sphinx makes of every word in a type, like "shape" in "ndarray, shape (n,)"."""
    for node in list(doctree.findall(addnodes.pending_xref)):
        if node.get("refdomain") == "py" and node.get("reftype") == "class" and node["reftarget"].islower():
            node.replace_self(node.children)


def formula(self, node):
    """A formula in a line, as MathML: browsers draw that themselves, with no script and no network."""
    self.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def displayed_formula(self, node):
    """A formula of its own."""
    self.body.append(f'<div class="math">{tex2mathml(node.astext(), as_block=True)}</div>')
    raise nodes.SkipNode


def setup(app):
    """Connect the functions above; Sphinx calls it."""
    app.add_html_math_renderer("mathml", (formula, None), (displayed_formula, None))
    app.connect("source-read", show_results)
    app.connect("autodoc-skip-member", listed_already)
    app.connect("autodoc-process-docstring", members_in_sentences)
    app.connect("autodoc-process-docstring", whole_sentences, priority=800)
    app.connect("autodoc-process-docstring", plain_signs, priority=900)
    app.connect("autodoc-process-signature", arguments_as_written)
    app.connect("doctree-read", words_are_words)
