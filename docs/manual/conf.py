"""Sphinx configuration of the manual; scripts/manual calls Sphinx from the root of the project.

The pages are the Markdown files as they stand, with the links that also work in the repository.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from docutils import nodes
from latex2mathml.converter import convert
from pygments.lexer import RegexLexer
from pygments.token import Comment, Name, Number, Punctuation, String, Text
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

ROOT = Path(__file__).resolve().parents[2]
#: Folder of the API, which FORD writes: what links to Fortran sources and to src lead to.
API = "api"
LINK = re.compile(r"(?<=\]\()(?![a-z]+:|#)([^)\s#]+)")
LOG = logging.getLogger(__name__)

project = "mpm3d"
author = "the mpm3d contributors"
copyright = author
# CMakeLists.txt is where the version is set.
BUILD = (ROOT / "CMakeLists.txt").read_text("utf-8")
release = BUILD.partition("project(mpm3d VERSION ")[2].split()[0]
root_doc = "README"
include_patterns = [
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "docs/**.md",
    "configs/**README.md",
    "mpm_pygen/README.md",
    "tests/fuzz/README.md",
    "tests/pfunit/README.md",
]
exclude_patterns = ["build", "docs/reference/notes", "docs/manual", "output", ".git"]
extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 6
myst_url_schemes = ["http", "https", "mailto", "source"]
nitpicky = True
highlight_language = "none"
html_theme = "furo"
html_title = f"mpm3d {release}"
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False

#: Contents of the manual in the margin. Pages that stand in none of the lists come last.
CHAPTERS = {
    "Manual": [
        "docs/README",
        "docs/1_overview",
        "docs/2_installing",
        "docs/3_running",
        "docs/4_framework",
        "docs/reference/README",
    ],
    "Tutorials": ["docs/tutorials/first_scene", "docs/tutorials/own_material"],
    "Help": [
        "docs/troubleshooting",
        "docs/reference/messages",
        "docs/glossary",
        "docs/differences",
        "docs/citing",
    ],
    "Project": ["CHANGELOG", "CONTRIBUTING"],
    "Scenes and tools": ["docs/scenes", "configs/README", "mpm_pygen/README"],
    "Evidence": [
        "docs/which_method",
        "docs/verification",
        "docs/verification/README",
        "docs/performance",
    ],
}
#: Names in the margin, where they differ from those of the pages.
TITLES = {
    "docs/README": "Contents",
    "docs/reference/README": "5 Classes",
    "docs/tutorials/first_scene": "From an empty folder to a picture",
    "docs/tutorials/own_material": "A material in one file",
    "docs/scenes": "Pictures of the scenes",
    "configs/README": "Configs of the scenes",
}
#: Pages below a page.
BELOW = {
    "docs/reference/README": "docs/reference/*/*.md",
    "configs/README": "configs/*/README.md",
    "docs/verification/README": "docs/verification/*.md",
}


class ConfigLexer(RegexLexer):
    """Colours of configs."""

    name = "mpm3d config"
    aliases = ("cfg",)
    tokens = {  # noqa: RUF012
        "root": [
            (r"#.*$", Comment.Single),
            (r"\"[^\"\n]*\"|'[^'\n]*'", String),
            (r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?(?![\w.])", Number),
            (r"[\w.-]+(?=\s*=)", Name.Attribute),
            (r"[\w./-]+(?=\s*\{)", Name.Class),
            (r"[{}=,]", Punctuation),
            (r"[^\s{}=,#\"']+|\s+|.", Text),
        ]
    }


def pages_below(name: str) -> list[str]:
    """Return the names of the pages that stand below a page."""
    pattern = BELOW.get(name)
    if pattern is None:
        return []
    names = [str(path.relative_to(ROOT).with_suffix("")) for path in ROOT.glob(pattern)]
    return sorted(other for other in names if other != name and "/notes/" not in other)


def tree(names: list[str], caption: str = "") -> str:
    """Return a list of contents for the margin."""
    head = f":hidden:\n:caption: {caption}\n" if caption else ":hidden:\n"
    lines = [f"{TITLES[name]} </{name}>" if name in TITLES else f"/{name}" for name in names]
    return "\n\n```{toctree}\n" + head + "\n" + "\n".join(lines) + "\n```\n"


def contents(app: Sphinx, name: str) -> str:
    """Return the lists of contents that belong to a page."""
    if name != root_doc:
        below = pages_below(name)
        return tree(below) if below else ""
    found = app.env.found_docs
    listed = {root_doc, *(page for chapter in CHAPTERS.values() for page in chapter)}
    listed |= {page for parent in BELOW for page in pages_below(parent)}
    chapters = {**CHAPTERS, "More": sorted(found - listed)}
    text = ""
    for caption, pages in chapters.items():
        present = [page for page in pages if page in found]
        if present:
            text += tree(present, caption)
    return text


def prepare(app: Sphinx, name: str, source: list[str]) -> None:
    """Give a page its contents, and links that Sphinx knows."""
    folder = (ROOT / name).parent

    def known(match: re.Match[str]) -> str:
        target = (folder / match[1]).resolve()
        if target == ROOT / "src":
            return "source:index"
        if target.suffix in (".f90", ".F90") and target.is_relative_to(ROOT / "src"):
            if not target.is_file():
                LOG.warning("%s: there is no %s", name, match[1])
            return f"source:{target.name}"
        if (target / "README.md").is_file():
            return match[1].rstrip("/") + "/README.md"
        return match[1]

    source[0] = LINK.sub(known, source[0]) + contents(app, name)


def find_sources(app: Sphinx, doctree: nodes.document, name: str) -> None:
    """Let links to sources lead to the pages of the API."""
    for link in doctree.findall(nodes.reference):
        scheme, _, file = link.get("refuri", "").partition(":")
        if scheme == "source":
            page = "index" if file == "index" else f"sourcefile/{file}"
            link["refuri"] = os.path.relpath(f"{API}/{page}.html", Path(name).parent)


def show_formula(self: HTML5Translator, node: nodes.Element) -> None:
    """Write a formula as MathML, which needs no script and no network."""
    block = isinstance(node, nodes.math_block)
    formula = convert(node.astext(), display="block" if block else "inline")
    self.body.append(f"<div>{formula}</div>" if block else formula)
    raise nodes.SkipNode


def setup(app: Sphinx) -> None:
    """Connect the functions of this file."""
    app.add_lexer("cfg", ConfigLexer)
    app.add_html_math_renderer("mathml", (show_formula, None), (show_formula, None))
    app.connect("source-read", prepare)
    app.connect("doctree-resolved", find_sources)
