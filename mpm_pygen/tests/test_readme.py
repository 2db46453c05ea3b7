"""The commands and the Python of the README run as they stand there."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from runs import Array, square_body, write_frame

from mpm_pygen import read_config, read_points
from mpm_pygen.cli import main

README = Path(__file__).resolve().parents[1] / "README.md"
SECTIONS = dict(
    re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", README.read_text("utf-8"), re.MULTILINE | re.DOTALL)
)


def _code(section: str) -> str:
    """Give the indented lines of a section."""
    lines = SECTIONS[section].splitlines()
    return "\n".join(line[4:] for line in lines if line.startswith("    "))


def _commands(section: str) -> list[list[str]]:
    """Give the calls of mpm-pygen in a section."""
    calls = _code(section).replace("\\\n", " ").splitlines()
    return [shlex.split(call, comments=True)[1:] for call in calls if call.startswith("mpm-pygen")]


def _run(folder: Path) -> None:
    """Write three frames of two blocks and of a ball, and their configs."""
    config = read_config(README.parents[1] / "configs" / "two_blocks" / "two_blocks.cfg")
    (folder / "two_blocks.cfg").write_text(config.text())
    config.job.sim_type = 4
    (folder / "ball_axisymmetric.cfg").write_text(config.text())
    for k in range(3):
        bodies: dict[str, dict[str, Array]] = {}
        for body, x in (("block_0", 0.1), ("block_1", 0.6)):
            fields = square_body((x, 0.1), 3, 0.1, (0, k, 0))
            fields["cauchy_stress"] = np.tile(-k * np.eye(3), (9, 1, 1))
            bodies[body] = fields
        write_frame(folder / "output" / "two_blocks", k, 0.1 * k, bodies, (4, 4))
        write_frame(folder / "output" / "ball_axisymmetric", k, 0.1 * k, bodies, (4, 4))


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work where the files are that the README speaks of, with a program that takes all."""
    monkeypatch.chdir(tmp_path)
    Image.new("RGB", (4, 4), "#ff0000").save("drawing.png")
    trimesh.creation.box((100.0, 100.0, 100.0)).export("part.stl")
    (tmp_path / "mpm3d").write_text("#!/bin/sh\nexit 0\n")
    (tmp_path / "mpm3d").chmod(0o755)
    monkeypatch.setenv("MPM3D", str(tmp_path / "mpm3d"))


def test_commands_for_points() -> None:
    """Each makes a file that reads back."""
    commands = _commands("Points: the command")
    assert {words[0] for words in commands} == {
        "block",
        "circle",
        "cylinder",
        "sphere",
        "image",
        "fill",
    }
    for words in commands:
        assert main(words) == 0
        points = read_points(words[words.index("-o") + 1], int(words[words.index("--type") + 1]))
        assert len(points) > 0


def test_shapes_of_the_table() -> None:
    """Every name of the table is one of an expression, and the other way round."""
    from mpm_pygen.shape_text import MAKERS

    named = set(re.findall(r"`(\w+)\(", SECTIONS["Shapes"]))
    assert named == set(MAKERS)


def test_python_of_points_and_configs() -> None:
    """The code runs; what it makes is what it says."""
    names: dict[str, object] = {}
    exec(_code("Points: from Python"), names)
    assert read_points("block_0.points", 2).velocity[:, 1].any()
    assert set(names["bodies"]) == {"#ff0000"}  # type: ignore[call-overload]
    exec(_code("Configs").split("mpm-pygen scene")[0], names)
    assert Path("spin/spin.cfg").is_file() and Path("spin/disc.points").is_file()
    for words in _commands("Configs"):
        assert main(words) == 0
    assert Path("fine/two_blocks.cfg").is_file()


def test_commands_and_python_for_results(tmp_path: Path) -> None:
    """On made-up frames of the same names; MP4 is left to a test of its own."""
    _run(tmp_path)
    for words in _commands("Results: the command"):
        assert main(words) == 0, words
    for name in (
        "two_blocks.png",
        "three.png",
        "run.gif",
        "ball.png",
        "history.csv",
        "history.png",
    ):
        assert Path(name).stat().st_size > 0, name
    for words in re.findall(r"`mpm-pygen ([^`]+)`", SECTIONS["Results: the command"]):
        assert main(shlex.split(words)) == 0, words
    code = _code("Results: from Python")
    node_field = "contact_force_by_block_1_on_block_0"
    assert node_field in code
    names: dict[str, object] = {}
    exec(
        code.replace(node_field, "contact_force_by_a_on_b").replace("frames[10]", "frames[1]"),
        names,
    )
    assert names["highest"].tolist() == [0.0, 1.0, 2.0]  # type: ignore[attr-defined]
