"""Configs: their text, reading them back, the scenes of `configs/`, the program's check."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from mpm_pygen import PygenError, read_points
from mpm_pygen.cli import main
from mpm_pygen.config import Body, Config, Job, Object, Parts, check_config
from mpm_pygen.config_reader import read_config, read_parts
from mpm_pygen.scenes import SCENES, two_blocks

CONFIGS = Path(__file__).resolve().parents[2] / "configs"

TEXT = """\
# A remark
# of two lines

job
{
    t = 0
    dt = 0.001
    TYPE = 2
    threads = 2
}

serializer
{
    class = "DefaultVTK"
    properties = {60}
    str-properties = {"out put", "", 'a "b"'}
}

driver
{
    class = "DefaultDriver"
    properties = {t_stop = 1.5}
}

solver
{
    class = "ExplicitUSL"
}

grid
{
    class = "CartesianLinear"
    properties = {1, 1}
    int-properties = {20, Ny = 10}
}

body
{
    class = "DefaultBody"
    name = "block"
    point-file = "block.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
    material-class = "IsotropicLinearElasticity"
    material-props = {100000, nu = 0.3}
}

contact
{
    class = "ContactHuang"
    name = "hit"
    properties = {1e-07}
    str-properties = {"block", "wall"}
}

probe
{
    class = "PlaneProbe"
    name = "gate"
    properties = {0.5}
    str-properties = {"x"}
}
"""


def _config() -> Config:
    """Make what the text says."""
    return Config(
        job=Job(dt=1e-3, sim_type=2, threads=2),
        serializer=Object("DefaultVTK", (60,), str_properties=("out put", "", 'a "b"')),
        driver=Object("DefaultDriver", {"t_stop": 1.5}),
        solver=Object("ExplicitUSL"),
        grid=Object("CartesianLinear", (1.0, 1.0), (20, {"Ny": 10})),
        bodies=[
            Body("block", material=Object("IsotropicLinearElasticity", (1e5, {"nu": 0.3}))),
        ],
        contacts=[Object("ContactHuang", (1e-7,), str_properties=("block", "wall"), name="hit")],
        probes=[Object("PlaneProbe", (0.5,), str_properties=("x",), name="gate")],
        remark="A remark\nof two lines",
    )


def test_text_of_a_config() -> None:
    """Exactly this."""
    assert _config().text() == TEXT


def test_config_reads_back(tmp_path: Path) -> None:
    """What was written is what was meant; free layout, comments and quotes do not matter."""
    path = tmp_path / "a.cfg"
    path.write_text(TEXT)
    assert read_config(path) == _config()
    loose = TEXT.replace("    t = 0\n    dt = 0.001\n", "dt=1e-3 t = 0 # 'comment\n")
    loose = loose.replace("{1, 1}", "1.0, 1.0").replace('"block"', "'block'")
    loose = loose.replace("{20, Ny", "{ 20 ,\n# more\n  Ny").replace("job\n{", "job {")
    assert loose != TEXT
    path.write_text(loose)
    assert read_config(path) == _config()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("}", "", "no place|no end"),
        ("dt = 0.001", "dt =", "no place|missing"),
        ("{60}", "{60", "a.cfg:1.: a comma or brace"),
        ("{60}", '{60, "a}', "a.cfg:15: a quote"),
        ("solver", "solve", "no section solver"),
        ("{t_stop = 1.5}", "{t_stop = }", "t_stop has no value"),
    ],
)
def test_malformed_configs_are_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    """With the line, where there is one."""
    path = tmp_path / "a.cfg"
    path.write_text(TEXT.replace(old, new, 1))
    with pytest.raises(PygenError, match=words):
        read_config(path)


def test_values_that_a_config_cannot_hold() -> None:
    """Two kinds of quotes, line ends, truth values, names before places."""
    for values in (("a\"b'c",), ("a\nb",), (True,), ({"a": 1}, 2)):
        config = _config()
        config.driver = Object("DefaultDriver", values)  # type: ignore[arg-type]
        with pytest.raises(PygenError):
            config.text()


@pytest.mark.parametrize("name", SCENES)
def test_scenes_are_those_of_the_folder(tmp_path: Path, name: str) -> None:
    """The config says the same; the points are those of make_points.sh, byte by byte."""
    scene = SCENES[name]()
    scene.write(tmp_path / "made" / f"{name}.cfg")
    assert read_config(tmp_path / "made" / f"{name}.cfg") == scene
    assert read_config(CONFIGS / name / f"{name}.cfg") == scene
    script = CONFIGS / name / "make_points.sh"
    if not script.is_file():
        made = read_parts(tmp_path / "made" / f"{name}.parts")
        assert made == read_parts(CONFIGS / name / f"{name}.parts") == scene.bodies[0].points
        return
    for command in _commands(script, tmp_path):
        assert main(command) == 0
    for body in scene.bodies:
        expected = (tmp_path / "scene" / body.point_file).read_bytes()
        assert (tmp_path / "made" / body.point_file).read_bytes() == expected


def _commands(script: Path, folder: Path) -> list[list[str]]:
    """Give the calls of mpm-pygen of a script, run on a copy, with the outputs in that copy."""
    (folder / "scene").mkdir()
    copy = shutil.copy(script, folder / "scene")
    record = folder / "record"
    record.write_text('#!/bin/sh\nshift 2\nprintf "%s\\n" "$@" "" >> "$RECORD"\n')
    record.chmod(0o755)
    environment = {**os.environ, "PYTHON": str(record), "RECORD": str(folder / "calls")}
    subprocess.run(["bash", copy], env=environment, check=True)
    calls = (folder / "calls").read_text().strip("\n").split("\n\n")
    found = [call.split("\n") for call in calls]
    for words in found:
        place = words.index("-o") + 1
        words[place] = str(folder / "scene" / words[place])
    return found


def test_scenes_follow_their_parameters() -> None:
    """Twice the cells: four times the points, half the step."""
    coarse, fine = two_blocks(), two_blocks(cells=40, per_cell=1)
    assert fine.job.dt == coarse.job.dt / 2
    counts = [[len(body.points) for body in c.bodies] for c in (coarse, fine, two_blocks(40))]  # type: ignore[arg-type]
    assert counts == [[144, 64], [144, 64], [576, 256]]


def _program(folder: Path, status: int) -> Path:
    """Make a stand-in for mpm3d: it says what it was called with, and ends with a status."""
    program = folder / "mpm3d"
    program.write_text(
        f'#!/bin/sh\nif [ {status} = 0 ]; then echo "$@"; head -1 block_0.points; fi\n'
        f'echo "$2:3: error: wrong" >&2\nexit {status}\n'
    )
    program.chmod(0o755)
    return program


def test_check_asks_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The config and its points are there when the program is called; its refusal is raised."""
    scene = two_blocks()
    assert scene.check(_program(tmp_path, 0)) == "-c scene.cfg --check\n144\n"
    with pytest.raises(PygenError, match=r"^scene.cfg:3: error: wrong$"):
        scene.check(_program(tmp_path, 2))
    monkeypatch.setenv("MPM3D", str(_program(tmp_path, 0)))
    assert scene.check().startswith("-c scene.cfg")
    scene.write(tmp_path / "two.cfg")
    assert check_config(tmp_path / "two.cfg").startswith("-c two.cfg --check")


def test_command_makes_a_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The folder has config and points; bad numbers and files end with status 2."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPM3D", str(_program(tmp_path, 0)))
    assert main(["scene", "two_blocks", "--cells", "40", "-o", "new/scene"]) == 0
    assert "accepted by mpm3d --check" in capsys.readouterr().out
    assert sorted(os.listdir("new/scene")) == ["block_0.points", "block_1.points", "two_blocks.cfg"]
    assert len(read_points("new/scene/block_0.points", 2)) == 576
    assert main(["check", "new/scene/two_blocks.cfg"]) == 0
    assert capsys.readouterr().out == "-c two_blocks.cfg --check\n576\n"
    assert main(["scene", "two_blocks", "--cells", "0"]) == 2
    assert main(["check", "missing.cfg"]) == 2


def test_parts_of_a_generator(tmp_path: Path) -> None:
    """Text and back; a file that is none is refused."""
    parts = Parts((1.0, 0.5), (20, 10), 2, 1000.0, [Object("Ball", (0.5, 0.25, 0.1))])
    path = tmp_path / "a.parts"
    path.write_text(parts.text())
    found = read_parts(path)
    assert (list(found.lengths), list(found.cells)) == ([1.0, 0.5], [20, 10])
    assert (found.per_cell, found.density, found.parts) == (2, 1000.0, parts.parts)
    path.write_text("Lx = 1\n")
    with pytest.raises(PygenError, match="no Nx"):
        read_parts(path)
