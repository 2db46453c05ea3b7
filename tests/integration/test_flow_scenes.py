"""The scenes of sand and water do what sand and water do."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from frames import Frame, read_series
from scene import Run

ROOT = Path(__file__).resolve().parents[2]
GRAVITY = 9.81


def run_scene(run: Run, name: str, body: str, folder: Path) -> tuple[list[Frame], str]:
    """Return the frames of the points of a scene, and what the program says."""
    for part in (f"configs/{name}", "mpm_pygen"):
        ignored = shutil.ignore_patterns("*.points", "*.msh", "__pycache__")
        shutil.copytree(ROOT / part, folder / part, ignore=ignored)
    environment = {**os.environ, "PYTHON": sys.executable, "PYTHONDONTWRITEBYTECODE": "1"}
    script = folder / "configs" / name / "make_points.sh"
    subprocess.run(["bash", script], env=environment, check=True, capture_output=True)
    result = run("-c", f"configs/{name}/{name}.cfg", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    return read_series(folder / "output" / name, "fpd", 0, body), result.stdout


def test_sand_column(mpm3d: Run, tmp_path: Path) -> None:
    """The column runs out as far as columns do, and comes to rest on a slope of friction."""
    frames, report = run_scene(mpm3d, "sand_column", "sand", tmp_path)
    width, aspect, friction = 0.1, 2.0, 0.3819
    # The front of the heap; single points may slide ahead of it.
    front = [float(np.quantile(frame.positions[:, 0], 0.99)) for frame in frames]
    run_out = front[-1] / width - 1.0
    # Experiments and continuum calculations: 1.2 a to 2.2 a.
    assert 1.2 * aspect < run_out < 2.2 * aspect
    # It rests: the last tenth of the time moves the front by less than a tenth of a cell.
    assert front[-1] - front[9 * len(front) // 10] < 0.001
    energy = re.search(r"kinetic (\S+),.* potential (\S+) J", report)
    assert energy
    assert float(energy[1]) < 1e-4 * abs(float(energy[2]))
    # The heap is lower than the column, higher than a puddle, and flatter than the friction angle.
    x = frames[-1].positions
    height = float(np.max(x[x[:, 0] < 0.2 * width, 1]))
    assert 0.7 * width < height < 1.45 * width
    assert height / front[-1] < friction
    # Sand does not pass the floor, and the front never falls faster than freely.
    assert float(np.min(x[:, 1])) > 0.0
    speeds = np.diff(front) / np.diff([frame.time for frame in frames])
    assert float(np.max(speeds)) < np.sqrt(2.0 * GRAVITY * aspect * width)


def test_dam_break(mpm3d: Run, tmp_path: Path) -> None:
    """The front follows the measured one and is slower than that of shallow water."""
    frames, _ = run_scene(mpm3d, "dam_break", "water", tmp_path)
    height = 0.1
    time = np.array([frame.time for frame in frames]) * np.sqrt(2.0 * GRAVITY / height)
    front = np.array([np.quantile(frame.positions[:, 0], 0.99) for frame in frames]) / height
    # Martin and Moyce (1952), square section: distance over width, times over sqrt(a/(2 g)).
    measured = np.array([[0.84, 1.22], [1.43, 1.67], [1.98, 2.33], [2.51, 3.00], [2.65, 3.22]])
    found = np.interp(measured[:, 0], time, front)
    # They see the front of a film that clings to the floor; their points scatter by 5 %.
    np.testing.assert_allclose(found, measured[:, 1], rtol=0.1)
    speeds = np.diff(front) / np.diff(time) * np.sqrt(2.0)
    assert float(np.max(speeds)) < 2.0
    # Water keeps its volume to (u/c)**2, and nothing passes the floor.
    density = frames[-1].fields["density"]
    assert abs(float(np.mean(1000.0 / density)) - 1.0) < 0.03
    assert float(np.min(frames[-1].positions[:, 1])) > 0.0


def test_settling_slurry(mpm3d: Run, tmp_path: Path) -> None:
    """The end of the sand falls as Carman and Kozeny say, and all comes to rest on a bed."""
    frames, _ = run_scene(mpm3d, "settling_slurry", "sand", tmp_path)
    folder = tmp_path / "output" / "settling_slurry"
    water = read_series(folder, "fpd", 1, "water")
    packing, height, excess = 0.3, 0.2, 1500.0 * GRAVITY
    speed = (1.0 - packing) ** 3 * excess * 0.002**2 / (180.0 * packing * 0.01)
    time = np.array([frame.time for frame in frames])
    end = np.array([float(np.max(frame.positions[:, 1])) for frame in frames])
    falling = (time > 0.35) & (time < 1.65)
    found = -np.polyfit(time[falling], end[falling], 1)[0]
    # The end lies in a cell with a gradient of the porosity, on which the speed depends.
    assert abs(found / speed - 1.0) < 0.06
    # In the middle the suspension stays as it is, until the bed comes.
    middle = np.abs(frames[10].positions[:, 1] - 0.1) < 0.01
    assert abs(float(np.mean(frames[10].fields["packing_fraction"][middle])) - packing) < 0.01
    # At rest: the densest bed that settles by itself has 0.585.
    assert float(np.max(np.abs(frames[-1].fields["velocity"]))) < 1e-3
    densest = packing * height / 0.585
    assert densest < end[-1] < 1.15 * densest
    # Clear liquid carries its own weight, as a mean: pressures of single points are noisy.
    x, pressure = water[-1].positions[:, 1], water[-1].fields["pressure"]
    clear = (x > 0.13) & (x < 0.19)
    weight = 1000.0 * GRAVITY * (float(np.max(x)) - x[clear])
    assert abs(float(np.mean(pressure[clear]) / np.mean(weight)) - 1.0) < 0.1
