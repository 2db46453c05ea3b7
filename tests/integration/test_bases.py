"""Grids with smooth functions and with periodic faces: free motion, seams, fields, threads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frames import Array, Frame, read_series
from scene import DIM, EPSILON, ROUNDING, UP, Body, Run, Scene, block, huang, run_scene
from test_collision import hashes
from test_solvers import TRANSFERS, section

CELL = 1 / 16
CLASSES = (
    "CartesianPeriodic",
    "CartesianCustom",
    "CartesianQuadratic",
    "CartesianQuadraticCustom",
    "CartesianCubic",
    "CartesianCubicCustom",
    "CartesianCubic_Offset",
    "CartesianUGIMP",
    "CartesianUGIMPCustom",
)
PERIODIC = [name for name in CLASSES if "Custom" in name or "Periodic" in name]
MAPPINGS = pytest.mark.parametrize("cpdi", [0, 1])


def grid(name: str, sim_type: int, cells: int = 16) -> str:
    """Return the section of a grid with sides of 1; *Custom grids are periodic but along the last.

    TYPE 4 has a radius along x, so that its grids are periodic along the height instead.
    """
    dim = DIM[sim_type]
    reals = ["1"] * dim
    integers = [str(cells)] * dim
    if "UGIMP" in name:
        reals.append(repr(0.25 / cells))
    if name == "CartesianCubic_Offset":
        reals.append("r0 = 0")
    if "Custom" in name:
        flags = ["1"] * (dim - 1) + ["0"]
        integers += flags[::-1] if sim_type == 4 else flags
    return f"""grid
{{
    class = "{name}"
    properties = {{{", ".join(reals)}}}
    int-properties = {{{", ".join(integers)}}}
}}
"""


@MAPPINGS
@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize("sim_type", [1, 2, 3, 4, 5])
def test_free_fall_is_exact(
    mpm3d: Run, tmp_path: Path, name: str, sim_type: int, cpdi: int
) -> None:
    """After n steps the centre of mass has moved -g dt^2 n (n + 1)/2; bodies may cross seams."""
    if (name, sim_type) in {
        ("CartesianPeriodic", 4),
        ("CartesianCubic_Offset", 1),
        ("CartesianCubic_Offset", 3),
    }:
        pytest.skip("the class has no grids of this TYPE")
    dim, up, steps, dt = DIM[sim_type], UP[sim_type], 20, 1e-3
    lower = [0.5] * dim
    if name in PERIODIC and sim_type not in (1, 4):
        lower[0] = 1 - 2 * CELL
    upper = [x + 4 * CELL for x in lower]
    scene = Scene(
        sim_type,
        lengths=[],
        cells=[],
        grid=grid(name, sim_type),
        bodies=[Body("faller", block(sim_type, lower, upper, [8] * dim))],
        cpdi=cpdi,
        dt=dt,
        t_stop=steps * dt,
        rate=1 / (steps * dt),
    )
    run_scene(mpm3d, scene, tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "faller")[-1]
    mass = last.fields["mass"]
    moved = mass @ last.fields["displacement"] / mass.sum()
    fall = 9.81 * dt**2 * steps * (steps + 1) / 2
    # Sums over up to 5^3 nodes, in place of 2^3, and the points of as many cells.
    tolerance = 16 * ROUNDING * steps * fall
    assert abs(moved[up] + fall) <= tolerance
    others = [c for c in range(3) if c != up and not (sim_type == 4 and c == 0)]
    assert np.all(np.abs(moved[others]) <= tolerance)
    assert np.all(last.positions[:, :dim] >= 0) and np.all(last.positions[:, :dim] <= 1)


def collision(name: str, sim_type: int, cpdi: int, shift: float) -> Scene:
    """Make two blocks that meet at x = shift, and collide along the periodic x."""
    dim = DIM[sim_type]
    rest = dim - 1
    lower, upper = [0.25] * rest, [0.5] * rest
    left = block(sim_type, [shift - 0.25, *lower], [shift, *upper], [8] * dim)
    right = block(sim_type, [shift, *lower], [shift + 0.25, *upper], [8] * dim)
    nvel = 3 if sim_type != 2 else 2
    left[:, 2 + nvel : 2 + 2 * nvel] = [1.5, 0.5, 0.25][:nvel]
    right[:, 2 + nvel : 2 + 2 * nvel] = [-1.0, -0.25, 0.0][:nvel]
    return Scene(
        sim_type,
        lengths=[],
        cells=[],
        grid=grid(name, sim_type),
        bodies=[Body("left", left), Body("right", right, modulus=2e5, poisson=0.25)],
        contacts=[huang("left", "right", 0.25)],
        gravity=[0.0] * nvel,
        cpdi=cpdi,
        dt=2.0**-12,
        t_stop=40 * 2.0**-12,
        rate=2.0**12 / 40,
    )


def last_frames(folder: Path, kind: str = "fpd") -> list[Frame]:
    """Return the last frame of both bodies."""
    return [
        read_series(folder / "frames", kind, number, name)[-1]
        for number, name in enumerate(["left", "right"])
    ]


@MAPPINGS
@pytest.mark.parametrize("name", PERIODIC)
@pytest.mark.parametrize("sim_type", [2, 3])
def test_seam_is_nowhere(mpm3d: Run, tmp_path: Path, name: str, sim_type: int, cpdi: int) -> None:
    """A collision on the seam is the same as one half a period away."""
    compare_places(mpm3d, tmp_path, name, sim_type, cpdi)


@pytest.mark.parametrize("name", [name for name in PERIODIC if "UGIMP" not in name])
@pytest.mark.parametrize("solver", ["ExplicitUSL", "ExplicitMUSL", "ExplicitUSF"])
@pytest.mark.parametrize("transfer", [name for name in TRANSFERS if name != "FLIP"])
def test_seam_is_nowhere_with_any_transfer(
    mpm3d: Run, tmp_path: Path, transfer: str, solver: str, name: str
) -> None:
    """Second mappings, affine fields, fitted slopes and filters pass the seam, too."""
    for cpdi in (0, 1):
        lines = f"int-properties = {{cpdi = {cpdi}}}\n    {TRANSFERS[transfer]}"
        compare_places(mpm3d, tmp_path / str(cpdi), name, 2, cpdi, section(solver, lines))


@pytest.mark.parametrize("name", PERIODIC)
@pytest.mark.parametrize("solver", ["ExplicitMUSL", "ExplicitUSF"])
def test_seam_is_nowhere_with_mapped_velocities(
    mpm3d: Run, tmp_path: Path, solver: str, name: str
) -> None:
    """The solvers with FLIP, in three dimensions."""
    compare_places(mpm3d, tmp_path, name, 3, 1, section(solver))


def compare_places(
    mpm3d: Run, folder: Path, name: str, sim_type: int, cpdi: int, solver: str | None = None
) -> None:
    """Compare a collision on the seam with one half a period away."""
    found = []
    for shift in (0.5, 0.0, 1.0):
        scene = collision(name, sim_type, cpdi, shift)
        scene.solver = solver
        run_scene(mpm3d, scene, folder / str(shift))
        found.append(last_frames(folder / str(shift)))
    mass = [frame.fields["mass"] for frame in found[0]]
    momentum = [m @ frame.fields["velocity"] for m, frame in zip(mass, found[0], strict=True)]
    scale = float(mass[0].sum()) * 1.5
    # They have pushed each other.
    assert momentum[0][0] < 0.9 * scale
    total = np.array([1.5 - 1.0, 0.5 - 0.25, 0.25 * (sim_type == 3)]) * mass[0].sum()
    assert np.all(np.abs(sum(momentum) - total) <= 40 * ROUNDING * scale)
    # Sums in another order round differently, which 40 steps of an elastic body spread only.
    tolerance = 1e4 * EPSILON
    for other in found[1:]:
        for one, two in zip(found[0], other, strict=True):
            for field, size in (("velocity", 1.5), ("displacement", 0.015), ("volume", 1e-3)):
                difference = np.abs(one.fields[field] - two.fields[field])
                assert np.max(difference) <= tolerance * size
            stress = one.fields["cauchy_stress"]
            difference = np.abs(stress - two.fields["cauchy_stress"])
            assert np.max(difference) <= tolerance * 1e5


@pytest.mark.parametrize("name", ["CartesianCubicCustom", "CartesianCustom"])
def test_last_node_of_a_period_is_the_first(mpm3d: Run, tmp_path: Path, name: str) -> None:
    """All node fields agree on both faces, and masses add up without the last one."""
    run_scene(mpm3d, collision(name, 2, 0, 0.0), tmp_path)
    points = last_frames(tmp_path)
    for body, frame in enumerate(last_frames(tmp_path, "fnd")):
        for values in frame.fields.values():
            rows = values.reshape(17, 17, -1)
            assert np.array_equal(rows[:, 0], rows[:, -1])
        mass = frame.fields["mass"].reshape(17, 17)[:, :-1].sum()
        assert abs(mass / points[body].fields["mass"].sum() - 1) <= ROUNDING
        assert frame.fields["mass"].reshape(17, 17)[:, 0].sum() > 0


def node_fields(mpm3d: Run, folder: Path, name: str) -> dict[str, Array]:
    """Return the node fields of a moving block in a corner of 16 x 16 cells."""
    rows = block(2, [0, 0], [0.25, 0.25], [8, 8], velocity=[2.0, -3.0])
    scene = Scene(
        2, lengths=[], cells=[], grid=grid(name, 2), bodies=[Body("left", rows)], t_stop=1e-3
    )
    run_scene(mpm3d, scene, folder)
    return read_series(folder / "frames", "fnd", 0, "left")[0].fields


@pytest.mark.parametrize("name", ["CartesianQuadratic", "CartesianCubic", "CartesianUGIMP"])
def test_fields_of_smooth_functions(mpm3d: Run, tmp_path: Path, name: str) -> None:
    """The velocity of the grid comes first; kinds of nodes are those at walls."""
    fields = node_fields(mpm3d, tmp_path, name)
    assert next(iter(fields)) == "grid_velocity"
    assert list(fields)[-1] == "edge_id"
    line = np.array([0, 1, *[2] * 13, -1, 0])
    edge = fields["edge_id"].reshape(17, 17, 3)
    assert np.array_equal(edge[:, :, 0], np.tile(line, (17, 1)))
    assert np.array_equal(edge[:, :, 1], np.tile(line[:, None], (1, 17)))
    velocity = fields["grid_velocity"].reshape(17, 17, 3)
    # Where all nodes around move, the grid moves as they do; farther away it is at rest.
    tolerance = ROUNDING * 3
    assert np.all(np.abs(velocity[:3, :3] - [2.0, -3.0, 0.0]) <= tolerance)
    assert np.all(velocity[8:] == 0) and np.all(velocity[:, 8:] == 0)
    # One cell further than the last node that moves, a part of its velocity.
    moving = np.flatnonzero(np.abs(fields["velocity"].reshape(17, 17, 3)[0, :, 0]) > 0)[-1]
    side = {"CartesianQuadratic": 1 / 8, "CartesianCubic": 1 / 6, "CartesianUGIMP": 1 / 16}[name]
    assert abs(velocity[0, moving + 1, 0] - 2.0 * side) <= tolerance


def test_linear_grids_have_no_such_fields(mpm3d: Run, tmp_path: Path) -> None:
    """The velocity of the grid at a node is that of the node."""
    assert {"grid_velocity", "edge_id"}.isdisjoint(node_fields(mpm3d, tmp_path, "CartesianCustom"))


@pytest.mark.parametrize(
    ("name", "sim_type", "cpdi"),
    [("CartesianCubicCustom", 2, 0), ("CartesianCustom", 3, 1), ("CartesianUGIMPCustom", 3, 0)],
)
def test_same_bytes_for_any_number_of_threads(
    mpm3d: Run, tmp_path: Path, name: str, sim_type: int, cpdi: int
) -> None:
    """Frames of 1, 2 and 3 threads do not differ in a byte, bodies on a seam included."""
    scene = collision(name, sim_type, cpdi, 0.0)
    for body in scene.bodies:
        x = body.rows[:, 2]
        body.rows[:, 2 + sim_type] += 0.3 * np.sin(25 * x) * body.rows[:, 3]
    mapped = section("ExplicitMUSL", f"{TRANSFERS['MLS']}\n    int-properties = {{cpdi = {cpdi}}}")
    for solver in (None, mapped):
        scene.solver = solver
        found = []
        for threads in (1, 2, 3):
            folder = tmp_path / f"{threads}-{solver is None}"
            run_scene(mpm3d, scene, folder, "--threads", str(threads))
            found.append(hashes(folder / "frames"))
        assert len(found[0]) == 8
        assert found[0] == found[1] == found[2]


def test_a_body_goes_round(mpm3d: Run, tmp_path: Path) -> None:
    """After a period a free body is where it was; its displacement has counted the way."""
    rows = block(2, [0.25, 0.25], [0.5, 0.5], [8, 8], velocity=[16.0, 0.0])
    scene = Scene(
        2,
        lengths=[],
        cells=[],
        grid=grid("CartesianQuadraticCustom", 2),
        bodies=[Body("flyer", rows)],
        gravity=[0.0, 0.0],
        dt=2.0**-10,
        t_stop=2.0**-4,
        rate=2.0**4,
    )
    run_scene(mpm3d, scene, tmp_path)
    first, last = read_series(tmp_path / "frames", "fpd", 0, "flyer")
    assert np.all(np.abs(last.positions - first.positions) <= 64 * ROUNDING)
    assert np.all(np.abs(last.fields["displacement"] - [1.0, 0.0, 0.0]) <= 64 * ROUNDING)


def test_origin(mpm3d: Run, tmp_path: Path) -> None:
    """A grid with an origin holds a body that rests on its lower faces."""
    rows = block(2, [-0.5, 3.0], [-0.25, 3.25], [8, 8])
    section = """grid
{
    class = "CartesianLinear"
    properties = {1, 1, x0 = -0.5, y0 = 3}
    int-properties = {16, 16}
}
"""
    body = Body("block", rows, modulus=1e6, more='boundary-class = "CartesianSmoothBox"')
    scene = Scene(
        2, lengths=[], cells=[], grid=section, bodies=[body], dt=1e-4, t_stop=0.05, rate=20
    )
    run_scene(mpm3d, scene, tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "block")[-1]
    nodes = read_series(tmp_path / "frames", "fnd", 0, "block")[-1]
    assert nodes.positions[:, 0].min() == -0.5 and nodes.positions[:, 1].max() == 4.0
    # rho g H^2/2M is 2 % of what free fall would have been.
    assert np.abs(last.fields["displacement"]).max() <= 0.05 * 9.81 * 0.05**2 / 2
    assert np.abs(last.fields["displacement"]).max() > 0


@pytest.mark.parametrize(
    ("name", "kappa"),
    [
        ("CartesianUGIMP", 13 / 96),
        ("CartesianQuadratic", 25 / 96),
        ("CartesianCubic", 1 / 3),
        ("CartesianUGIMPCustom", 13 / 96),
        ("CartesianQuadraticCustom", 25 / 96),
        ("CartesianCubicCustom", 1 / 3),
        ("CartesianCustom", 13 / 96),
    ],
)
def test_frequency_of_a_standing_wave(mpm3d: Run, tmp_path: Path, name: str, kappa: float) -> None:
    """A resolved mode is too slow by the part kappa (k h)^2 - (c dt/h)^2 (k h)^2/24.

    kappa comes from the symbols of the functions with two points a cell; what follows is of the
    order (k h)^4, 2 % of it here and there.
    """
    cells, speed, amplitude, cfl = 32, 10.0, 1e-7, 0.2
    k = np.pi if name not in PERIODIC else 2 * np.pi
    cells = round(cells * k / np.pi)
    rows = block(1, [0.0], [1.0], [2 * cells])
    x = rows[:, 2].copy()
    shape = np.sin(k * x)
    rows[:, 3] = amplitude * k * speed * shape
    body = Body("bar", rows, modulus=1e5, poisson=0.0, more='boundary-class = "CartesianBox"')
    period = 2 * np.pi / (k * speed)
    scene = Scene(
        1,
        lengths=[],
        cells=[],
        grid=grid(name, 1, cells).replace(", 0}", ", 1}"),
        bodies=[body],
        gravity=[0.0],
        cpdi=0,
        dt=cfl / cells / speed,
        t_stop=period,
        rate=40 / period,
    )
    run_scene(mpm3d, scene, tmp_path)
    frames = read_series(tmp_path / "frames", "fpd", 0, "bar")
    time = np.array([frame.time for frame in frames])
    q = np.array([shape @ frame.fields["displacement"][:, 0] for frame in frames]) / (
        amplitude * (shape @ shape)
    )
    # The crossing at half a period, between frames by the slope of the sine.
    i = np.flatnonzero((q[1:-1] > 0) & (q[2:] <= 0))[0] + 1
    crossing = time[i] + (time[i + 1] - time[i]) * q[i] / (q[i] - q[i + 1])
    ratio = period / (2 * crossing)
    kh = k / cells
    expected = (kappa - cfl**2 / 24) * kh**2
    assert abs((1 - ratio) / expected - 1) <= 0.05
