"""The manual: its reference is up to date, its links lead somewhere, its configs run."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from checkpoints import FISH, MIXTURE
from meshes import CELLS, MESH, TRIANGLES, needs_mesh, type_of, write_mesh
from scene import DIM, MATERIALS, NVEL, Array, Run

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "docs" / "reference"
DOCUMENTS = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
FIGURES = REFERENCE / "figures"
PAGES = sorted(set(REFERENCE.glob("*/*.md")) - set(REFERENCE.glob("notes/*.md")))

FENCED = re.compile(r"^```(.*?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)

# A config in which the example of a class takes the place of what has the same role.
SECTIONS = {
    "job": "job { dt = 1e-3 TYPE = 2 }",
    "serializer": """serializer
{
    class = "DefaultVTK"
    properties = {0}
    str-properties = {"output", "save", "test"}
}""",
    "driver": 'driver { class = "DefaultDriver" properties = {1} }',
    "solver": 'solver { class = "ExplicitUSL" }',
    "grid": """grid
{
    class = "CartesianLinear"
    properties = {1, 1}
    int-properties = {20, 20}
}""",
}
PARTS = {
    "points": '    point-class = "DefaultPoints"\n    point-file = "block.points"',
    "nodes": '    node-class = "DefaultNodes"',
    "material": '    material-class = "IsotropicLinearElasticity"\n    material-props = {1e5, 0.3}',
    "boundary": '    boundary-class = "CartesianBox"',
}
# Names of the bodies that examples speak of.
BODIES = ("block_0", "block_1", "projectile")
LATTICE = "Lx = {1, 1}\nNx = {20, 20}\nlmpp = 2\nrho = 1000\n"
BOX = 'part { class = "Box" properties = {0.2, 0.2, 0.4, 0.4} }\n'


def name_of(path: Path) -> str:
    """Return the path of a document for the name of a test."""
    return str(path.relative_to(ROOT))


def fenced(path: Path) -> Iterator[tuple[list[str], str]]:
    """Yield the words behind the fence and the text of each fenced block."""
    for info, text in FENCED.findall(path.read_text("utf-8")):
        yield info.split(), text


def anchors(path: Path) -> set[str]:
    """Return the anchors of the headings of a document."""
    text = FENCED.sub("", path.read_text("utf-8"))
    found = set()
    for heading in HEADING.findall(text):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        found.add(re.sub(r"[^\w\- ]", "", words).replace(" ", "-"))
    return found


@pytest.mark.parametrize("document", DOCUMENTS, ids=name_of)
def test_links_lead_somewhere(document: Path) -> None:
    """Every relative link names a file of the project, and a heading in it."""
    for link in LINK.findall(FENCED.sub("", document.read_text("utf-8"))):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (document.parent / path).resolve() if path else document
        assert target.exists(), f"{link}: there is no {target}"
        assert target.is_relative_to(ROOT), f"{link} leads out of the project"
        if anchor:
            assert anchor in anchors(target), f"{link}: no such heading"


@pytest.mark.parametrize("document", DOCUMENTS, ids=name_of)
def test_no_heading_is_empty(document: Path) -> None:
    """Behind each heading stands text, or a heading below it."""
    text = FENCED.sub("text", document.read_text("utf-8"))
    levels = [len(line.split()[0]) for line in re.findall(r"^#+ .*$", text, re.MULTILINE)]
    bodies = re.split(r"^#+ .*$", text, flags=re.MULTILINE)[1:]
    for i, body in enumerate(bodies):
        below = i + 1 < len(levels) and levels[i + 1] > levels[i]
        assert body.strip() or below, f"heading {i + 1} of {document.name}"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_pages_are_complete(page: Path) -> None:
    """A class has a purpose, properties, an example, theory or fields, a source and its checks."""
    text = page.read_text("utf-8")
    headings = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert headings[:2] == ["Properties", "Example"]
    assert "Source" in headings
    assert headings[-1] == "Checks"
    assert set(headings) - {"Properties", "Example", "Remarks", "Source", "Checks"}
    purpose = text.split("Code: [")[1].split("\n\n")[1]
    assert purpose[0].isupper()
    assert purpose[-1] == "."


def test_diagrams_are_up_to_date(tmp_path: Path) -> None:
    """docs/images/make_diagrams.py draws the files that are there."""
    script = ROOT / "docs" / "images" / "make_diagrams.py"
    subprocess.run([sys.executable, script, tmp_path], check=True)
    drawn = sorted(tmp_path.glob("*.svg"))
    assert len(drawn) == 3
    for path in drawn:
        assert path.read_bytes() == (script.parent / path.name).read_bytes(), path.name


def test_every_class_has_an_up_to_date_page(executable: Path, tmp_path: Path) -> None:
    """Writing the reference anew changes nothing; scripts/docs repairs it."""
    command = [sys.executable, ROOT / "scripts" / "docs", executable, "--to", tmp_path]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    figures = {path.name for path in (tmp_path / "figures").iterdir()}
    assert figures == {path.name for path in FIGURES.iterdir()}
    shown = re.compile(r"\(\.\./figures/(.*)\)")
    assert figures == {name for page in PAGES for name in shown.findall(page.read_text("utf-8"))}
    written = {path.relative_to(tmp_path): path for path in tmp_path.rglob("*.md")}
    kept = {path.relative_to(REFERENCE): path for path in [*PAGES, *REFERENCE.glob("*.md")]}
    assert len(written) > 10
    assert written.keys() == kept.keys()
    for name, path in written.items():
        assert path.read_text("utf-8") == kept[name].read_text("utf-8"), f"{name} is out of date"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_pages_name_their_source_file(page: Path) -> None:
    """A page stands at the place that the source file of its class has."""
    source = ROOT / "src" / page.parent.name / f"{page.stem}.f90"
    assert source.is_file()
    assert f"(../../../src/{page.parent.name}/{page.stem}.f90)" in page.read_text("utf-8")


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_example_is_accepted(mpm3d: Run, page: Path, tmp_path: Path) -> None:
    """The example of a class works inside a complete config."""
    role = re.search(r"^Role: \[(\w+)\]", page.read_text("utf-8"), re.MULTILINE)
    assert role
    example = next(text for words, text in fenced(page) if words == ["cfg"])
    write_example(role[1], example, tmp_path)
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    class_name = re.search(r'class = "(\w+)"', example)
    assert class_name
    assert class_name[1] == re.search(r"^# (\w+)$", page.read_text("utf-8"), re.MULTILINE)[1]


def write_example(role: str, example: str, folder: Path) -> None:
    """Write a config that uses an example, and the points files that examples name."""
    sections, parts, first, contact = dict(SECTIONS), dict(PARTS), "", ""
    generator = LATTICE + BOX
    sim_type = type_of(example)
    dim = DIM[sim_type]
    sections["job"] = sections["job"].replace("TYPE = 2", f"TYPE = {sim_type}")
    write_mesh(folder / MESH, max(2, dim), CELLS[sim_type])
    if needs_mesh(example):
        sections["grid"] = TRIANGLES
    if role in sections:
        sections[role] = example
        if role == "driver" and "Fish" in example:
            parts["material"] = FISH
            (folder / "mixture.txt").write_text(MIXTURE)
    elif role == "part":
        parts["points"] = '    point-class = "CartesianPoints"\n    point-file = "block.parts"'
        generator = LATTICE + example
    elif role in parts:
        parts[role], _, text = example.partition("# block.parts\n")
        generator = text or generator
    elif role == "body":
        first = example
    else:
        assert role in ("contact", "probe")
        contact = example
        if role == "probe":
            plain = "properties = {0}"
            assert plain in sections["serializer"]
            more = "properties = {0, history_rate = 10}"
            sections["serializer"] = sections["serializer"].replace(plain, more)
    wanted = next((own for name, own in MATERIALS.items() if f'"{name}"' in example), {})
    bodies = [
        f'body\n{{\n    class = "DefaultBody"\n    name = "{name}"\n'
        + "\n".join({**parts, "material": wanted.get(name, parts["material"])}.values())
        + "\n}"
        for name in BODIES
    ]
    if first:
        bodies[0] = first
    config = [*sections.values(), *bodies, contact]
    (folder / "scene.cfg").write_text("\n".join(config) + "\n", "utf-8")
    (folder / "block.parts").write_text(generator, "utf-8")
    for name in ("block", *BODIES):
        numbers = ["0.5"] * dim + ["0"] * NVEL[sim_type]
        (folder / f"{name}.points").write_text(f"1\n0.625 6.25e-4 {' '.join(numbers)} 1\n", "utf-8")


@pytest.mark.parametrize(
    "document", [ROOT / "README.md", ROOT / "docs" / "3_running.md"], ids=name_of
)
def test_complete_configs_are_accepted(mpm3d: Run, document: Path, tmp_path: Path) -> None:
    """Configs marked as complete pass --check with the points made by the commands beside them."""
    checked = 0
    make_tools(tmp_path)
    for words, text in fenced(document):
        if words == ["sh", "points"]:
            run_commands(text, tmp_path)
        if words[:2] == ["cfg", "complete"]:
            path = tmp_path / words[2]
            path.write_text(text, "utf-8")
            result = mpm3d("-c", words[2], "--check", cwd=tmp_path)
            assert result.returncode == 0, result.stderr
            assert result.stderr == ""
            assert "BELOW dt" not in result.stdout
            checked += 1
    assert checked > 0


def make_tools(folder: Path) -> None:
    """Make the folder look like the root of the project to the commands of the manual."""
    (folder / "mpm_pygen").symlink_to(ROOT / "mpm_pygen")
    (folder / "bin").mkdir()
    python = folder / "bin" / "python3"
    python.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} "$@"\n', "utf-8")
    python.chmod(0o755)


def run_commands(text: str, folder: Path) -> None:
    """Run shell commands."""
    environment = {
        **os.environ,
        "PATH": f"{folder / 'bin'}:{os.environ['PATH']}",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = ["bash", "-euo", "pipefail", "-c", text]
    subprocess.run(command, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL)


def growth(n: int, offset: float, courant: float) -> float:
    """Return the largest factor by which a step multiplies a motion of a free bar.

    The bar has 8 cells of side 1, n points in each, and starts `offset` behind a node line. Step:
    ExplicitUSL with cpdi = 1; velocities and strains of the points are the state.
    """
    x = 3.0 + offset + (np.arange(8 * n) + 0.5) / n
    nodes = np.arange(16.0)
    a = 0.25 / n

    def hats(positions: Array) -> Array:
        return np.maximum(0.0, 1.0 - np.abs(positions[:, None] - nodes))

    value = 0.5 * (hats(x + a) + hats(x - a))
    slope = (hats(x + a) - hats(x - a)) / (2.0 * a)
    reached = value.sum(axis=0) > 0.0
    value, slope = value[:, reached], slope[:, reached]
    mass = value.sum(axis=0)[:, None]
    to_nodes = value.T / mass
    force = -(courant**2) * slope.T / mass
    step = np.block(
        [
            [np.eye(x.size), value @ force],
            [slope @ to_nodes, np.eye(x.size) + slope @ force],
        ]
    )
    return float(np.abs(np.linalg.eigvals(step)).max())


def test_limits_of_free_edges() -> None:
    """The table of the manual: steps of that size are stable for all positions, no longer ones."""
    text = (ROOT / "docs" / "3_running.md").read_text("utf-8")
    row = re.search(r"^\| c dt/h at most \| (.*) \|$", text, re.MULTILINE)
    assert row
    # Eigenvalues at the unit circle may be multiple ones, which rounding moves by sqrt(epsilon).
    slack = 1.0 + 64.0 * np.sqrt(np.finfo(float).eps)
    offsets = np.arange(0.5, 100.0) / 100.0
    for n, courant in enumerate(map(float, row[1].split(" | ")), start=1):
        assert max(growth(n, offset, courant) for offset in offsets) <= slack
        # The table has two digits.
        longer = courant + 0.02
        assert max(growth(n, offset, longer) for offset in offsets) > slack
