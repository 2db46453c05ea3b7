"""Bodies on triangles, tetrahedra and uneven lines: what does not depend on the cells is exact."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from frames import read_series
from meshes import CELLS, MESH, TETRAHEDRA, TRIANGLES, write_mesh
from scene import (
    DIM,
    GRAVITY,
    NVEL,
    ROUNDING,
    UP,
    Body,
    Run,
    Scene,
    block,
    huang,
    positions,
    run_scene,
)

STEPS = 50
DT = 1e-3
LINES = """grid
{
    class = "Linear1DNonUniform"
    properties = {1.0}
    int-properties = {20}
}
"""
#: The section grid, by TYPE.
GRIDS = {1: LINES, 3: TETRAHEDRA + "\n"} | dict.fromkeys((2, 4, 5), TRIANGLES + "\n")
ALL_TYPES = pytest.mark.parametrize("sim_type", sorted(GRIDS))
MAPPINGS = pytest.mark.parametrize("cpdi", [0, 1])


def mesh_scene(folder: Path, sim_type: int, bodies: list[Body], **changes: object) -> Scene:
    """Make a scene in a unit box on a mesh, and write the mesh."""
    dim = DIM[sim_type]
    folder.mkdir(parents=True, exist_ok=True)
    write_mesh(folder / MESH, max(2, dim), CELLS[dim])
    settings: dict[str, object] = {
        "lengths": [1.0] * dim,
        "cells": [CELLS[dim]] * dim,
        "bodies": bodies,
        "dt": DT,
        "t_stop": STEPS * DT,
        "rate": 1.0 / (STEPS * DT),
        "grid": GRIDS[sim_type],
    }
    return Scene(sim_type, **{**settings, **changes})  # type: ignore[arg-type]


@MAPPINGS
@ALL_TYPES
def test_free_fall_is_exact(mpm3d: Run, tmp_path: Path, sim_type: int, cpdi: int) -> None:
    """After n steps the centre of mass has moved -g dt^2 n (n + 1)/2."""
    dim = DIM[sim_type]
    rows = block(sim_type, [0.4] * dim, [0.6] * dim, [4] * dim)
    run_scene(mpm3d, mesh_scene(tmp_path, sim_type, [Body("faller", rows)], cpdi=cpdi), tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "faller")[-1]
    mass = last.fields["mass"]
    moved = mass @ last.fields["displacement"] / mass.sum()
    fall = GRAVITY * DT**2 * STEPS * (STEPS + 1) / 2
    up = UP[sim_type]
    assert abs(moved[up] + fall) <= ROUNDING * STEPS * fall
    others = [component for component in range(3) if component != up]
    if sim_type == 4:
        # Hoop stresses, themselves rounding errors, do not cancel along r.
        others.remove(0)
    assert np.all(np.abs(moved[others]) <= ROUNDING * STEPS * fall)


@MAPPINGS
@ALL_TYPES
@pytest.mark.parametrize(
    "components",
    [
        pytest.param((5.0123, -6.0456, 4.0789), id="between-nodes"),
        # Now and then points lie on edges and nodes.
        pytest.param((5.0, -5.0, 5.0), id="over-nodes"),
    ],
)
def test_free_flight_is_exact(
    mpm3d: Run, tmp_path: Path, sim_type: int, cpdi: int, components: tuple[float, float, float]
) -> None:
    """Without gravity every point keeps its velocity, across several cells."""
    dim, nvel = DIM[sim_type], NVEL[sim_type]
    velocity = np.zeros(3)
    velocity[:nvel] = components[:nvel]
    if sim_type == 4:
        # Only along z is a straight line free of hoop strain and inertia of the basis.
        velocity[[0, 2]] = 0.0
    rows = block(sim_type, [0.4] * dim, [0.6] * dim, [4] * dim, velocity=velocity[:nvel].tolist())
    bodies = [Body("flyer", rows)]
    scene = mesh_scene(tmp_path, sim_type, bodies, cpdi=cpdi, gravity=[0.0] * nvel)
    run_scene(mpm3d, scene, tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "flyer")[-1]
    way = velocity * STEPS * DT
    in_plane = np.where(np.arange(3) < dim, way, 0.0)
    speed = float(np.linalg.norm(velocity))
    # As on Cartesian cells: a step moves a point by less than its distance from the origin.
    tolerance = ROUNDING * STEPS
    assert np.all(np.abs(last.fields["velocity"] - velocity) <= tolerance * speed)
    assert np.all(np.abs(last.fields["displacement"] - way) <= tolerance)
    assert np.all(np.abs(last.positions - positions(rows, sim_type) - in_plane) <= tolerance)


@pytest.mark.parametrize("mesh", [False, True], ids=["cells", "triangles"])
def test_wave_in_a_bar(mpm3d: Run, tmp_path: Path, mesh: bool) -> None:
    """A bar between smooth walls swings in its first mode: u = a sin(pi x) cos(c pi t)."""
    amplitude, modulus, poisson = 1e-4, 1e3, 0.0
    rows = block(2, [0.0, 0.4], [1.0, 0.5], [40, 4])
    speed = math.sqrt(modulus / 1000.0)
    rows[:, 4] = amplitude * math.pi * speed * np.sin(math.pi * rows[:, 2])
    body = Body("bar", rows, modulus, poisson, 'boundary-class = "CartesianSmoothBox"')
    # A quarter of the period, when the velocity is 0 and the displacement largest.
    t_stop = 0.5 / speed
    changes: dict[str, object] = {
        "gravity": [0.0, 0.0],
        "cpdi": 0,
        "dt": t_stop / 400,
        "t_stop": t_stop,
        "rate": 1.0 / t_stop,
    }
    if not mesh:
        changes["grid"] = None
    run_scene(mpm3d, mesh_scene(tmp_path, 2, [body], **changes), tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "bar")[-1]
    shape = np.sin(math.pi * rows[:, 2])
    found = shape @ last.fields["displacement"][:, 0] / (shape @ shape)
    # Lumped masses change the frequency by (pi h)^2/24, h = 1/10; the map from points to nodes, a
    # mean over hats of variance h^2/6, the amplitude by (pi h)^2/12. Twice their sum.
    assert abs(found / amplitude - 1.0) <= (math.pi / 10) ** 2 / 4
    # The quarter of the period is late by the change of the frequency, and the velocity follows.
    velocity = shape @ last.fields["velocity"][:, 0] / (shape @ shape)
    assert abs(velocity) <= math.pi**3 / 800 * amplitude * math.pi * speed


def test_contact_conserves_momentum(mpm3d: Run, tmp_path: Path) -> None:
    """Two blocks on triangles meet and part; momentum stays, and both have felt the other."""
    left = Body("left", block(2, [0.2, 0.4], [0.45, 0.6], [10, 8], velocity=[0.5, 0.0]))
    right = Body("right", block(2, [0.55, 0.4], [0.8, 0.6], [10, 8], velocity=[-0.5, 0.0]))
    scene = mesh_scene(
        tmp_path,
        2,
        [left, right],
        gravity=[0.0, 0.0],
        dt=5e-4,
        t_stop=0.3,
        rate=1.0 / 0.3,
        contacts=[huang("left", "right")],
    )
    run_scene(mpm3d, scene, tmp_path)
    speeds = []
    for number, body in enumerate((left, right)):
        last = read_series(tmp_path / "frames", "fpd", number, body.name)[-1]
        mass = last.fields["mass"]
        speeds.append(mass @ last.fields["velocity"] / mass.sum())
    assert np.all(np.abs(speeds[0] + speeds[1]) <= ROUNDING * 600)
    assert speeds[0][0] < -0.2


@pytest.mark.parametrize("cpdi", [0, 1])
@pytest.mark.parametrize("sim_type", [2, 3])
def test_same_bits_on_any_number_of_threads(
    mpm3d: Run, tmp_path: Path, sim_type: int, cpdi: int
) -> None:
    """Enough points that threads share the work."""
    dim = DIM[sim_type]
    counts = [64, 64] if dim == 2 else [16, 16, 16]
    rows = block(sim_type, [0.2] * dim, [0.7] * dim, counts)
    rng = np.random.default_rng(1)
    rows[:, 2 + dim : 2 + 2 * dim] = rng.uniform(-0.05, 0.05, (len(rows), dim))
    # Free edges need shorter steps than the inside of bodies.
    dt = DT / 4
    changes = {"cpdi": cpdi, "dt": dt, "t_stop": STEPS * dt, "rate": 5.0 / dt / STEPS}
    scene = mesh_scene(tmp_path, sim_type, [Body("cloud", rows)], **changes)
    texts = []
    for threads in (1, 2, 3):
        run_scene(mpm3d, scene, tmp_path, "--threads", str(threads))
        frames = sorted((tmp_path / "frames").glob("*.vtk"))
        texts.append([path.read_bytes() for path in frames])
    assert len(texts[0]) == 12
    assert texts[0] == texts[1] == texts[2]


def test_formats_give_the_same_run(mpm3d: Run, tmp_path: Path) -> None:
    """Versions 2.2 and 4.1, ASCII and binary."""
    rows = block(2, [0.4, 0.05], [0.6, 0.25], [8, 8])
    body = Body("block", rows, more='boundary-class = "CartesianBox"')
    scene = mesh_scene(tmp_path, 2, [body])
    texts = []
    for version in ("2.2", "4.1"):
        for binary in (False, True):
            write_mesh(tmp_path / MESH, 2, CELLS[2], version, binary=binary)
            # The scene would write its own mesh.
            result = mpm3d("-c", scene.write(tmp_path).name, cwd=tmp_path)
            assert (result.returncode, result.stderr) == (0, "")
            frames = sorted((tmp_path / "frames").glob("*.vtk"))
            texts.append([path.read_bytes() for path in frames])
    assert all(text == texts[0] for text in texts)


@pytest.mark.parametrize("sim_type", [1, 2, 3])
def test_stable_step_is_stable(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Noise does not grow in steps of the length that the program tells."""
    dim = DIM[sim_type]
    counts = {1: [40], 2: [40, 40], 3: [12, 12, 12]}[dim]
    rows = block(sim_type, [0.1] * dim, [0.9] * dim, counts)
    rng = np.random.default_rng(2)
    rows[:, 2 + dim : 2 + 2 * dim] = rng.uniform(-1e-4, 1e-4, (len(rows), dim))
    body = Body("block", rows, 1e5, 0.3, 'boundary-class = "CartesianSmoothBox"')
    scene = mesh_scene(tmp_path, sim_type, [body], gravity=[0.0] * dim, cpdi=0)
    scene.write(tmp_path)
    check = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    limit = float(check.stdout.partition("stable step ")[2].split()[0])
    scene = mesh_scene(
        tmp_path,
        sim_type,
        [body],
        gravity=[0.0] * dim,
        cpdi=0,
        dt=0.99 * limit,
        t_stop=2000 * 0.99 * limit,
        rate=1.0 / (2000 * 0.99 * limit),
    )
    run_scene(mpm3d, scene, tmp_path)
    first, last = read_series(tmp_path / "frames", "fpd", 0, "block")
    assert np.abs(last.fields["velocity"]).max() <= 3 * np.abs(first.fields["velocity"]).max()


def test_frames_are_read_by_vtk(mpm3d: Run, tmp_path: Path) -> None:
    """One block POINTS, and cells of VTK's kinds."""
    kinds = {1: (3, 2), 2: (5, 3), 3: (10, 4)}
    for sim_type, (kind, corners) in kinds.items():
        folder = tmp_path / str(sim_type)
        dim = DIM[sim_type]
        rows = block(sim_type, [0.4] * dim, [0.6] * dim, [2] * dim)
        run_scene(mpm3d, mesh_scene(folder, sim_type, [Body("b", rows)], t_stop=DT), folder)
        path = folder / "frames" / "fnd.0.b.0000000000.vtk"
        lines = path.read_text().splitlines()
        assert sum(line.startswith("POINTS ") for line in lines) == 1
        cells = next(line for line in lines if line.startswith("CELLS ")).split()
        assert int(cells[2]) == int(cells[1]) * (corners + 1)
        first = lines.index(f"CELL_TYPES {cells[1]}") + 1
        assert set(lines[first : first + int(cells[1])]) == {str(kind)}
        if sim_type > 1:
            assert any(line.startswith("SCALARS node_tags") for line in lines)


def test_what_needs_cartesian_cells_says_so(mpm3d: Run, tmp_path: Path) -> None:
    """Classes that can't go with a mesh stop before the run."""
    rows = block(2, [0.4, 0.4], [0.6, 0.6], [4, 4])
    solver = 'solver {{ class = "{}" str-properties = {{{}}} }}\n'
    scenes = {
        "APIC and MLS need a Cartesian grid": {"solver": solver.format("ExplicitUSL", '"APIC"')},
        "smoothing of strains needs a Cartesian grid": {
            "solver": solver.format("ExplicitUSLwithVolumetricStrainSmoothing", "")
        },
    }
    for message, changes in scenes.items():
        mesh_scene(tmp_path, 2, [Body("b", rows)], **changes).write(tmp_path)
        result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
        assert result.returncode == 2
        assert message in result.stderr
    box = 'boundary-class = "CartesianBoxCustom" boundary-int-props = {1, 1, 1, 1}'
    mesh_scene(tmp_path, 2, [Body("b", rows, more=box)]).write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    assert result.returncode == 2
    assert "needs a Cartesian grid" in result.stderr
    improved = mesh_scene(tmp_path, 2, [Body("b", rows)])
    path = improved.write(tmp_path)
    text = path.read_text()
    improved_points = '"ImprovedQuadraturePoints"\n    point-int-props = {0}'
    text = text.replace('"DefaultPoints"', improved_points)
    path.write_text(text)
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    assert result.returncode == 2
    assert "ImprovedQuadraturePoints need a Cartesian grid" in result.stderr
