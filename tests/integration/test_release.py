"""What states the version, the licence and how to cite: the files agree with each other."""

from __future__ import annotations

import datetime
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from scene import Run

ROOT = Path(__file__).resolve().parents[2]
#: Keys that the Citation File Format 1.2.0 requires, and those of ours that it knows.
REQUIRED = {"cff-version", "message", "title", "authors"}
KNOWN = (
    REQUIRED
    | {"type", "version", "date-released", "license", "abstract", "keywords"}
    | {"references"}
)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def read(name: str) -> str:
    """Return the text of a file of the project."""
    return (ROOT / name).read_text("utf-8")


@pytest.fixture(scope="module")
def version() -> str:
    """Return the version, which CMakeLists.txt sets."""
    found = re.search(r"^project\(mpm3d VERSION (\S+) ", read("CMakeLists.txt"), re.MULTILINE)
    assert found
    return found[1]


@pytest.fixture(scope="module")
def citation() -> dict[str, Any]:
    """Return what CITATION.cff says."""
    return dict(yaml.safe_load(read("CITATION.cff")))


def test_version_is_semantic(version: str) -> None:
    """Three numbers without leading zeros, the first of them 0 while interfaces may change."""
    assert re.fullmatch(r"0\.(0|[1-9]\d*)\.(0|[1-9]\d*)", version)


def test_versions_agree(mpm3d: Run, tmp_path: Path, version: str, citation: dict[str, Any]) -> None:
    """The program, mpm_pygen and the ways to cite have the version of CMakeLists.txt."""
    assert mpm3d("--version", cwd=tmp_path).stdout.startswith(f"mpm3d {version} (")
    assert tomllib.loads(read("mpm_pygen/pyproject.toml"))["project"]["version"] == version
    assert citation["version"] == version
    assert re.findall(r"version = \{(.*)\}", read("docs/citing.md")) == [version]
    minor = version.rpartition(".")[0]
    for page in ("docs/2_installing.md", "docs/tutorials/own_material.md"):
        assert re.findall(r"find_package\(mpm3d (\S+) ", read(page)) == [minor], page


def test_changelog(version: str, citation: dict[str, Any]) -> None:
    """Keep a Changelog: Unreleased, then versions with their dates, each with kinds of changes."""
    text = read("CHANGELOG.md")
    assert text.startswith("# Changelog\n")
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert headings[0] == "[Unreleased]"
    released = [re.fullmatch(r"\[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)", h) for h in headings[1:]]
    assert all(released)
    versions = [match[1] for match in released if match]
    dates = [datetime.date.fromisoformat(match[2]) for match in released if match]
    assert versions[0] == version
    assert dates[0].isoformat() == citation["date-released"]
    assert sorted(dates, reverse=True) == dates
    ordered = sorted(versions, key=lambda text: [*map(int, text.split("."))], reverse=True)
    assert ordered == versions
    kinds = set(re.findall(r"^### (.*)$", text, re.MULTILINE))
    assert kinds <= {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}


def test_citation_file(citation: dict[str, Any]) -> None:
    """CITATION.cff has what the format requires, in the types that it asks for."""
    assert REQUIRED <= citation.keys() <= KNOWN
    assert citation["cff-version"] == "1.2.0"
    assert citation["type"] == "software"
    for key in ("message", "title", "version", "date-released", "license", "abstract"):
        assert isinstance(citation[key], str), key
        assert citation[key].strip(), key
    for author in citation["authors"]:
        assert author.keys() in ({"name"}, {"family-names", "given-names"})
    assert all(isinstance(word, str) for word in citation["keywords"])
    assert len(set(citation["keywords"])) == len(citation["keywords"])
    for work in citation["references"]:
        assert {"type", "title", "authors"} <= work.keys()
    assert citation["title"] in read("docs/citing.md")


def test_licence(citation: dict[str, Any]) -> None:
    """The MIT licence, of the mpm3d contributors; every file that names a licence names it."""
    text = read("LICENSE")
    assert text.startswith("MIT License\n")
    assert re.search(r"^Copyright \(c\) \d{4} the mpm3d contributors$", text, re.MULTILINE)
    assert citation["license"] == "MIT"
    assert tomllib.loads(read("mpm_pygen/pyproject.toml"))["project"]["license"] == "MIT"


@pytest.mark.parametrize("name", ["CHANGELOG.md", "CONTRIBUTING.md"])
def test_links(name: str) -> None:
    """Links lead to files of the project."""
    links = [link.partition("#")[0] for link in LINK.findall(read(name))]
    local = [link for link in links if not re.match(r"[a-z]+:", link)]
    assert local
    assert [link for link in local if not (ROOT / link).exists()] == []
