"""Sphinx settings of the documentation's site, which tools/docs builds. The source directory is the top of the repository."""
import pathlib
import re
import sys

from pygments.lexers import JavascriptLexer, TextLexer

top = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(top / "python"))

project = "glint"
author = copyright = "the glint authors"
release = re.search(r"VERSION (\d+\.\d+\.\d+)", (top / "CMakeLists.txt").read_text()).group(1)

extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "docs/site/index"
include_patterns = ["*.md", "docs/**", "tests/stability/cases.md"]
exclude_patterns = ["build*", "docs/images/**"]
myst_heading_anchors = 4
# The examples hold console sessions and excerpts, which highlighters need not parse.
suppress_warnings = ["misc.highlighting_failure", "myst.header"]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_type_aliases = {"ArrayLike": "ArrayLike", "Selector": "Selector"}
autodoc_default_options = {"members": True, "undoc-members": True}

html_theme = "furo"
html_title = f"glint {release}"
html_copy_source = False
html_static_path = ["static"]
html_css_files = ["site.css"]


def setup(app):
    app.add_lexer("jsonc", JavascriptLexer)
    app.add_lexer("txt", TextLexer)
