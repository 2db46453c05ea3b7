"""Two bodies that meet: momentum, and the same bytes for any number of threads."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest
from frames import Array, Frame, read_series
from scene import DIM, ROUNDING, Body, Run, Scene, block, huang, run_scene

MAPPINGS = pytest.mark.parametrize("cpdi", [0, 1])
CONTACTS = pytest.mark.parametrize("implicit", [0, 1])


def momentum(frames: tuple[Frame, ...]) -> Array:
    """Return the sum of the points' momenta over bodies."""
    return sum((frame.fields["momentum"].sum(axis=0) for frame in frames), np.zeros(3))


@MAPPINGS
@CONTACTS
@pytest.mark.parametrize("sim_type", [2, 3, 5])
def test_momentum_of_a_collision(
    mpm3d: Run, tmp_path: Path, sim_type: int, cpdi: int, implicit: int
) -> None:
    """An oblique collision with friction changes each momentum, and the sum by rounding only."""
    dim = DIM[sim_type]
    fast, slow = [2.0, 0.7, 0.4], [-1.0, 0.0, -0.2]
    nvel = 2 if sim_type == 2 else 3
    left = block(sim_type, [0.2] + [0.4] * (dim - 1), [0.4] + [0.6] * (dim - 1), [4] * dim)
    right = block(sim_type, [0.5] + [0.35] * (dim - 1), [0.7] + [0.65] * (dim - 1), [4] * dim)
    left[:, -1 - nvel : -1] = fast[:nvel]
    right[:, -1 - nvel : -1] = slow[:nvel]
    steps, dt = 80, 5e-4
    scene = Scene(
        sim_type,
        lengths=[1.0] * dim,
        cells=[10] * dim,
        bodies=[Body("left", left), Body("right", right, modulus=2e5, poisson=0.2)],
        contacts=[huang("left", "right")],
        gravity=[0.0] * nvel,
        cpdi=cpdi,
        implicit_contact=implicit,
        dt=dt,
        t_stop=steps * dt,
        rate=8 / (steps * dt),
    )
    run_scene(mpm3d, scene, tmp_path)
    series = [
        read_series(tmp_path / "frames", "fpd", body, name)
        for body, name in enumerate(["left", "right"])
    ]
    frames = list(zip(*series, strict=True))
    assert len(frames) == 9

    scale = sum(float(np.abs(frame.fields["momentum"]).sum()) for frame in frames[0])
    start = momentum(frames[0])
    for pair in frames[1:]:
        assert np.all(np.abs(momentum(pair) - start) <= ROUNDING * steps * scale)
    change = momentum(frames[-1][:1]) - momentum(frames[0][:1])
    # A tenth of the momentum along the normal has passed over, and some along the face.
    assert change[0] < -0.1 * abs(momentum(frames[0][:1])[0])
    assert np.abs(change[1:nvel]).max() > 1e-3 * abs(change[0])


def crossing_scene(sim_type: int, per_side: int, overlap: float) -> Scene:
    """Make two blocks that move across cells while they touch, with a point in each cell.

    Each has enough points for three threads, and the box of its nodes enough nodes; masses vary,
    so that contact normals exist also where the blocks overlap.
    """
    dim = DIM[sim_type]
    h = 0.01
    side, gap = per_side * h, 2 * h
    shift = side + 0.5 * h - overlap * side
    low_corner, high_corner = [gap + 0.3 * h] * dim, [gap + 0.3 * h] * dim
    high_corner[-1] += shift
    bodies = []
    for name, corner, sign in (("low", low_corner, 1.0), ("high", high_corner, -1.0)):
        upper = [x + side for x in corner]
        rows = block(sim_type, corner, upper, [per_side] * dim)
        position = rows[:, 2 : 2 + dim]
        rows[:, 0] *= 1.0 + 0.2 * np.sin(40.0 * position).prod(axis=1)
        # Every point has a velocity of its own, so that all stresses and sums are odd numbers.
        velocity = np.zeros(dim)
        velocity[0], velocity[-1] = 1.5, sign
        rows[:, 2 + dim : 2 + 2 * dim] = velocity + 0.3 * np.sin(25.0 * position)
        bodies.append(Body(name, rows, modulus=2e4))
    cells = [per_side + 8] * dim
    cells[-1] = int(np.ceil((shift + side) / h)) + 8
    return Scene(
        sim_type,
        lengths=[n * h for n in cells],
        cells=cells,
        bodies=bodies,
        contacts=[huang("low", "high")],
        gravity=[0.0] * dim,
        dt=5e-4,
        t_stop=0.02,
        rate=50.0,
        # The most digits that are written fast. Numbers that differ in their last bit differ in
        # these digits one time in five or ten, and there are some 100,000 of them.
        digits=15,
    )


def hashes(folder: Path) -> dict[str, str]:
    """Return a digest of each frame."""
    return {
        path.name: hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.glob("*.vtk"))
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sim_type", "per_side", "overlap"),
    [
        pytest.param(2, 80, 0.0, id="2D"),
        pytest.param(2, 80, 0.95, id="2D-overlapping"),
        pytest.param(3, 19, 0.0, id="3D"),
    ],
)
def test_same_bytes_for_any_number_of_threads(
    mpm3d: Run, tmp_path: Path, sim_type: int, per_side: int, overlap: float
) -> None:
    """Frames of 1, 2 and 3 threads do not differ in a byte."""
    scene = crossing_scene(sim_type, per_side, overlap)
    found = []
    for threads in (1, 2, 3):
        folder = tmp_path / str(threads)
        result = run_scene(mpm3d, scene, folder, "--threads", str(threads))
        assert f"on {threads} thread" in result.stdout
        found.append(hashes(folder / "frames"))
    assert len(found[0]) == 2 * 2 * 2
    assert found[1] == found[0]
    assert found[2] == found[0]

    # The run was worth the comparison: the bodies pushed each other, and points changed their cell.
    first, last = read_series(tmp_path / "1/frames", "fpd", 0, "low")
    mass, up = scene.bodies[0].rows[:, 0], DIM[sim_type] - 1
    before, after = (mass @ frame.fields["velocity"][:, up] for frame in (first, last))
    assert after < 0.99 * before
    cells_before, cells_after = (np.floor(frame.positions / 0.01) for frame in (first, last))
    assert np.any(cells_before != cells_after, axis=1).mean() > 0.5
