"""How the documentation is built; nothing of it is loaded from elsewhere."""

import inspect
import re
import sys
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, get_args, is_typeddict

sys.path.insert(0, str(Path(__file__).parent.parent / "src"))

from sinuous import Robot, __version__
from sinuous.motion.plan import TIME
from sinuous.solver.options import SolveOptions

project = "Sinuous"
author = "The Sinuous developers"
copyright = author
release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
]
exclude_patterns = ["build"]
root_doc = "index"
source_suffix = {
    ".md": "markdown",
    ".txt": "markdown",
}  # pages of results are text that commands write

myst_enable_extensions = ["colon_fence", "attrs_inline"]
myst_heading_anchors = 3
suppress_warnings = ["myst.xref_missing_lexer", "myst.header"]

default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "inherited-members": False}
napoleon_google_docstring = False
napoleon_custom_sections = [
    ("Attributes", "params_style")
]  # no entries of their own: properties have them
napoleon_use_rtype = False
add_module_names = False

html_theme = "furo"
html_title = "Sinuous"
html_static_path = ["static"]
html_css_files = ["sinuous.css"]
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {
        "color-brand-primary": "#0072b2",
        "color-brand-content": "#0072b2",
    },
    "dark_css_variables": {
        "color-brand-primary": "#56b4e9",
        "color-brand-content": "#56b4e9",
    },
}
copybutton_prompt_text = "$ "

DEFAULTS = {
    **{
        name: repr(each.default)
        for name, each in inspect.signature(Robot).parameters.items()
    },
    **{
        each.name: repr(each.default)
        for each in fields(SolveOptions)
        if each.default is not MISSING
    },
    "shortcuts": "0",
    "begin": "0.0",
}
"""What options are that signatures pass on; `None` where nothing is said here."""

OWN = {
    "plan": {"time": repr(TIME)},
    "Planner": {"time": repr(TIME)},
    "reach": {"max_starts": "1", "routes": "False"},
}
"""What they are elsewhere; in studies also what the constants of their modules say."""

CONSTANTS = {"TIME": "time", "SOLVE_TIME": "time", "STARTS": "max_starts"}


def show_defaults(
    app: Any,
    what: str,
    name: str,
    found: Any,
    options: Any,
    signature: str,
    returned: str,
) -> Any:
    """Show options one by one, with defaults; those of `changed` are what they were."""
    if not signature or name.endswith(".changed"):
        return None
    function = inspect.unwrap(
        getattr(found.__init__ if inspect.isclass(found) else found, "__func__", found)
    )
    for kind in getattr(function, "__annotations__", {}).values():
        inner = (get_args(kind) or [None])[0]
        if is_typeddict(inner):
            passed = ", ".join(f"{each}=..." for each in inner.__annotations__)
            signature = re.sub(r"\*\*\w+", passed, signature)
    module = getattr(function, "__module__", "")
    own = dict(OWN.get(name.rpartition(".")[2], {}))
    if module.startswith("sinuous.studies."):
        values = vars(sys.modules[module])
        own |= {
            key: repr(values[constant])
            for constant, key in CONSTANTS.items()
            if constant in values
        }
    known = {**DEFAULTS, **own}
    return re.sub(
        r"(\w+)=\.\.\.", lambda one: f"{one[1]}={known.get(one[1], 'None')}", signature
    ), returned


def setup(app: Any) -> None:
    """Let Sphinx ask for signatures."""
    app.connect("autodoc-process-signature", show_defaults)
