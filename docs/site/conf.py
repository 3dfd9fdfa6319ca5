"""How Sphinx reads the documents, which are written to be read on a forge: see stage.py for what is adapted before."""

import builtins
import os
import pathlib
import sys

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.addnodes import pending_xref

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

ROOT = pathlib.Path(__file__).resolve().parents[2]

project = "Abbe"
author = "The Abbe authors"
version = release = os.environ["ABBE_SITE_VERSION"]
extensions = ["myst_nb", "mathml"]

root_doc = "index"
exclude_patterns = []
smartquotes = False  # `--option` in running text is not a dash
default_role = "literal"  # of docstrings
nitpicky = True
# Only names of this package are links; those of Python and NumPy lead to other hosts.
nitpick_ignore_regex = [("py:.*", r"(?!abbe\.).*")]
suppress_warnings = [
    "misc.highlighting_failure",  # JSON with `...` for what is left out
]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 6  # [text](page.md#heading) as forges make them
myst_links_external_new_tab = False

nb_execution_mode = "cache"
nb_execution_in_temp = True
nb_execution_cache_path = os.environ["ABBE_SITE_NOTEBOOKS"]
nb_execution_raise_on_error = True
nb_execution_timeout = 600
nb_merge_streams = True

add_module_names = False
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = f"Abbe {release}"
html_static_path = [str(ROOT / "docs/site/static")]
html_css_files = ["site.css"]
templates_path = [str(ROOT / "docs/site/templates")]
html_search_scorer = str(ROOT / "docs/site/search_scorer.js")
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_use_index = True
html_domain_indices = False
html_math_renderer = "mathml"
# Summaries are fetched by Sphinx, which no browser allows from file://; search_excerpts.js shows them from a file.
html_show_search_summary = False
html_theme_options = {"navigation_with_keys": True}
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "a11y-high-contrast-dark"


def leave_python_alone(app, doctree):
    """`bytes` in a type is Python's, although a class of the package has a member of this name: no link."""
    for node in list(doctree.findall(pending_xref)):
        if node.get("refdomain") == "py" and hasattr(builtins, node["reftarget"]):
            node.replace_self(nodes.Text(node["reftarget"]))


def setup(app):
    app.add_lexer("csv", TextLexer)
    app.connect("doctree-read", leave_python_alone)
