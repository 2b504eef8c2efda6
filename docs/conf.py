"""How the pages are built: `make docs`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util.nodes import make_refnode
from sphinx.writers.html5 import HTML5Translator

import crackfront
from crackfront.analysis.jump_measures import JumpMeasures
from crackfront.analysis.table import SweepRow
from crackfront.core.cycle.jumps import Jumps
from crackfront.core.geometry.line import LineState
from crackfront.core.geometry.sphere import ContactState
from crackfront.core.variables import variables
from crackfront.measured.loops.loop_result import MeasuredLoop
from crackfront.measured.options import Options, PsdOptions, ReadingOptions
from crackfront.measured.prediction.prediction import Prediction
from crackfront.sweep.configuration import Configuration

project = "crackfront"
author = "crackfront developers"
copyright = f"2026, {author}"
version = release = crackfront.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_parser",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "_templates", "sg_execution_times.rst"]
templates_path = ["_templates"]
nitpicky = True
# Constants that a module has from another one are on no page, and other packages on none of ours.
nitpick_ignore_regex = [
    ("py:data", r".*"),
    ("py:class", r"xarray\..*"),
    ("py:meth", r"SelfAffineSpectrum\..*"),
]
default_role = "literal"

# The reference: every docstring is checked for what numpydoc can check.
autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_validation_checks = {
    "GL03",
    "GL05",
    "GL06",
    "GL07",
    "GL09",
    "GL10",
    "SS02",
    "SS04",
    "PR02",
    "PR03",
    "PR05",
    "PR06",
    "PR10",
    "SA02",
    "SA03",
}
# The summaries of these begin with a symbol, e_el or k.
numpydoc_validation_exclude = {r"\.elastic_energies$", r"\.[A-Z]+_FACTOR$"}

# The pages, which are read on GitHub too.
myst_enable_extensions = ["dollarmath"]
myst_fence_as_directive = {"math"}
myst_heading_anchors = 3

# The examples, executed; an error in one of them ends the build.
sphinx_gallery_conf = {
    "examples_dirs": str(Path(__file__).parents[1] / "examples"),
    "gallery_dirs": "examples",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "download_all_examples": False,
    # A page that loads its table from a network; an earlier build may have left its source.
    "write_computation_times": False,
}

# MathML, which browsers draw themselves: no script, and nothing from a network.
html_math_renderer = "mathml"
html_css_files = ["pages.css"]
html_static_path = ["_static"]

html_theme = "pydata_sphinx_theme"
html_title = "crackfront"
html_show_sourcelink = False
# Pages that stand alone lack pages to list in a sidebar.
html_sidebars = {name: [] for name in ("index", "tutorial")}
html_theme_options = {
    "navigation_with_keys": False,
    # More would not stand in one row on a screen of 1280 pixels.
    "header_links_before_dropdown": 6,
    "navbar_persistent": ["search-button"],
    "show_toc_level": 2,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}


def _is_foreign(
    app: Sphinx, what: str, name: str, member: object, skip: bool, options: object
) -> bool | None:
    """Whether a member of a module comes from another package, as a function that it imports."""
    home = getattr(member, "__module__", None)
    return True if home is not None and not home.startswith("crackfront") else None


def _escape_magnitudes(
    app: Sphinx, what: str, name: str, member: object, options: object, lines: list[str]
) -> None:
    """Bars of a summary are magnitudes, not substitutions of reStructuredText."""
    if lines:
        lines[0] = lines[0].replace("|", r"\|")


def _describe_options(
    app: Sphinx, what: str, name: str, member: object, options: object, lines: list[str]
) -> None:
    """List the fields of a record of options with their meanings, which autodoc does not find."""
    if isinstance(member, type) and issubclass(member, Options):
        lines.append("")
        for field, about in member.model_fields.items():
            lines.append(f":param {field}: {' '.join(str(about.description).split())}")
        lines.append("")


def _link_names(app: Sphinx, doctree: nodes.document, docname: str) -> None:
    """Link code spans that are names of the library to their pages."""
    objects = app.env.domains.python_domain.objects
    for span in list(doctree.findall(nodes.literal)):
        entry = objects.get(span.astext())
        if entry is not None and not isinstance(span.parent, nodes.reference):
            place = entry.docname, entry.node_id
            span.replace_self(make_refnode(app.builder, docname, *place, span.deepcopy()))


def _visit_math(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula in a line."""
    self.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def _visit_displaymath(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write an equation of its own."""
    self.body.append(self.starttag(node, "div", CLASS="equation"))
    self.body.append(tex2mathml(node.astext(), as_block=True))
    self.body.append("</div>\n")
    raise nodes.SkipNode


def _check_network(app: Sphinx, error: Exception | None) -> None:
    """End the build if a page loads a script, a style or a picture from a network."""
    loading = re.compile(r"<(?:script|link|img|iframe)\b[^>]*\s(?:src|href)=\"(?:https?:)?//[^\"]*")
    for page in Path(app.outdir).rglob("*.html"):
        if tag := loading.search(page.read_text(encoding="utf-8")):
            raise ExtensionError(f"{page} needs a network: {tag[0]}")


_BOUNDS = {
    "minimum": "at least",
    "exclusiveMinimum": "above",
    "maximum": "at most",
    "exclusiveMaximum": "below",
}
"""Keys of JSON Schema for the range of a number, in words."""

_TYPES = {"number": "number", "integer": "whole number", "string": "text", "boolean": "switch"}
"""Types of JSON Schema, in words."""


def _kind(schema: dict[str, Any]) -> str:
    """What a value of a configuration may be, in words."""
    if "anyOf" in schema:
        choices = [choice for choice in schema["anyOf"] if choice.get("type") != "null"]
        return " or ".join(map(_kind, choices))
    if "$ref" in schema:
        return f"section {schema['$ref'].rpartition('/')[2].removesuffix('Section')}"
    if "enum" in schema:
        return " or ".join(f"`{value}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{schema['const']}`"
    if schema.get("type") == "array":
        items = [schema["items"]] if "items" in schema else schema.get("prefixItems", [{}])
        return "list of " + ", ".join(map(_kind, items))
    bounds = [f"{words} {schema[key]:g}" for key, words in _BOUNDS.items() if key in schema]
    return " ".join([_TYPES.get(schema.get("type", ""), "as the reader takes it"), *bounds])


_OPTIONS: dict[str, type[Options]] = {
    "Surface": ReadingOptions,
    "Tiles": ReadingOptions,
    "Density": PsdOptions,
}
"""Options of readers, which are further keys of sections."""


def _meanings() -> dict[tuple[str, str], str]:
    """What each key of a section means, from config/README.md and the options of readers."""
    text = (Path(__file__).parents[1] / "config/README.md").read_text(encoding="utf-8")
    # A link leads from there to a page, and here from one.
    rows = re.findall(r"^\| (\w+) \| `(\w+)` \| (.*) \|$", text, re.MULTILINE)
    meanings = {(section, key): text.replace("(../docs/", "(../") for section, key, text in rows}
    for section, options in _OPTIONS.items():
        for name, field in options.model_fields.items():
            meanings[section, name] = " ".join(str(field.description).split())
    return meanings


def _configuration_page() -> str:
    """Keys of configurations, as the code has them."""
    schema = Configuration.model_json_schema()
    sections = {"file": schema} | schema["$defs"]
    for section, options in _OPTIONS.items():
        for name, field in options.model_fields.items():
            sections[f"{section}Section"]["properties"][name] = {"default": field.default}
    meanings = _meanings()
    lines = ["# Keys of a configuration", "", "For those who write one."]
    for name, section_schema in sections.items():
        section = name.removesuffix("Section")
        lines += ["", f"## {section.capitalize()}", "", section_schema["description"], ""]
        lines += ["| key | meaning and unit | value | default |", "|---|---|---|---|"]
        required = section_schema.get("required", ())
        for key, value in section_schema["properties"].items():
            default = "required" if key in required else f"`{value.get('default')}`"
            lines.append(f"| `{key}` | {meanings[section, key]} | {_kind(value)} | {default} |")
    return "\n".join(lines) + "\n"


def _variables_page() -> str:
    """Variables of files and of JSON, as the code has them."""
    files = {
        "A simulation in `hysteresis.nc`": variables(SweepRow),
        "The same with `record: [jumps]`": variables(JumpMeasures),
        "A jump in `curves/`, with `record: [jumps]`": variables(Jumps),
        "A curve of a sphere": variables(ContactState),
        "A curve of a straight front": variables(LineState),
        "`prediction` in `crackfront predict --json`": variables(Prediction),
        # Its arrays, which have an entry for each row of the recording, are not printed.
        "`crackfront loop --json`": [item for item in variables(MeasuredLoop) if not item.dims],
    }
    lines = ["# Variables of files and of JSON", "", "For those who read one of them.", ""]
    lines += ["What is said of a file's origin stands in `crackfront.simulate.provenance`."]
    lines += ["In JSON a number with an interval has `value`, `standard_error`, `low` and `high`."]
    for name, listed in files.items():
        lines += ["", f"## {name}", ""]
        lines += ["| variable | dimensions | unit | what |", "|---|---|---|---|"]
        for item in listed:
            dims = ", ".join(item.dims)
            lines.append(f"| `{item.name}` | {dims} | {item.units} | {item.long_name} |")
    return "\n".join(lines) + "\n"


def _write_references(app: Sphinx) -> None:
    """Write the pages of the keys of configurations and of the variables of files."""
    folder = Path(app.srcdir) / "api"
    folder.mkdir(exist_ok=True)
    (folder / "configuration.md").write_text(_configuration_page(), encoding="utf-8")
    (folder / "variables.md").write_text(_variables_page(), encoding="utf-8")


def setup(app: Sphinx) -> None:
    """Draw formulas, link names, and leave out what is not ours before numpydoc reads what is."""
    app.add_html_math_renderer("mathml", (_visit_math, None), (_visit_displaymath, None))
    app.connect("autodoc-skip-member", _is_foreign)
    app.connect("autodoc-process-docstring", _escape_magnitudes, priority=400)
    app.connect("autodoc-process-docstring", _describe_options, priority=600)
    app.connect("builder-inited", _write_references)
    app.connect("doctree-resolved", _link_names)
    app.connect("build-finished", _check_network)
