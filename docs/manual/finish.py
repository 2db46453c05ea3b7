#!/usr/bin/env python3
"""Finish the built manual: pages of the API that need no network, links that lead somewhere.

usage: finish.py FOLDER

In the folder api, FORD's pages lose the scripts and styles that a browser would fetch from other
hosts, and links to private procedures, for which FORD writes no page, become plain text. Then every
link, anchor and picture of all pages is looked up; those to other hosts are not. Exit status 1,
with a line for each that leads nowhere.
"""

from __future__ import annotations

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: What a browser would fetch from other hosts.
FETCHED = re.compile(
    r"<link\b[^>]*href=\"https?:[^>]*>"
    r"|<script\b[^>]*(src=\"https?:|x-mathjax)[^>]*>.*?</script>",
    re.DOTALL,
)


class Page(HTMLParser):
    """Links and anchors of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.feed(path.read_text("utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep what a tag links to and what it is called."""
        for key, value in attrs:
            if value is None:
                continue
            if key == "id" or (key == "name" and tag == "a"):
                self.anchors.add(value)
            elif key == "src" or (key == "href" and tag in ("a", "link")):
                self.links.append(value)


def dead_links(folder: Path) -> list[tuple[Path, str, str]]:
    """Return page, link and fault of each link that leads nowhere."""
    pages = {path.resolve(): Page(path) for path in sorted(folder.rglob("*.html"))}
    dead: set[tuple[Path, str, str]] = set()
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            anchor = unquote(parts.fragment)
            if not target.is_file():
                dead.add((path.relative_to(folder), link, "no such file"))
            elif anchor and target in pages and anchor not in pages[target].anchors:
                dead.add((path.relative_to(folder), link, "no such anchor"))
    return sorted(dead)


def keep_local(page: Path) -> None:
    """Take out of a page what a browser would fetch from other hosts."""
    text = page.read_text("utf-8")
    page.write_text(FETCHED.sub("", text), "utf-8")


def unlink(page: Path, link: str) -> None:
    """Make plain text of a link."""
    text = page.read_text("utf-8")
    page.write_text(text.replace(f'href="{link}"', "").replace(f"href='{link}'", ""), "utf-8")


def main() -> int:
    """Finish and check a folder."""
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    folder = Path(sys.argv[1]).resolve()
    for path in (folder / "api").rglob("*.html"):
        keep_local(path)
    for page, link, _ in dead_links(folder):
        if page.parts[0] == "api":
            unlink(folder / page, link)
    dead = dead_links(folder)
    for page, link, fault in dead:
        print(f"{page}: {link}: {fault}", file=sys.stderr)
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main())
