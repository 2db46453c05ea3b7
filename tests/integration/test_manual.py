"""What scripts/manual does to the pages that it has built: dead links are found, or taken out."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "docs" / "manual" / "finish.py"


def finish(folder: Path) -> tuple[int, list[str]]:
    """Finish a manual; return the exit status and the lines of the standard error."""
    command = [sys.executable, SCRIPT, folder]
    done = subprocess.run(command, capture_output=True, encoding="utf-8")
    return done.returncode, done.stderr.splitlines()


def test_dead_links_are_found(tmp_path: Path) -> None:
    """A file, an anchor and a picture that are not there are told; all else is fine."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.html").write_text(
        '<h1 id="top">A</h1> <a href="sub/b.html#there">b</a> <a href="#top">top</a>'
        '<a href="sub/b.html#gone">b</a> <a href="c.html">c</a> <img src="d.png">'
        '<a href="https://example.org/x">x</a>'
    )
    (tmp_path / "sub" / "b.html").write_text('<p id="there"> <a href="../a.html">a</a>')
    assert finish(tmp_path) == (
        1,
        [
            "a.html: c.html: no such file",
            "a.html: d.png: no such file",
            "a.html: sub/b.html#gone: no such anchor",
        ],
    )


def test_pages_of_the_api_need_no_network(tmp_path: Path) -> None:
    """Scripts and styles of other hosts, and links to pages that FORD does not write, are gone."""
    page = tmp_path / "api" / "a.html"
    page.parent.mkdir()
    page.write_text(
        '<link href="https://example.org/x.css"\n rel="stylesheet"><link href="own.css">'
        '<script src="https://example.org/x.js"\n id="x"></script><script src="own.js"></script>'
        '<a href="private.html">name</a>'
    )
    for name in ("own.css", "own.js"):
        (page.parent / name).touch()
    assert finish(tmp_path) == (0, [])
    assert page.read_text() == ('<link href="own.css"><script src="own.js"></script><a >name</a>')
