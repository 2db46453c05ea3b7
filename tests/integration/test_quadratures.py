"""Quadratures by domains in whole runs: conservation, rotation, seams, threads, corners."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frames import read_series
from scene import DIM, EPSILON, NVEL, TYPES, Array, Body, Run, Scene, block
from test_bases import grid
from test_improved_quadrature import improved

RULES = pytest.mark.parametrize("rule", [1, 2, 3, 4])


def run(mpm3d: Run, scene: Scene, folder: Path, rule: int, *options: str) -> str:
    """Run a scene by a rule, with files of corners beside its frames."""
    path = scene.write(folder)
    lines = [f"point-int-props = {{{rule}}}", 'point-str-props = {"corners"}']
    path.write_text(improved(scene, *lines))
    result = mpm3d("-c", path.name, *options, cwd=folder)
    assert result.returncode == 0, result.stderr
    assert "warning" not in result.stderr
    return str(result.stdout)


def energies(scene: Scene, folder: Path) -> tuple[Array, Array]:
    """Return kinetic and strain energy in all frames."""
    body = scene.bodies[0]
    kinetic, strain = [], []
    for frame in read_series(folder / "frames", "fpd", 0, body.name):
        fields = frame.fields
        stress = fields["cauchy_stress"].reshape(-1, 9)
        trace = stress[:, [0, 4, 8]].sum(axis=1)
        density = (1 + body.poisson) * (stress**2).sum(axis=1) - body.poisson * trace**2
        kinetic.append(0.5 * fields["mass"] @ (fields["velocity"] ** 2).sum(axis=1))
        strain.append(0.5 * fields["volume"] @ density / body.modulus)
    return np.array(kinetic), np.array(strain)


@RULES
@pytest.mark.parametrize("sim_type", TYPES)
def test_block_drops_on_a_floor(mpm3d: Run, tmp_path: Path, sim_type: int, rule: int) -> None:
    """A block falls onto the floor and comes back up with no more energy than it had."""
    dim, up = DIM[sim_type], DIM[sim_type] - 1
    lower, upper = [0.0 if sim_type == 4 else 0.25] * dim, [0.5 if sim_type == 4 else 0.75] * dim
    lower[up], upper[up] = 0.0625, 0.3125
    counts = [8] * dim
    counts[up] = 4
    velocity = [0.0] * NVEL[sim_type]
    velocity[up] = -1.0
    wall = 'boundary-class = "CartesianSmoothBox"'
    body = Body("block", block(sim_type, lower, upper, counts, velocity=velocity), 1e5, 0.2, wall)
    scene = Scene(sim_type, [1.0] * dim, [8] * dim, [body], 0.25, dt=5e-4, rate=40.0)
    scene.gravity = [0.0] * NVEL[sim_type]
    run(mpm3d, scene, tmp_path, rule)
    kinetic, strain = energies(scene, tmp_path)
    total = kinetic + strain
    assert kinetic.min() < 0.5 * kinetic[0]
    # Symplectic steps of a tenth of the stable one: the sum of both overshoots by less than 5 %.
    assert np.all(total < 1.05 * total[0])
    assert total[-1] > 0.5 * total[0]
    last = read_series(tmp_path / "frames", "fpd", 0, "block")[-1]
    assert last.fields["velocity"][:, up] @ last.fields["mass"] > 0
    assert np.all(last.positions[:, up] > 0)


@RULES
def test_spinning_block_stays_whole(mpm3d: Run, tmp_path: Path, rule: int) -> None:
    """A block spins far from walls: momentum is kept, energy does not grow, no point flies off."""
    rows = block(2, [1.0, 1.0], [2.0, 2.0], [16, 16])
    rows[:, 4] = -2.0 * (rows[:, 3] - 1.5)
    rows[:, 5] = 2.0 * (rows[:, 2] - 1.5)
    body = Body("block", rows, modulus=1e6, poisson=0.25)
    scene = Scene(2, [3.0, 3.0], [24, 24], [body], 0.5, dt=5e-4, rate=2.0, gravity=[0.0, 0.0])
    run(mpm3d, scene, tmp_path, rule)
    first, last = read_series(tmp_path / "frames", "fpd", 0, "block")
    mass = first.fields["mass"]
    momentum = mass @ last.fields["velocity"]
    scale = mass @ np.abs(first.fields["velocity"]).sum(axis=1)
    # Each of 1000 steps rounds once.
    assert np.all(np.abs(momentum) < 1000 * 64 * EPSILON * scale)
    kinetic, strain = energies(scene, tmp_path)
    assert np.all(kinetic + strain < 1.02 * kinetic[0])
    corner = last.positions[-1] - last.positions[0]
    start = first.positions[-1] - first.positions[0]
    # Its diagonal has turned by less than 1 rad, as it loses some of its spin.
    turned = np.arctan2(corner[1], corner[0]) - np.arctan2(start[1], start[0])
    assert 0.7 < turned < 1.0
    assert np.hypot(*corner[:2]) == pytest.approx(np.hypot(*start[:2]), rel=0.02)


@RULES
def test_seams_are_nowhere(mpm3d: Run, tmp_path: Path, rule: int) -> None:
    """A block that begins across a seam moves as one that begins elsewhere."""
    ends = []
    for name, x in (("across", 0.9375), ("inside", 0.3125)):
        rows = block(2, [x, 0.375], [x + 0.25, 0.625], [8, 8], velocity=[0.5, 0.25])
        rows[:, 4] += rows[:, 3] - 0.5
        rows[:, 2] %= 1.0
        body = Body("block", rows, modulus=1e5)
        scene = Scene(2, [], [], [body], 0.125, dt=2.0**-10, rate=8.0)
        scene.grid, scene.gravity = grid("CartesianCustom", 2), [0.0, 0.0]
        run(mpm3d, scene, tmp_path / name, rule)
        last = read_series(tmp_path / name / "frames", "fpd", 0, "block")[-1]
        ends.append(last.fields)
    for name, tolerance in (("displacement", 1e-11), ("velocity", 1e-9), ("volume", 1e-12)):
        assert np.allclose(ends[0][name], ends[1][name], rtol=0, atol=tolerance), name


@pytest.mark.parametrize("rule", [1, 3, 4])
def test_same_files_for_any_number_of_threads(mpm3d: Run, tmp_path: Path, rule: int) -> None:
    """All files are the same to the last byte, those of corners too."""
    rows = block(2, [0.25, 0.25], [0.75, 0.75], [80, 80], velocity=[0.5, 0.25])
    rows[:, 4] += 3.0 * (rows[:, 3] - 0.5)
    scene = Scene(2, [1.0, 1.0], [80, 80], [Body("block", rows)], 2e-3, dt=2e-4, rate=500.0)
    for threads in ("1", "2"):
        run(mpm3d, scene, tmp_path / threads, rule, "--threads", threads)
    one, two = tmp_path / "1", tmp_path / "2"
    files = [path.relative_to(one) for path in one.rglob("*.vtk")]
    assert len(files) == 6
    for path in files:
        assert (one / path).read_bytes() == (two / path).read_bytes(), path


def test_corners_belong_to_their_frame(mpm3d: Run, tmp_path: Path) -> None:
    """Titles tell frame and time, and the corners of a rigid body move with it."""
    rows = block(2, [0.25, 0.25], [0.5, 0.5], [4, 4], velocity=[1.0, 0.0])
    scene = Scene(2, [1.0, 1.0], [8, 8], [Body("block", rows)], 0.1, dt=5e-3, rate=10.0)
    scene.gravity = [0.0, 0.0]
    run(mpm3d, scene, tmp_path, 4)
    names = sorted(path.name for path in (tmp_path / "corners").glob("*.vtk"))
    assert names == [f"fpd.0.block.corners.{frame:010d}.vtk" for frame in (0, 1)]
    corners = []
    for frame, name in enumerate(names):
        lines = (tmp_path / "corners" / name).read_text().splitlines()
        assert lines[1].endswith(f"Frame {frame}, Time {frame * 0.1:g}")
        assert lines[4] == "POINTS 64 double"
        corners.append(np.array([line.split() for line in lines[5:69]], dtype=float))
    assert np.allclose(corners[1] - corners[0], [0.1, 0.0, 0.0], rtol=0, atol=1e-12)
