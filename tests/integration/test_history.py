"""The table of sums over bodies: energies, momenta, impulses, probes; its rows and its bytes."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scene import (
    EPSILON,
    ROUNDING,
    Array,
    Body,
    Run,
    Scene,
    block,
    drop_scene,
    huang,
    run_scene,
)

ROOT = Path(__file__).resolve().parents[2]
NAME = "frames/test.history.csv"


def with_history(scene: Scene, rate: float, integers: str = "") -> str:
    """Return the config of a scene with a history."""
    plain = f"    properties = {{{scene.rate!r}}}\n    int-properties = {{{scene.digits}"
    config = scene.config()
    assert plain in config
    return config.replace(plain, plain.replace("}\n", f", history_rate = {rate!r}}}\n") + integers)


def read_table(path: Path) -> dict[str, Array]:
    """Return the columns of a history by their names."""
    names, *rows = path.read_text().splitlines()
    table = np.array([[float(value) for value in row.split(",")] for row in rows])
    return dict(zip(names.split(","), table.T, strict=True))


def run_with_history(
    run: Run, scene: Scene, folder: Path, rate: float, integers: str = ""
) -> dict[str, Array]:
    """Run a scene with a history and return its table."""
    scene.write(folder)
    (folder / "scene.cfg").write_text(with_history(scene, rate, integers))
    result = run("-c", "scene.cfg", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    table = read_table(folder / NAME)
    assert f"history: {len(table['time'])} rows in {NAME}\n" in result.stdout
    return table


def test_energy_of_a_free_bar(mpm3d: Run, tmp_path: Path) -> None:
    """A bar swings in its first mode: it loses what the manual says of the solver, and no more."""
    cells, per_cell, courant, modulus, density = 16, 2, 0.2, 1e6, 1000.0
    speed = math.sqrt(modulus / density)
    rows = block(1, [0.0], [1.0], [cells * per_cell])
    rows[:, 3] = 1e-4 * speed * np.sin(math.pi * rows[:, 2])
    walls = 'boundary-class = "CartesianSmoothBox"'
    dt, period = courant / cells / speed, 2.0 / speed
    scene = Scene(
        1,
        lengths=[1.0],
        cells=[cells],
        bodies=[Body("bar", rows, modulus=modulus, poisson=0.0, more=walls)],
        gravity=[0.0],
        cpdi=0,
        dt=dt,
        t_stop=2.0 * period,
    )
    table = run_with_history(mpm3d, scene, tmp_path, 1.0 / dt, ", history_dissipation = 1")
    steps = round(2.0 * period / dt)
    np.testing.assert_allclose(table["time"], dt * np.arange(steps + 1), rtol=4 * EPSILON)
    np.testing.assert_allclose(table["bar.mass"], density, rtol=ROUNDING)
    total = table["bar.kinetic_energy"] + table["bar.strain_energy"]
    # Velocities live half a step before positions: the sum swings by half a step's angle.
    angle = 0.5 * math.pi * speed * dt
    lost = 2.0 * math.pi * (1 / 6 + 1 / (12 * per_cell**2)) * courant * (math.pi / cells) ** 3
    assert np.max(np.abs(total / total[0] - 1.0)) < 1.05 * (angle + 2.0 * lost)
    # It does go back and forth.
    assert np.min(table["bar.kinetic_energy"]) < 0.01 * total[0]
    # Means over half a period, a period and a half apart. The next order is (k h)**2 of it.
    half = steps // 4
    ratio = np.mean(total[-half:]) / np.mean(total[:half])
    assert 1.0 - ratio == pytest.approx(1.5 * lost, rel=0.1)
    # Elastic work can be had back, up to the square of a step's angle.
    assert np.max(np.abs(table["bar.dissipated_energy"])) < angle**2 * total[0]
    # The centre of mass moves with the momentum: the sum over steps of the one is the other.
    moved = np.cumsum(table["bar.momentum_x"][1:]) * dt / density
    scale = 1e-4 * speed * dt * steps
    drift = table["bar.centre_x"][1:] - table["bar.centre_x"][0] - moved
    # Points move with the nodal velocities, whose difference from theirs has (k h)**2.
    assert np.max(np.abs(drift)) < (math.pi / cells) ** 2 * scale


@pytest.mark.parametrize(("sim_type", "staggered"), [(2, 0), (3, 0), (5, 0), (2, 1)])
def test_impulse_of_a_collision(mpm3d: Run, tmp_path: Path, sim_type: int, staggered: int) -> None:
    """The impulse of the contact is the change of momentum of its first body, up to rounding.

    Staggered, the bodies touch from the start, in whose first step forces act for dt/2.
    """
    dim, nvel = (3, 3) if sim_type == 3 else (2, 2 if sim_type == 2 else 3)
    gap = 0.0 if staggered else 0.1
    end = 0.5 - gap
    left = block(sim_type, [end - 0.2] + [0.4] * (dim - 1), [end] + [0.6] * (dim - 1), [4] * dim)
    right = block(sim_type, [0.5] + [0.35] * (dim - 1), [0.7] + [0.65] * (dim - 1), [4] * dim)
    left[:, -1 - nvel : -1] = [2.0, 0.7, 0.4][:nvel]
    right[:, -1 - nvel : -1] = [-1.0, 0.0, -0.2][:nvel]
    steps, dt = 80, 5e-4
    flags = f"{{1, 1, staggered = {staggered}}}"
    scene = Scene(
        sim_type,
        lengths=[1.0] * dim,
        cells=[10] * dim,
        bodies=[Body("left", left), Body("right", right, modulus=2e5)],
        contacts=[huang("left", "right")],
        gravity=[0.0] * nvel,
        dt=dt,
        t_stop=steps * dt,
        solver=f'solver {{ class = "ExplicitUSL" int-properties = {flags} }}\n',
    )
    table = run_with_history(mpm3d, scene, tmp_path, 0.25 / dt)
    assert len(table["time"]) == steps // 4 + 1
    scale = sum(
        float(body.rows[:, 0] @ np.linalg.norm(body.rows[:, -1 - nvel : -1], axis=1))
        for body in scene.bodies
    )
    for axis in "xyz"[:nvel]:
        impulse = table[f"touch.impulse_{axis}"]
        for body, sign in (("left", 1.0), ("right", -1.0)):
            change = table[f"{body}.momentum_{axis}"] - table[f"{body}.momentum_{axis}"][0]
            assert np.max(np.abs(change - sign * impulse)) <= ROUNDING * steps * scale
    assert table["touch.impulse_x"][-1] < -0.05 * scale
    assert f"right.momentum_{'xyz'[nvel - 1]}" in table
    assert "left.momentum_z" not in table or nvel == 3


def test_probes(mpm3d: Run, tmp_path: Path) -> None:
    """Mass through a plane, a material point and a place, of a block that flies without forces."""
    rows = block(2, [0.2, 0.4], [0.5, 0.6], [12, 8], velocity=[1.0, 0.0])
    probes = """probe
{
    class = "PlaneProbe"
    name = "gate"
    properties = {0.4}
    str-properties = {"x"}
}
probe
{
    class = "PointProbe"
    name = "tip"
    properties = {0.5, 0.6}
    str-properties = {"drop"}
}
probe
{
    class = "PointProbe"
    name = "place"
    properties = {0.65, 0.5}
    int-properties = {follow = 0}
    str-properties = {"drop"}
}
"""
    scene = drop_scene(
        bodies=[Body("drop", rows)],
        lengths=[1.0, 1.0],
        cells=[20, 20],
        gravity=[0.0, 0.0],
        t_stop=0.3,
        contacts=[probes],
    )
    table = run_with_history(mpm3d, scene, tmp_path, 100.0)
    time = table["time"]
    assert len(time) == 31
    # 1000 kg/m3, a height of 0.2 m, 1 m/s, while the body is on both sides of the gate.
    inside = time < 0.13
    np.testing.assert_allclose(table["gate.mass_flux"][inside], 200.0, rtol=0.01)
    # Forces are rounding errors of the pressure that the motion of this wave speed would make.
    pressure = 1000.0 * scene.bodies[0].wave_speed()
    assert np.max(np.abs(table["gate.force_x"])) < 1e-9 * pressure
    np.testing.assert_allclose(table["tip.x"], 0.4875 + time, rtol=1e-9)
    np.testing.assert_allclose(table["tip.velocity_x"], 1.0, rtol=1e-9)
    np.testing.assert_allclose(table["tip.density"], 1000.0, rtol=1e-9)
    # The block comes to the place, a cell to each side of it, after a tenth of a second.
    speed = table["place.velocity_x"]
    assert np.all(np.isnan(speed[time < 0.095]))
    np.testing.assert_allclose(speed[time > 0.12], 1.0, rtol=1e-9)


def test_no_history_unless_asked(mpm3d: Run, tmp_path: Path) -> None:
    """Without a rate there is no table, and a probe is refused."""
    scene = drop_scene()
    run_scene(mpm3d, scene, tmp_path)
    assert not (tmp_path / NAME).exists()
    probe = 'probe\n{\n    class = "PlaneProbe"\n    name = "a"\n    properties = {0.5}\n'
    scene.contacts = [probe + '    str-properties = {"x"}\n}\n']
    scene.write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    assert result.returncode == 2
    assert "a probe writes to the history, and there is none" in result.stderr
    assert "history_rate" in result.stderr


@pytest.mark.parametrize("missing", [False, True])
def test_history_of_a_restart(mpm3d: Run, tmp_path: Path, missing: bool) -> None:
    """A restart goes on behind the saved rows, or starts a table when they are gone."""
    scene = drop_scene(t_stop=0.04)
    scene.write(tmp_path)
    config = with_history(scene, 500.0).replace("history_rate", "save_time = 0.015, history_rate")
    (tmp_path / "scene.cfg").write_text(config)
    assert mpm3d("-c", "scene.cfg", cwd=tmp_path).returncode == 0
    whole = (tmp_path / NAME).read_text()
    (checkpoint,) = [path for path in (tmp_path / "save").iterdir() if "000015" in path.name]
    if missing:
        (tmp_path / NAME).unlink()
    result = mpm3d("-r", f"save/{checkpoint.name}", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    lines = whole.splitlines(keepends=True)
    kept = lines[:1] + lines[9:] if missing else lines
    assert len(lines) == 22
    assert (tmp_path / NAME).read_text() == "".join(kept)


def test_history_that_cannot_be_written(mpm3d: Run, tmp_path: Path) -> None:
    """A table that can't be written ends the run before it begins, with status 4."""
    scene = drop_scene()
    scene.write(tmp_path)
    (tmp_path / "scene.cfg").write_text(with_history(scene, 500.0))
    (tmp_path / NAME).mkdir(parents=True)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 4
    assert "test.history.csv: error: the file cannot be written: a folder" in result.stderr


def test_mpm_pygen_reads_it(mpm3d: Run, tmp_path: Path) -> None:
    """`mpm-pygen history` draws the table and writes the same numbers."""
    table = run_with_history(mpm3d, drop_scene(t_stop=0.04), tmp_path, 500.0)
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "mpm_pygen/src")}
    command = [sys.executable, "-m", "mpm_pygen", "history", NAME, "-o", "a.csv", "--plot", "a.png"]
    subprocess.run(command, cwd=tmp_path, env=environment, check=True, capture_output=True)
    again = read_table(tmp_path / "a.csv")
    assert list(again) == list(table)
    for name, values in table.items():
        np.testing.assert_array_equal(again[name], values)
    assert (tmp_path / "a.png").stat().st_size > 1000
