"""The command: files of each shape and TYPE, one-line errors, exit statuses."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

import mpm_pygen
from mpm_pygen import SimulationType, read_points
from mpm_pygen.cli import main

COMMON = ["--density", "1000", "-o", "out.points"]
BLOCK_2 = ["block", "--type", "2", "--min", "0", "0", "--max", "1", "1", "--spacing", "0.5"]


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run each test in a folder of its own."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("command", "sim_type", "count"),
    [
        ("block --type 1 --min -1 --max 1 --spacing 0.25 --velocity -1e-3", 1, 8),
        ("block --type 2 --min 0 0 --max 1 1 --spacing 0.5 0.25 --velocity -1 .5", 2, 8),
        ("block --type 3 --min 0 0 0 --max 1 1 1 --spacing 0.5 --velocity 0 0 -1", 3, 8),
        ("block --type 4 --min 0 0 --max 1 1 --spacing 0.5 --velocity 0 -1 2", 4, 4),
        ("block --type 5 --min 0 0 --max 1 1 --spacing 0.5 --velocity 0 0 -1e1", 5, 4),
        # Centres at +-1/2, +-3/2 ...: the squares of two (three) odd halves up to 4 add up to
        # 1/2 and 5/2 (3/4 and 11/4): 4 + 8 points in the circle, 8 + 24 in the sphere.
        ("circle --type 2 --centre 0 0 --radius 2 --spacing 1 --velocity 1 0", 2, 12),
        ("circle --type 4 --centre 3 0 --radius 2 --spacing 1 --velocity 1 0 0", 4, 12),
        ("circle --type 5 --centre 0 0 --radius 2 --spacing 1 --velocity 0 0 1", 5, 12),
        ("sphere --type 3 --centre 0 0 0 --radius 2 --spacing 1 --velocity 0 0 1", 3, 32),
        ("sphere --type 4 --centre 0 0 --radius 2 --spacing 1 --velocity 0 0 1", 4, 6),
        (
            "cylinder --type 3 --centre 0 0 0 --radius 2 --length 3 --axis x --spacing 1 "
            "--velocity 0 0 1",
            3,
            36,
        ),
    ],
)
def test_each_shape_and_type(command: str, sim_type: int, count: int) -> None:
    """The file reads back with the points and velocities of the command line."""
    words = command.split()
    assert main([*words, *COMMON]) == 0
    points = read_points("out.points", SimulationType(sim_type))
    assert len(points) == count
    assert points.active.all()
    velocity = [float(word) for word in words[words.index("--velocity") + 1 :]]
    assert points.velocity.tolist() == [velocity] * count
    assert (points.mass == 1000.0 * points.volume).all()


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("", "required"),
        ("pyramid --type 2", "invalid choice"),
        ("block --type 6 --min 0 --max 1 --spacing 1", "invalid choice"),
        ("block --type 2 --max 1 1 --spacing 0.5", "--min"),
        ("block --type 2 --min 0 x --max 1 1 --spacing 0.5", "invalid float"),
        ("block --type 2 --min 0 0 0 --max 1 1 --spacing 0.5", "--min takes 2 numbers (x, y)"),
        ("block --type 2 --min 0 0 --max 1 1 --spacing 0.45", "nearest spacing that fits is 0.5"),
        ("block --type 2 --min 0 0 --max 1 -1 --spacing 0.5", "below the upper"),
        ("block --type 2 --min 0 0 --max 1 nan --spacing 0.5", "not a number"),
        ("block --type 2 --min 0 0 --max 1 1 --spacing -0.5", "above 0"),
        ("block --type 2 --min 0 0 --max 1 1 --spacing 0.5 --velocity 1", "2 components"),
        ("block --type 2 --min 0 0 --max 1 1 --spacing 0.5 --velocity z 1", "unknown name 'z'"),
        ("block --type 2 --min 0 0 --max 1 1", "either the spacing"),
        ("fill cone(1) --type 2 --spacing 0.5", "unknown shape 'cone'"),
        ("image missing.png --pixel 1 --colour #000000 --type 2 --spacing 1", "cannot read"),
        ("block --type 4 --min -1 0 --max 1 1 --spacing 0.5", "r >= 0"),
        ("circle --type 1 --centre 0 --radius 1 --spacing 0.5", "use block"),
        ("circle --type 3 --centre 0 0 0 --radius 1 --spacing 0.5", "use cylinder or sphere"),
        ("cylinder --type 4 --centre 0 0 --radius 1 --length 1 --spacing 0.5", "r from 0"),
        ("sphere --type 2 --centre 0 0 --radius 1 --spacing 0.5", "use circle"),
        ("sphere --type 4 --centre 1 0 --radius 1 --spacing 0.5", "r = 0"),
    ],
)
def test_bad_input_is_one_line_and_status_2(
    command: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """No file is made."""
    try:
        status = main([*command.split(), *(COMMON if command else [])])
    except SystemExit as stop:
        status = int(str(stop.code))
    assert status == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("mpm-pygen")
    assert words in captured.err
    assert captured.err.count("\n") == 1
    assert os.listdir() == []


def test_density_is_checked(capsys: pytest.CaptureFixture[str]) -> None:
    """Negative densities are refused."""
    assert main([*BLOCK_2, "--density", "-1", "-o", "out.points"]) == 2
    assert "density" in capsys.readouterr().err


@pytest.mark.parametrize("target", ["missing/out.points", "."])
def test_unwritable_output_is_status_4(target: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The message names the file; no temporary file stays."""
    assert main([*BLOCK_2, "--density", "1", "-o", target]) == 4
    assert f"cannot write {target}" in capsys.readouterr().err
    assert os.listdir() == []


def test_fill_takes_expressions() -> None:
    """A plate with a hole, 4 of 8 by 4 points taken away, with fields of position."""
    shape = "block((0, 0), (1, 0.5)) - circle((0.5, 0.25), 0.1)"
    command = ["fill", shape, "--type", "2", "--cell", "0.25", "--per-cell", "2"]
    fields = ["--density", "1000 + 100*y", "--velocity", "-2*y", "0.5", "-o", "out.points"]
    assert main([*command, *fields]) == 0
    points = read_points("out.points", 2)
    assert len(points) == 32 - 4
    y = points.position[:, 1]
    assert points.velocity.tolist() == [[-2 * value, 0.5] for value in y.tolist()]
    assert points.mass.tolist() == ((1000 + 100 * y) / 64).tolist()


def test_mixture_writes_two_files() -> None:
    """Grains and fluid, whose masses add up to that of the mixture."""
    words = ["--density", "2650", "--porosity", "0.4", "--fluid-density", "1000"]
    assert main([*BLOCK_2, *words, "-o", "grains.points", "--fluid-output", "fluid.points"]) == 0
    grains, fluid = read_points("grains.points", 2), read_points("fluid.points", 2)
    assert grains.total_mass == pytest.approx(0.6 * 2650)
    assert fluid.total_mass == pytest.approx(0.4 * 1000)
    assert grains.position.tolist() == fluid.position.tolist()
    assert main([*BLOCK_2, "--porosity", "0.4", *COMMON]) == 2


def test_fitted_jittered_and_exact(capsys: pytest.CaptureFixture[str]) -> None:
    """The options reach the fill: exact area, moved points, the shape's mass."""
    disc = ["circle", "--type", "2", "--centre", "0", "0", "--radius", "1", "--spacing", "0.25"]
    masses = []
    for options in ([], ["--fitted"], ["--exact"], ["--jitter", "0.5", "--seed", "3"]):
        assert main([*disc, *options, *COMMON]) == 0
        masses.append(read_points("out.points", 2).total_mass)
    # 52 of the lattice's centres lie in the circle: those of 1/8, 3/8, 5/8 and 7/8.
    assert masses[0] == masses[3] == 52 * 62.5
    assert masses[1:3] == pytest.approx([1000 * math.pi] * 2, rel=1e-14)
    jittered = read_points("out.points", 2).position / 0.25 - 0.5
    assert (jittered != jittered.round()).any()
    assert "52 points" in capsys.readouterr().out


def test_picture_becomes_points() -> None:
    """Red pixels, 2 points a side each."""
    picture = Image.new("RGB", (4, 3), "white")
    for place in ((0, 2), (1, 2), (3, 0)):
        picture.putpixel(place, (255, 0, 0))
    picture.save("body.png")
    command = ["image", "body.png", "--type", "2", "--pixel", "0.5", "--spacing", "0.25"]
    assert main([*command, "--colour", "#ff0000", "--min", "-1", "0", *COMMON]) == 0
    points = read_points("out.points", 2)
    assert points.total_volume == 0.75
    corners = {(float(x) // 0.5, float(y) // 0.5) for x, y in points.position}
    assert corners == {(-2, 0), (-1, 0), (1, 2)}


@pytest.mark.parametrize("name", ["'missing.stl'", "'missing.obj'"])
def test_a_missing_mesh_is_bad_input(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """It is the input that is missing, not the output."""
    assert main(["fill", f"mesh({name})", "--type", "3", "--spacing", "1", *COMMON]) == 2
    assert "cannot read missing" in capsys.readouterr().err


def test_module_runs_in_place() -> None:
    """`python -m mpm_pygen` is the command."""
    source = Path(mpm_pygen.__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-m", "mpm_pygen", *BLOCK_2, *COMMON],
        env={**os.environ, "PYTHONPATH": str(source)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "out.points: 4 points, mass 1000 kg/m\n"
    assert len(read_points("out.points", 2)) == 4
