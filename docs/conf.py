"""How the documentation is built: `python -m sphinx -W docs build/docs`. Nothing of it is loaded from elsewhere."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "src"))

from sinuous import __version__

project = "Sinuous"
author = "The Sinuous developers"
copyright = author
release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["build"]
root_doc = "index"
source_suffix = {".md": "markdown", ".txt": "markdown"}  # pages of results are text that commands write

myst_enable_extensions = ["colon_fence", "attrs_inline"]
myst_heading_anchors = 3
suppress_warnings = ["myst.xref_missing_lexer"]

default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "inherited-members": False}
napoleon_google_docstring = False
napoleon_custom_sections = [("Attributes", "params_style")]  # no entries of their own: properties have them
napoleon_use_rtype = False
add_module_names = False

html_theme = "furo"
html_title = "Sinuous"
html_static_path = ["static"]
html_css_files = ["sinuous.css"]
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0072b2", "color-brand-content": "#0072b2"},
    "dark_css_variables": {"color-brand-primary": "#56b4e9", "color-brand-content": "#56b4e9"},
}
copybutton_prompt_text = "$ "
