"""The manual: `make docs` builds it into build/manual, without any network."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE))

import vision_robot  # noqa: E402

project = "Vision Robot"
author = "the Vision Robot project"
project_copyright = "Apache-2.0"
release = version = vision_robot.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "extension.docstrings",
    "extension.generated",
    "extension.mathml",
    "extension.offline",
]
exclude_patterns = ["README.md", "examples/**"]
html_theme = "furo"
html_title = "Vision Robot"
html_math_renderer = "mathml"
html_copy_source = False
smartquotes = False  # two dashes are an option's
html_show_sourcelink = False
html_static_path = ["style"]
html_css_files = ["manual.css"]
pygments_style = "friendly"

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
suppress_warnings = ["misc.highlighting_failure"]

autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
autodoc_class_signature = "mixed"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 90
maximum_signature_line_length = 90
toc_object_entries = False
add_module_names = False
