"""The command: files of each shape and TYPE, one-line errors, exit statuses."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

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
