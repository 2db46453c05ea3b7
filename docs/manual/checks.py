"""Where each class is checked: its unit tests, the verification, the scenes that use it."""

from __future__ import annotations

import re
from pathlib import Path

from figures import FIGURES, figure_text

ROOT = Path(__file__).resolve().parents[2]
#: From a page of the class reference to the root of the project.
UP = "../../.."
TEST = re.compile(r"@test\b.*\n\s*subroutine test_(\w+)")
CASE = re.compile(r"^## (.*?) ?\((\w+)\)$", re.MULTILINE)
#: Classes that many cases use are not listed case by case.
MANY = 8
#: A class in no more scenes than that shows the picture of the first one, if it has no figure.
FEW = 3


def words(path: Path) -> set[str]:
    """Return the words of a file."""
    return set(re.findall(r"\w+", path.read_text("utf-8")))


def unit_tests(folder: str, stem: str) -> list[Path]:
    """Return the files of unit tests of a class."""
    others = {path.stem for path in (ROOT / "src" / folder).glob("*.f90")} - {stem}
    return [
        path
        for path in sorted((ROOT / "tests" / "unit" / folder).glob(f"test_{stem}*.pf"))
        if path.stem.removeprefix("test_") not in others
        and not any(
            other.startswith(f"{stem}_") and path.stem.startswith(f"test_{other}")
            for other in others
        )
    ]


def anchor(heading: str) -> str:
    """Return the anchor of a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def cases() -> dict[str, str]:
    """Return links to the results of all cases of the verification, by the name of the case."""
    links = {}
    for page in sorted((ROOT / "docs" / "verification").glob("*.md")):
        for title, name in CASE.findall(page.read_text("utf-8")):
            place = f"../../verification/{page.name}#{anchor(f'{title} ({name})')}"
            links[name] = f"[{title[0].lower() + title[1:]}]({place})"
    return links


def verification(name: str) -> str:
    """Return the line on the verification with a class, if there is any."""
    links = cases()
    # Files whose names begin with _ are what cases share.
    users = [
        path.stem
        for path in sorted((ROOT / "verification" / "cases").glob("*.py"))
        if name in words(path)
    ]
    shared = [stem for stem in users if stem.startswith("_")]
    harness = any(name in words(path) for path in (ROOT / "verification" / "harness").glob("*.py"))
    found = [links[stem] for stem in users if stem in links]
    if shared or harness or len(found) > MANY:
        return "Verification: many rows of the [matrix](../../verification/README.md)."
    return f"Verification: {', '.join(found)}." if found else ""


def scenes(name: str) -> list[str]:
    """Return the names of the scenes with a class."""
    pattern = re.compile(rf'"{name}"')
    found = sorted(
        path.parent.name
        for path in (ROOT / "configs").glob("*/*")
        if path.suffix in (".cfg", ".parts") and pattern.search(path.read_text("utf-8"))
    )
    return list(dict.fromkeys(found))


def picture(scene: str) -> str:
    """Return the picture of a scene, with the words of its README."""
    readme = (ROOT / "configs" / scene / "README.md").read_text("utf-8")
    (words,) = re.findall(rf"^!\[(.*)\]\(.*/{scene}\.png\)$", readme, re.MULTILINE)
    place = f"../../images/{scene}.png"
    return f"![{words}]({place})\n\n*Scene [{scene}]({UP}/configs/{scene}/README.md): {words}.*\n"


def checks_text(name: str, folder: str, stem: str) -> str:
    """Return the section of a page on the checks of a class."""
    lines = ["## Checks", "", *figure_text(name, cases())]
    found = scenes(name)
    if found and len(found) <= FEW and name not in FIGURES:
        lines.append(picture(found[0]))
    for path in unit_tests(folder, stem):
        place = f"{UP}/{path.relative_to(ROOT)}"
        tests = TEST.findall(path.read_text("utf-8"))
        told = "; ".join(test.replace("_", " ") for test in tests)
        lines.append(f"- [Unit tests]({place}): {told}.")
    links = [f"[{scene}]({UP}/configs/{scene}/README.md)" for scene in found]
    shown = f"Scenes, with pictures: {', '.join(links)}." if links else ""
    for line in (verification(name), shown):
        if line:
            lines.append(f"- {line}")
    # Parts are gone when a run begins, and have nothing to save.
    restart = "" if folder == "parts" else ", and restarts it from a checkpoint to the same bytes"
    lines.append(f"- Every run of the tests accepts the example of this page{restart}.")
    return "\n".join(lines) + "\n"
