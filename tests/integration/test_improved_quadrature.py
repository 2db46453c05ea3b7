"""ImprovedQuadraturePoints in whole runs: quadratures, corrections of positions, threads."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from frames import Frame, read_frame
from scene import EPSILON, Array, Body, Run, Scene, block, drop_scene, write_points

FRAMES = "frames"


def improved(scene: Scene, *lines: str) -> str:
    """Return the config of a scene with points of the class, and lines with their properties."""
    points = "\n    ".join(['point-class = "ImprovedQuadraturePoints"', *lines])
    return scene.config().replace('point-class = "DefaultPoints"', points)


def run(mpm3d: Run, scene: Scene, folder: Path, lines: list[str], *options: str) -> str:
    """Run a scene with points of the class; return what the program says."""
    path = scene.write(folder)
    path.write_text(improved(scene, *lines))
    result = mpm3d("-c", path.name, *options, cwd=folder)
    assert result.returncode == 0, result.stderr
    return str(result.stdout) + str(result.stderr)


def last(folder: Path, kind: str = "fpd") -> Frame:
    """Return the last frame of the only body."""
    return read_frame(sorted((folder / FRAMES).glob(f"{kind}.0.*.vtk"))[-1])


@pytest.mark.parametrize("quadrature", range(5))
def test_one_integer_is_enough(mpm3d: Run, tmp_path: Path, quadrature: int) -> None:
    """A scene that gives the quadrature alone runs, without files of corners."""
    scene = drop_scene(rate=100.0, gravity=[0.0, -10.0], t_stop=0.02)
    text = run(mpm3d, scene, tmp_path, [f"point-int-props = {{{quadrature}}}"])
    assert "done: 20 steps" in text
    assert not list(tmp_path.glob("**/*corners*"))
    points, nodes = last(tmp_path), last(tmp_path, "fnd")
    # Free fall: every function reproduces a uniform acceleration.
    assert np.allclose(points.fields["velocity"][:, 1], -0.2, rtol=0, atol=1e3 * EPSILON)
    assert {"grad_err", "grad_H"} <= set(points.fields)
    assert {"grid_volume", "err", "H"} <= set(nodes.fields)
    # A lattice of whole cells overfills no node, inside or at walls.
    assert np.max(nodes.fields["err"]) < 64 * EPSILON
    assert np.isclose(np.sum(nodes.fields["grid_volume"]), 1.0, rtol=1e-9)


def stretched_block(width: int = 12) -> Scene:
    """Make a block that flies apart along x, at a rate of 1/s."""
    rows = block(2, [2.0, 0.5], [2.0 + 0.25 * width, 3.5], [width, 12])
    rows[:, 4] = rows[:, 2] - rows[:, 2].mean()
    body = Body("block", rows, modulus=1e-3, poisson=0.0)
    scene = Scene(2, [7.0, 4.0], [14, 8], [body], 1.0, dt=5e-3, rate=4.0, gravity=[0.0, 0.0])
    return scene


def inside(frame: Frame) -> Array:
    """Return which points are active."""
    return frame.fields["active"] > 0.5


@pytest.mark.parametrize("solver", ["ExplicitUSL", "ExplicitMUSL", "ExplicitUSF"])
def test_voids_are_filled(mpm3d: Run, tmp_path: Path, solver: str) -> None:
    """Points are inserted into a block that flies apart; mass, volume and momentum stay."""
    scene = stretched_block()
    scene.solver = f'solver {{ class = "{solver}" int-properties = {{0, 1}} }}\n'
    lines = [
        "point-int-props = {quadrature = 1, position = 1, skip = 2, seed = 3}",
        "point-props = {scale = 0.5, r = 0.25, merge = 0.25, buffer = 1.0}",
    ]
    text = run(mpm3d, scene, tmp_path, lines)
    assert "warning" not in text
    frames = [read_frame(path) for path in sorted((tmp_path / FRAMES).glob("fpd.0.*.vtk"))]
    first, end = frames[0], frames[-1]
    assert np.sum(inside(first)) == 144
    assert np.sum(inside(end)) > 160
    for frame in frames:
        # Frames have ten digits a number.
        mass = frame.fields["mass"]
        assert np.isclose(np.sum(mass[inside(frame)]), 144 * 62.5, rtol=1e-9)
        assert np.all(mass[~inside(frame)] == 0.0)
        momentum = mass @ frame.fields["velocity"]
        assert np.max(np.abs(momentum)) < 1e-6 * np.sum(mass)
    # Away from its ends; the rows of the start are 0.5 apart now.
    x = np.sort(end.positions[inside(end), 0])
    assert np.max(np.diff(x[np.abs(x - 3.5) < 1.2])) < 0.3


def test_empty_reserve(mpm3d: Run, tmp_path: Path) -> None:
    """One warning, and the run goes on; short frames have points in reserve, too."""
    lines = ["point-int-props = {0, 1}", "point-props = {0.25, 0.25, 0.01}"]
    scene = stretched_block()
    scene.serializer = "MinimalVTK"
    text = run(mpm3d, scene, tmp_path, lines)
    density = read_frame(tmp_path / FRAMES / "fpd.0.block.0000000000.vtk").fields["density"]
    assert np.allclose(density, [1000.0] * 144 + [0.0] * 2, rtol=1e-9, atol=0)
    warnings = re.findall("warning: .*", text)
    assert len(warnings) == 1
    assert 'body "block": no point is left in reserve' in warnings[0]
    assert "done: 200 steps" in text


@pytest.mark.parametrize(
    "lines",
    [
        ["point-int-props = {1, 1}", "point-props = {0.5, 0.05, 0.25, 0.5}"],
        ["point-int-props = {0, 2}", "point-props = {0.05, 0.5}"],
        ["point-int-props = {3, 3}", "point-props = {0.1, 1e4}"],
        ["point-int-props = {2, 4}", "point-props = {0.1, 1e3}"],
        ["point-int-props = {0, 5, 3}", "point-props = {0.1, 0.5, 1e-3}"],
    ],
    ids=["avoid-a-void", "sph", "strain", "displacement", "newton"],
)
def test_same_frames_on_all_threads(mpm3d: Run, tmp_path: Path, lines: list[str]) -> None:
    """The bytes of all frames are the same on one and on three threads."""
    generator = np.random.default_rng(7)
    rows = block(2, [0.5, 0.0], [3.5, 3.0], [70, 70])
    rows[:, 2:4] += generator.uniform(-0.015, 0.015, (len(rows), 2))
    rows[:, 3] = np.abs(rows[:, 3])
    rows[:, 4] = 0.5 * (rows[:, 2] - 2.0)
    body = Body("block", rows, more='boundary-class = "CartesianSmoothBox"')
    scene = Scene(2, [4.0, 4.0], [40, 40], [body], 0.006, rate=200.0, gravity=[0.0, -10.0])
    frames = []
    for threads in ("1", "3"):
        folder = tmp_path / threads
        run(mpm3d, scene, folder, lines, "--threads", threads)
        paths = sorted((folder / FRAMES).glob("*.vtk"))
        frames.append([path.read_bytes() for path in paths])
        assert len(paths) == 4
    assert frames[0] == frames[1]


def test_shifts_show_in_frames(mpm3d: Run, tmp_path: Path) -> None:
    """Displacements hold the shifts, and del_pos tells them from the motion."""
    generator = np.random.default_rng(7)
    rows = block(2, [0.0, 0.0], [1.0, 1.0], [20, 20])
    rows[:, 2:4] += generator.uniform(-0.01, 0.01, (len(rows), 2))
    scene = Scene(2, [1.0, 1.0], [10, 10], [Body("block", rows)], 0.003, rate=1e3, gravity=[0, 0])
    lines = ["point-int-props = {0, 5, 50}", "point-props = {0.1, 0.5, 0.01}"]
    run(mpm3d, scene, tmp_path, lines)
    points, nodes = last(tmp_path), last(tmp_path, "fnd")
    shift = points.fields["del_pos"]
    assert 1e-3 < np.max(np.abs(shift)) < 0.02
    assert np.allclose(points.fields["displacement"], shift, rtol=0, atol=1e-9)
    assert np.max(nodes.fields["err"]) <= 0.01
    before = read_frame(tmp_path / FRAMES / "fnd.0.block.0000000000.vtk")
    assert np.max(before.fields["err"]) > 0.05


def test_mistakes_have_a_place(mpm3d: Run, tmp_path: Path) -> None:
    """A list that is one too short names what is missing, with file and line."""
    scene = drop_scene()
    scene.write(tmp_path)
    write_points(tmp_path / "drop.points", scene.bodies[0].rows)
    lines = ["point-int-props = {1, 1}", "point-props = {0.025, 0.5, 1.0}"]
    (tmp_path / "scene.cfg").write_text(improved(scene, *lines))
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 2
    assert 'position rule 1 needs "buffer" in its list of reals' in result.stderr
    assert "in this order: scale, r, merge, buffer" in result.stderr
    assert result.stderr.startswith("scene.cfg:")
