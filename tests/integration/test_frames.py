"""Frames: names, times, fields and values, read with VTK's reader."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from frames import Frame, field_names, frame_path, read_frame, read_series
from scene import (
    DIM,
    EPSILON,
    GRAVITY,
    NVEL,
    ROUNDING,
    TYPES,
    UP,
    Body,
    Run,
    Scene,
    block,
    drop_scene,
    huang,
    positions,
    run_scene,
)

ALL_TYPES = pytest.mark.parametrize("sim_type", TYPES)
BOUNDARY = 'boundary-class = "CartesianSmoothBox"'
#: VTK line, pixel and voxel, and the steps between a cell's nodes.
CELL_TYPE = {1: 3, 2: 8, 3: 11}
POINT_FIELDS = [
    "displacement",
    "velocity",
    "mass",
    "volume",
    "momentum",
    "body_force",
    "cauchy_stress",
    "velocity_gradient",
    "active",
    "extent",
    "pressure",
    "density",
]
NODE_FIELDS = [
    "displacement",
    "velocity",
    "diff_velocity",
    "mass",
    "momentum",
    "force",
    "active",
    "bc_nodal_mask",
    "contact_normal_a_b",
    "contact_force_by_b_on_a",
]
SCALARS = {
    "mass",
    "volume",
    "active",
    "extent",
    "pressure",
    "density",
    "tau_bar",
    "gamma_dot",
}
TENSORS = {"cauchy_stress", "velocity_gradient"}


def pair_scene(sim_type: int, **changes: object) -> Scene:
    """Make two bodies above each other that meet, in a grid with another count in each direction.

    Gravity, walls, a contact and different stresses everywhere: no field is 0.
    """
    dim, nvel = DIM[sim_type], NVEL[sim_type]
    up = UP[sim_type]
    bodies = []
    for name, low, speed in (("a", 0.0, 0.5), ("b", 0.3, -1.0)):
        lower, upper, counts = [0.2] * dim, [0.5] * dim, [5, 4, 3][:dim]
        lower[up], upper[up] = low, low + 0.28
        rows = block(sim_type, lower, upper, counts)
        velocity = np.full(nvel, 0.2)
        velocity[up] = speed
        rows[:, 2 + nvel : 2 + 2 * nvel] = velocity
        bodies.append(Body(name, rows, more=BOUNDARY))
    settings: dict[str, object] = {
        "lengths": [0.7, 0.8, 0.9][:dim],
        "cells": [7, 8, 9][:dim],
        "bodies": bodies,
        "contacts": [huang("a", "b")],
        "t_stop": 0.04,
        "rate": 100.0,
    }
    return Scene(sim_type, **{**settings, **changes})  # type: ignore[arg-type]


def assert_shapes(frame: Frame) -> None:
    """Every field is a scalar, a vector or a tensor of finite numbers at each position."""
    n = len(frame.positions)
    for name, values in frame.fields.items():
        shape = (n,) if name in SCALARS else (n, 9) if name in TENSORS else (n, 3)
        assert values.shape == shape, name
        assert np.all(np.isfinite(values)), name


@ALL_TYPES
def test_names_and_fields_of_points(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Point files hold all points as vertices, with the fields in the order of the manual."""
    scene = pair_scene(sim_type)
    run_scene(mpm3d, scene, tmp_path)
    names = {
        f"{kind}.{body}.{name}.{frame:010d}.vtk"
        for kind in ("fpd", "fnd")
        for body, name in enumerate("ab")
        for frame in range(5)
    }
    assert set(os.listdir(tmp_path / "frames")) == {*names, "test.run.txt"}
    for index, body in enumerate(scene.bodies):
        for number in range(5):
            path = frame_path(tmp_path / "frames", "fpd", index, body.name, number)
            assert field_names(path) == POINT_FIELDS
            frame = read_frame(path)
            assert set(frame.fields) == set(POINT_FIELDS)
            assert_shapes(frame)
            n = len(body.rows)
            assert frame.positions.shape == (n, 3)
            assert frame.cell_types == [1] * n
            assert frame.cells == [[i] for i in range(n)]


@ALL_TYPES
def test_names_and_fields_of_nodes(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Node files hold the whole grid, with cells in the order of corners x, y, z."""
    scene = pair_scene(sim_type)
    run_scene(mpm3d, scene, tmp_path)
    dim = DIM[sim_type]
    counts = list(scene.cells)
    axes = [
        np.linspace(0.0, length, n + 1) for length, n in zip(scene.lengths, counts, strict=True)
    ]
    lattice = np.meshgrid(*reversed(axes), indexing="ij")
    expected = np.zeros((lattice[0].size, 3))
    for direction in range(dim):
        expected[:, direction] = lattice[dim - 1 - direction].ravel()
    strides = np.cumprod([1, *[n + 1 for n in counts]])[:dim]
    first = sum(
        stride * np.arange(n).reshape([-1 if k == d else 1 for k in reversed(range(dim))])
        for d, (stride, n) in enumerate(zip(strides, counts, strict=True))
    )
    corners = [
        sum(int(stride) for d, stride in enumerate(strides) if corner >> d & 1)
        for corner in range(2**dim)
    ]
    cells = [[int(node) + corner for corner in corners] for node in np.ravel(first)]
    for index, body in enumerate(scene.bodies):
        for number in range(5):
            path = frame_path(tmp_path / "frames", "fnd", index, body.name, number)
            assert field_names(path) == NODE_FIELDS
            frame = read_frame(path)
            assert set(frame.fields) == set(NODE_FIELDS)
            assert_shapes(frame)
            assert np.allclose(frame.positions, expected, rtol=0.0, atol=4 * EPSILON)
            assert frame.cell_types == [CELL_TYPE[dim]] * len(cells)
            assert frame.cells == cells
    pushed = frame.fields["contact_force_by_b_on_a"]
    assert np.abs(pushed).max() > 0.0


@ALL_TYPES
def test_fields_agree(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Fields that follow from others do so, and nodes hold the mass and momentum of the points."""
    scene = pair_scene(sim_type)
    run_scene(mpm3d, scene, tmp_path)
    for index, body in enumerate(scene.bodies):
        points, nodes = (
            read_frame(frame_path(tmp_path / "frames", kind, index, body.name, 4))
            for kind in ("fpd", "fnd")
        )
        f = points.fields
        mass, stress = f["mass"], f["cauchy_stress"].reshape(-1, 3, 3)
        scale = np.abs(stress).max()
        assert scale > 0.0
        assert np.allclose(f["momentum"], mass[:, None] * f["velocity"], rtol=2 * EPSILON)
        assert np.allclose(f["density"], mass / f["volume"], rtol=2 * EPSILON)
        trace = np.trace(stress, axis1=1, axis2=2)
        assert np.allclose(f["pressure"], -trace / 3, rtol=0.0, atol=4 * EPSILON * scale)
        assert np.array_equal(stress, stress.transpose(0, 2, 1))
        assert np.all(f["active"] == 1.0)
        force = np.zeros(3)
        force[UP[sim_type]] = -GRAVITY
        assert np.array_equal(f["body_force"], np.tile(force, (len(mass), 1)))
        # Positions are those of the file plus the displacement; TYPE 4 and 5 do not move along
        # their third component.
        moved = np.where(np.arange(3) < DIM[sim_type], f["displacement"], 0.0)
        drift = points.positions - positions(body.rows, sim_type) - moved
        assert np.abs(drift).max() <= 40 * 2 * EPSILON
        # Nodal fields are those of the start of the last step; mass does not change.
        assert np.isclose(nodes.fields["mass"].sum(), mass.sum(), rtol=64 * EPSILON)
        held = nodes.fields["mass"] > 0.0
        assert np.all(nodes.fields["velocity"][~held] == 0.0)
        step = scene.dt * nodes.fields["velocity"]
        assert np.allclose(nodes.fields["displacement"], step, rtol=4 * EPSILON)


def test_mass_in_type_4(mpm3d: Run, tmp_path: Path) -> None:
    """The table has mass and area of the meridian section; both are multiplied by r once."""
    scene = pair_scene(4)
    run_scene(mpm3d, scene, tmp_path)
    rows = scene.bodies[0].rows
    first = read_frame(frame_path(tmp_path / "frames", "fpd", 0, "a", 0))
    assert np.allclose(first.fields["mass"], rows[:, 0] * rows[:, 2], rtol=2 * EPSILON)
    assert np.allclose(first.fields["volume"], rows[:, 1] * rows[:, 2], rtol=2 * EPSILON)
    assert np.allclose(first.fields["extent"], np.sqrt(rows[:, 1]) / 2, rtol=2 * EPSILON)
    assert np.allclose(first.fields["density"], 1000.0, rtol=4 * EPSILON)


@pytest.mark.parametrize("sim_type", [4, 5])
def test_short_table(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """TYPE 4 and 5 also take tables without the third component."""
    scene = drop_scene(rate=100.0)
    scene.sim_type = sim_type
    run_scene(mpm3d, scene, tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "drop")[-1]
    assert len(last.positions) == 16
    assert np.all(last.fields["velocity"][:, 1] < 0.0)
    assert np.all(last.fields["velocity"][:, 2] == 0.0)


@ALL_TYPES
def test_minimal_fields(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """MinimalVTK writes the same numbers as DefaultVTK where both have them."""
    run_scene(mpm3d, pair_scene(sim_type), tmp_path / "all")
    run_scene(mpm3d, pair_scene(sim_type, serializer="MinimalVTK"), tmp_path / "few")
    few, points = (
        read_frame(frame_path(tmp_path / which / "frames", "fpd", 1, "b", 4))
        for which in ("few", "all")
    )
    path = frame_path(tmp_path / "few" / "frames", "fpd", 1, "b", 4)
    assert field_names(path) == [
        "velocity",
        "displacement",
        "pressure",
        "tau_bar",
        "gamma_dot",
        "density",
    ]
    assert_shapes(few)
    for name in ("velocity", "displacement", "pressure", "density"):
        assert np.array_equal(few.fields[name], points.fields[name]), name
    stress = points.fields["cauchy_stress"].reshape(-1, 3, 3)
    gradient = points.fields["velocity_gradient"].reshape(-1, 3, 3)
    rate = (gradient + gradient.transpose(0, 2, 1)) / 2
    for name, tensor, factor in (("tau_bar", stress, 0.5), ("gamma_dot", rate, 2.0)):
        mean = np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3
        size = np.linalg.norm(tensor - mean * np.eye(3), axis=(1, 2)) * np.sqrt(factor)
        assert size.max() > 0.0
        assert np.allclose(
            few.fields[name], size, rtol=16 * EPSILON, atol=16 * EPSILON * size.max()
        )
    path = frame_path(tmp_path / "few" / "frames", "fnd", 1, "b", 4)
    assert field_names(path) == ["velocity", "density"]
    nodes = read_frame(path)
    all_nodes = read_frame(frame_path(tmp_path / "all" / "frames", "fnd", 1, "b", 4))
    assert np.array_equal(nodes.fields["velocity"], all_nodes.fields["velocity"])
    assert np.array_equal(nodes.fields["density"] > 0.0, all_nodes.fields["mass"] > 0.0)


@ALL_TYPES
def test_frame_0_is_the_initial_state(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Frame 0 is labelled with the start time and shows the points as the file has them."""
    scene = pair_scene(sim_type, t_start=0.25, t_stop=0.27)
    run_scene(mpm3d, scene, tmp_path)
    nvel = NVEL[sim_type]
    for index, body in enumerate(scene.bodies):
        first = read_frame(frame_path(tmp_path / "frames", "fpd", index, body.name, 0))
        assert (first.number, first.time) == (0, 0.25)
        assert np.array_equal(first.positions, positions(body.rows, sim_type))
        velocity = first.fields["velocity"]
        assert np.array_equal(velocity[:, :nvel], body.rows[:, 2 + nvel : 2 + 2 * nvel])
        for name in ("displacement", "cauchy_stress", "velocity_gradient"):
            assert np.all(first.fields[name] == 0.0), name
        nodes = read_frame(frame_path(tmp_path / "frames", "fnd", index, body.name, 0))
        assert (nodes.number, nodes.time) == (0, 0.25)


@pytest.mark.parametrize("digits", [None, 9, 12, 15, 16, 17])
def test_digits(mpm3d: Run, tmp_path: Path, digits: int | None) -> None:
    """Numbers have the digits asked for, and nine at least."""
    # One step too short to move a point, however fast it is.
    scene = drop_scene(dt=1e-15, t_stop=1e-15)
    rows = scene.bodies[0].rows
    generator = np.random.default_rng(1)
    rows[:, 2:4] += 0.01 * generator.random((16, 2))
    rows[:, 4:6] = generator.standard_normal((16, 2)) * 10.0 ** generator.integers(-9, 9, (16, 2))
    rows[:, 0] = generator.random(16) * 1e-7
    scene.digits = digits or 9
    scene.write(tmp_path)
    if digits is None:
        config = (tmp_path / "scene.cfg").read_text()
        (tmp_path / "scene.cfg").write_text(config.replace("int-properties = {9}", ""))
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    frame = read_frame(frame_path(tmp_path / "frames", "fpd", 0, "drop", 0))
    error = 0.0 if digits == 17 else 0.5 * 10.0 ** (1 - (digits or 9))
    for found, expected in (
        (frame.positions[:, :2], rows[:, 2:4]),
        (frame.fields["velocity"][:, :2], rows[:, 4:6]),
        (frame.fields["mass"], rows[:, 0]),
    ):
        assert np.all(np.abs(found - expected) <= (error + EPSILON * (error > 0.0)) * abs(expected))


def test_inactive_points(mpm3d: Run, tmp_path: Path) -> None:
    """Points with active = 0 keep their state and their place, and weigh nothing."""
    scene = drop_scene(rate=100.0)
    rows = scene.bodies[0].rows
    inactive = np.zeros(16, dtype=bool)
    inactive[[0, 5, 6, 15]] = True
    rows[inactive, -1] = 0.0
    # An inactive point may lie outside of the grid.
    rows[5, 2:4] = 7.0
    result = run_scene(mpm3d, scene, tmp_path)
    assert "16 points (4 inactive)" in result.stdout
    for frame in read_series(tmp_path / "frames", "fpd", 0, "drop"):
        assert np.array_equal(frame.fields["active"], np.where(inactive, 0.0, 1.0))
        assert np.array_equal(frame.positions[inactive, :2], rows[inactive, 2:4])
        assert np.all(frame.fields["displacement"][inactive] == 0.0)
        assert np.all(frame.fields["velocity"][inactive] == 0.0)
    assert np.all(frame.fields["velocity"][~inactive, 1] < 0.0)
    nodes = read_series(tmp_path / "frames", "fnd", 0, "drop")[-1]
    mass = rows[~inactive, 0].sum()
    assert nodes.fields["mass"].sum() == pytest.approx(mass, rel=64 * EPSILON)


def test_all_points_inactive(mpm3d: Run, tmp_path: Path) -> None:
    """A body without an active point does nothing."""
    scene = drop_scene(rate=100.0)
    scene.bodies[0].rows[:, -1] = 0.0
    scene.write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == 0
    assert result.stderr == 'warning: body "drop" has no active point\n'
    last = read_series(tmp_path / "frames", "fpd", 0, "drop")[-1]
    assert np.array_equal(last.positions, positions(scene.bodies[0].rows, 2))
    assert np.all(last.fields["active"] == 0.0)


def test_points_keep_their_order(mpm3d: Run, tmp_path: Path) -> None:
    """Frames are in the order of the points file, however the points move."""
    generator = np.random.default_rng(2)
    rows = block(2, [0.3, 0.3], [0.6, 0.6], [12, 12], velocity=[20.0, 10.0])
    rows = rows[generator.permutation(len(rows))]
    scene = drop_scene(
        bodies=[Body("drop", rows)], gravity=[0.0, 0.0], rate=1000.0, t_stop=0.012, cells=[40, 40]
    )
    run_scene(mpm3d, scene, tmp_path)
    for frame in read_series(tmp_path / "frames", "fpd", 0, "drop"):
        way = np.array([20.0, 10.0, 0.0]) * frame.time
        assert np.abs(frame.positions - positions(rows, 2) - way).max() <= 12 * ROUNDING


def test_projectile_before_its_launch(mpm3d: Run, tmp_path: Path) -> None:
    """Until t = 0 the projectile has positions and no fields; after that it flies."""
    driver = """driver
{
    class = "BallisticDriver"
    properties = {0.004, 3.0, 2.0}
    str-properties = {"shot"}
}
"""
    target = Body("target", block(2, [0.7, 0.1], [0.9, 0.3], [4, 4], velocity=[9.0, 0.0]))
    shot = Body("shot", block(2, [0.2, 0.5], [0.4, 0.7], [4, 4], velocity=[9.0, 9.0]))
    target.rows[:, 4] = 0.0
    scene = drop_scene(
        bodies=[target, shot], driver=driver, t_start=-0.003, rate=1000.0, contacts=[]
    )
    result = run_scene(mpm3d, scene, tmp_path)
    assert "not yet active" in result.stdout
    folder = tmp_path / "frames"
    series = read_series(folder, "fpd", 1, "shot")
    assert len(series) == 8
    for frame in series:
        launched = frame.time > 0.0
        path = frame_path(folder, "fpd", 1, "shot", frame.number)
        assert field_names(path) == (POINT_FIELDS if launched else [])
        n = round(frame.time / 1e-3) if launched else 0
        fall = GRAVITY * 1e-6 * n * (n + 1) / 2
        way = np.array([3.0 * n * 1e-3, 2.0 * n * 1e-3 - fall, 0.0])
        mean = (frame.positions - positions(shot.rows, 2)).mean(axis=0)
        assert np.abs(mean - way).max() <= 8 * ROUNDING
    waiting = read_frame(frame_path(folder, "fnd", 1, "shot", 0))
    assert not waiting.fields
    for frame in read_series(folder, "fpd", 0, "target"):
        assert list(frame.fields)
