"""Time steps above the limit, runs that go bad, and points that leave the grid."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from frames import NAME, read_frame, read_series
from scene import DIM, NVEL, ROUNDING, TYPES, Body, Run, Scene, block, drop_scene

WARNING = re.compile(
    r'warning: dt = (\S+) s is above the stable step of body "(\w+)", (\S+) s '
    r"\(wave speed (\S+) m/s\).*\n"
)


def stable_step(spacing: float, speed: float, per_cell: int) -> float:
    """Return the limit of hats with n >= 2 points a cell and direction.

    c dt <= h/sqrt(5/3 + 1/(3 n^2)): the worst wave runs along one direction in any dimension.
    """
    return spacing / (speed * math.sqrt(5 / 3 + 1 / (3 * per_cell**2)))


def two_speeds(sim_type: int, dt: float, steps: int) -> Scene:
    """Make a stiff and a soft body on cells of 0.1 m, 2 points a cell and direction, at rest."""
    dim = DIM[sim_type]
    bodies = []
    for name, low, modulus in (("soft", 0.1, 1e5), ("stiff", 0.6, 4e5)):
        rows = block(sim_type, [low] * dim, [low + 0.2] * dim, [4] * dim)
        bodies.append(Body(name, rows, modulus=modulus))
    return Scene(
        sim_type,
        lengths=[1.0] * dim,
        cells=[10] * dim,
        bodies=bodies,
        dt=dt,
        t_stop=steps * dt,
    )


@pytest.mark.parametrize("sim_type", TYPES)
def test_warning_above_the_limit(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Only the body whose limit lies below dt is named, with its wave speed and its limit."""
    speed = Body("stiff", np.zeros((0, 0)), modulus=4e5).wave_speed()
    limit = stable_step(0.1, speed, 2)
    two_speeds(sim_type, 1.01 * limit, 2).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 0
    match = WARNING.fullmatch(result.stderr)
    assert match, result.stderr
    assert match[2] == "stiff"
    # Numbers of messages have six digits.
    assert float(match[1]) == pytest.approx(1.01 * limit, rel=5e-6)
    assert float(match[3]) == pytest.approx(limit, rel=5e-6)
    assert float(match[4]) == pytest.approx(speed, rel=5e-6)

    two_speeds(sim_type, 0.99 * limit, 2).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


def test_warning_in_quiet_runs(mpm3d: Run, tmp_path: Path) -> None:
    """-q leaves warnings as they are, and each body is warned of once."""
    two_speeds(2, 0.02, 2).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "-q", "--set", "serializer.properties=1e3", cwd=tmp_path)
    assert result.stdout == ""
    assert [match[2] for match in WARNING.finditer(result.stderr)] == ["soft", "stiff"]


def test_check_tells_of_the_limit(mpm3d: Run, tmp_path: Path) -> None:
    """--check marks the body."""
    two_speeds(2, 4e-3, 2).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    assert result.returncode == 0
    soft, stiff = (line for line in result.stdout.splitlines() if line.startswith("body:"))
    assert "BELOW" not in soft
    assert "BELOW dt" in stiff


@pytest.mark.parametrize("sim_type", TYPES)
def test_run_that_blows_up(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Three times the limit ends with exit code 3; the frames before that are whole."""
    speed = Body("stiff", np.zeros((0, 0)), modulus=4e5).wave_speed()
    dt = 3.0 * stable_step(0.1, speed, 2)
    scene = two_speeds(sim_type, dt, 3000)
    scene.rate = 0.2 / dt
    scene.gravity = [0.0] * NVEL[sim_type]
    # A disturbance of the stiff body that is not the same everywhere.
    rows, dim = scene.bodies[1].rows, DIM[sim_type]
    rows[:, 2 + NVEL[sim_type]] = 1e-3 * np.sin(20.0 * rows[:, 2 : 2 + dim]).sum(axis=1)
    scene.write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 3, (result.returncode, result.stderr[:500])
    *warnings, message, hint = result.stderr.splitlines()
    assert all(line.startswith("warning: ") for line in warnings)
    match = re.fullmatch(
        r'error: body "stiff": point (\d+) (?P<what>.+) in step (\d+), t = \S+ s', message
    )
    assert match, message
    assert 1 <= int(match[1]) <= len(rows)
    assert 1 < int(match[3]) <= 3000
    assert match["what"] in (
        "moved more than a cell",
        "has lost its volume",
        "is no longer finite",
        "has no admissible stress",
    )
    assert "stable step" in hint

    files = sorted((tmp_path / "frames").glob("*.vtk"))
    # One frame each five steps until then, points and nodes of two bodies.
    frames = (int(match[3]) - 1) // 5 + 1
    assert len(files) == 4 * frames
    for path in files:
        assert NAME.fullmatch(path.name)
        frame = read_frame(path)
        assert np.all(np.isfinite(frame.positions))


def test_fast_points_stop_the_run(mpm3d: Run, tmp_path: Path) -> None:
    """A point that moves more than a cell in one step is found in the first step."""
    rows = block(2, [0.4, 0.4], [0.6, 0.6], [4, 4], velocity=[120.0, 0.0])
    drop_scene(bodies=[Body("bullet", rows)]).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 3
    assert 'error: body "bullet": point 1 moved more than a cell in step 1' in result.stderr
    assert "dt too large" in result.stderr
    assert len(list((tmp_path / "frames").glob("*.vtk"))) == 2


def test_points_that_leave_the_grid(mpm3d: Run, tmp_path: Path) -> None:
    """They become inactive where they left, are warned of and counted; the others go on."""
    rows = block(2, [0.4, 0.7], [0.6, 0.9], [4, 4], velocity=[0.0, 10.0])
    scene = drop_scene(
        bodies=[Body("drop", rows)], gravity=[0.0, 0.0], rate=1000.0, t_stop=0.02, cpdi=0
    )
    scene.write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 0
    series = read_series(tmp_path / "frames", "fpd", 0, "drop")
    lost = [int((frame.fields["active"] == 0.0).sum()) for frame in series]
    # The topmost row is 0.125 m below the face, 12.5 steps away; rows are 5 steps apart.
    assert lost[:12] == [0] * 12
    assert lost[-1] == 8
    assert sorted(set(lost)) == [0, 4, 8]
    counts = re.findall(r"^warning: (\d+) points have left the grid by t = ", result.stderr, re.M)
    assert counts == ["4", "8"]
    assert "points that left the grid: 8" in result.stdout
    last = series[-1]
    gone = last.fields["active"] == 0.0
    assert np.all(last.positions[gone, 1] > 1.0)
    assert np.all(last.positions[gone, 1] < 1.0 + 2 * 0.01)
    assert np.all(last.positions[~gone, 1] < 1.0)
    expected = rows[~gone, 3] + 10.0 * last.time
    assert np.allclose(last.positions[~gone, 1], expected, rtol=0.0, atol=20 * ROUNDING)


def test_the_last_point_leaves(mpm3d: Run, tmp_path: Path) -> None:
    """A body without a point left does not end the run."""
    rows = block(2, [0.4, 0.8], [0.6, 1.0], [4, 4], velocity=[0.0, 50.0])
    drop_scene(bodies=[Body("drop", rows)], t_stop=0.01, rate=1000.0).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "points that left the grid: 16" in result.stdout
    last = read_series(tmp_path / "frames", "fpd", 0, "drop")[-1]
    assert last.number == 10
    assert np.all(last.fields["active"] == 0.0)
