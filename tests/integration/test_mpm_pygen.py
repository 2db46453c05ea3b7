"""Points files of mpm-pygen are taken in every TYPE."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from frames import read_series
from scene import DIM, EPSILON, NVEL, Body, Run, block, drop_scene, run_scene

SHAPES = {
    "1-block": (1, "block --min 0.2 --max 0.6 --velocity -2"),
    "2-block": (2, "block --min 0.2 0.2 --max 0.6 0.5 --velocity 1 -2"),
    "2-circle": (2, "circle --centre 0.4 0.4 --radius 0.2"),
    "3-block": (3, "block --min 0.2 0.2 0.2 --max 0.6 0.5 0.4 --velocity 1 2 3"),
    "3-cylinder": (3, "cylinder --centre 0.5 0.5 0.5 --radius 0.2 --length 0.4 --axis x"),
    "3-sphere": (3, "sphere --centre 0.5 0.5 0.5 --radius 0.3"),
    "4-block": (4, "block --min 0 0.2 --max 0.3 0.5 --velocity 0 -1 2"),
    "4-circle": (4, "circle --centre 0.5 0.5 --radius 0.2"),
    "4-sphere": (4, "sphere --centre 0 0.5 --radius 0.3"),
    "5-block": (5, "block --min 0.2 0.2 --max 0.6 0.5 --velocity 1 2 3"),
    "5-circle": (5, "circle --centre 0.4 0.4 --radius 0.2"),
}


@pytest.mark.parametrize("name", SHAPES)
def test_points_of_mpm_pygen(mpm3d: Run, root: Path, tmp_path: Path, name: str) -> None:
    """The program reads the file; mass and velocity of the first frame are those of the shape."""
    sim_type, shape = SHAPES[name]
    command = [*shape.split(), "--type", str(sim_type), "--spacing", "0.05", "--density", "1500"]
    made = subprocess.run(
        [sys.executable, "-m", "mpm_pygen", *command, "-o", "drop.points"],
        cwd=tmp_path,
        env={
            **os.environ,
            "PYTHONPATH": str(root / "mpm_pygen" / "src"),
            "PYTHONDONTWRITEBYTECODE": "1",
        },
        capture_output=True,
        text=True,
    )
    assert (made.returncode, made.stderr) == (0, "")

    dim = DIM[sim_type]
    scene = drop_scene(sim_type=sim_type, lengths=[1.0] * dim, cells=[10] * dim, rate=100.0)
    (tmp_path / "scene.cfg").write_text(scene.config())
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    first, last = read_series(tmp_path / "frames", "fpd", 0, "drop")
    count, mass = len(first.positions), first.fields["mass"].sum()
    assert f"{count} points" in made.stdout
    assert f"mass {mass:.6g} " in made.stdout
    assert np.allclose(first.fields["density"], 1500.0, rtol=8 * EPSILON)
    words = shape.split()
    if "--velocity" in words:
        velocity = np.zeros(3)
        values = words[words.index("--velocity") + 1 :]
        velocity[: len(values)] = list(map(float, values))
        assert np.array_equal(first.fields["velocity"], np.tile(velocity, (count, 1)))
    assert np.all(last.fields["active"] == 1.0)


def test_scenes_of_mpm_pygen_are_accepted(executable: Path, root: Path, tmp_path: Path) -> None:
    """Every scene of the config builder passes --check, as in configs/ and with other cells."""
    script = """
from mpm_pygen.scenes import SCENES
for make in SCENES.values():
    assert "BELOW dt" not in make().check()
    assert "BELOW dt" not in make(cells=60, per_cell=1).check()
print(len(SCENES))
"""
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=tmp_path,
        env={
            **os.environ,
            "MPM3D": str(executable),
            "PYTHONPATH": str(root / "mpm_pygen" / "src"),
            "PYTHONDONTWRITEBYTECODE": "1",
        },
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) >= 8


@pytest.fixture
def pygen(root: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Return the package."""
    monkeypatch.syspath_prepend(root / "mpm_pygen" / "src")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    return importlib.import_module("mpm_pygen")


@pytest.mark.parametrize("sim_type", DIM)
def test_results_are_read_as_vtk_and_the_program_tell(
    mpm3d: Run, tmp_path: Path, pygen: ModuleType, sim_type: int
) -> None:
    """Frames are those that VTK reads; momentum and energies those that the program prints."""
    dim = DIM[sim_type]
    velocity = [0.5, -2.0, 1.0][: NVEL[sim_type]]
    rows = block(sim_type, [0.3] * dim, [0.5] * dim, [4] * dim, velocity=velocity)
    # It bounces on the smooth floor, so that it is strained.
    rows[:, 1 + dim] -= 0.25
    walls = 'boundary-class = "CartesianSmoothBox"'
    scene = drop_scene(
        sim_type=sim_type,
        lengths=[1.0] * dim,
        cells=[10] * dim,
        bodies=[Body("drop", rows, more=walls)],
        t_stop=0.02,
        rate=50.0,
    )
    result = run_scene(mpm3d, scene, tmp_path)
    frames = pygen.Frames(tmp_path / "frames", config=tmp_path / "scene.cfg")
    assert frames.bodies == ["drop"]
    assert frames.sim_type == sim_type
    assert [len(axis) for axis in frames.grid_lines()] == [11] * dim
    for kind, read in (("fpd", "points"), ("fnd", "nodes")):
        expected = read_series(tmp_path / "frames", kind, 0, "drop")
        assert frames.times.tolist() == [frame.time for frame in expected]
        for frame, right in zip(frames, expected, strict=True):
            cloud = getattr(frame, read)("drop")
            assert np.array_equal(cloud.position, right.positions)
            assert sorted(cloud.fields) == sorted(right.fields)
            for name, values in right.fields.items():
                assert np.array_equal(cloud[name].reshape(values.shape), values), name

    # The program prints six digits.
    history = frames.history()
    told = re.search(r"^energy: kinetic ([^,]+), strain ([^,]+),", result.stdout, re.MULTILINE)
    assert told, result.stdout
    assert history["drop.kinetic_energy"][-1] == pytest.approx(float(told[1]), rel=1e-5)
    assert history["drop.strain_energy"][-1] == pytest.approx(float(told[2]), rel=1e-5)
    assert float(told[2]) > 0.0
    told = re.search(r"^momentum: .* -> \(([^)]*)\)", result.stdout, re.MULTILINE)
    assert told, result.stdout
    names = [name for name in history.columns if "momentum" in name]
    largest = max(abs(history[name][-1]) for name in names)
    for name, value in zip(names, map(float, told[1].split(",")), strict=True):
        assert history[name][-1] == pytest.approx(value, abs=1e-5 * largest), name
