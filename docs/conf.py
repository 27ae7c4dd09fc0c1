"""Sphinx: pages in Markdown (MyST), their blocks executed, the reference from docstrings."""

import re
import shutil
import sys
from pathlib import Path

from sphinx import addnodes

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import executed  # noqa: E402

import continuation  # noqa: E402

project = "continuation"
author = "The continuation developers"
release = version = continuation.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax", "sphinx.ext.viewcode"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build", "generated"]
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "continuation"
html_static_path = ["static"]
html_css_files = ["custom.css"]
html_copy_source = False
html_show_copyright = False
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
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


_LONE_STAR = re.compile(r"(?<![\w*\\])\*(?=\w)(?![^*]*\*)")


def no_protocol_arguments(app, what, name, obj, options, signature, returns):
    """A protocol is not called; the arguments that Python shows for it mean nothing."""
    return ("", None) if getattr(obj, "_is_protocol", False) and what == "class" else None


def words_are_words(app, doctree):
    """Take back the links that Sphinx makes of every word in a type, like "shape" in "ndarray, shape (n,)"."""
    for node in list(doctree.findall(addnodes.pending_xref)):
        if node.get("refdomain") == "py" and node.get("reftype") == "class" and node["reftarget"].islower():
            node.replace_self(node.children)


def setup(app):
    """Connect the functions above; Sphinx calls it."""
    app.connect("source-read", show_results)
    app.connect("autodoc-process-docstring", plain_signs, priority=900)
    app.connect("autodoc-process-signature", no_protocol_arguments)
    app.connect("doctree-read", words_are_words)
