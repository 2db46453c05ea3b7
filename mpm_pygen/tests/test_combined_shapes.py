"""Unions, differences, intersections and moved shapes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mpm_pygen import (
    Block,
    Circle,
    Extrusion,
    PygenError,
    Revolution,
    Ring,
    Shape,
    SimulationType,
    Sphere,
    column,
    fill,
    lattice,
    rotated_block,
    wheel,
)

EPS = float(np.finfo(float).eps)
SQUARE = Block((0.0, 0.0), (1.0, 1.0))
DISC = Circle((1.0, 0.5), 0.3)
#: Some positions in and around the square.
X = np.random.default_rng(3).uniform(-0.5, 1.5, (2000, 2))


def test_combinations_are_those_of_sets() -> None:
    """Union, intersection and difference of what is inside."""
    a, b = SQUARE.contains(X), DISC.contains(X)
    assert ((SQUARE | DISC).contains(X) == (a | b)).all()
    assert ((SQUARE & DISC).contains(X) == (a & b)).all()
    assert ((SQUARE - DISC).contains(X) == (a & ~b)).all()
    assert (a & b).any() and (a & ~b).any() and (b & ~a).any()


def test_bounds_of_combinations() -> None:
    """The box around both, of the first, and the common one."""
    assert [x.tolist() for x in (SQUARE | DISC).bounds] == [[0.0, 0.0], [1.3, 1.0]]
    assert [x.tolist() for x in (SQUARE - DISC).bounds] == [[0.0, 0.0], [1.0, 1.0]]
    assert [x.tolist() for x in (SQUARE & DISC).bounds] == [[0.7, 0.2], [1.0, 0.8]]


def test_a_plate_with_a_hole_keeps_the_lattice_of_the_plate() -> None:
    """Points of the plate that are not in the hole, in the same order; a misfit is refused."""
    plate = SQUARE - Circle((0.5, 0.5), 0.2)
    all_points, _ = lattice(SQUARE, 0.05)
    found, cell = lattice(plate, 0.05)
    hole = np.sum((all_points - 0.5) ** 2, axis=1) <= 0.2**2
    assert found.tolist() == all_points[~hole].tolist()
    # Half a diagonal of a cell is the most that the rim of the hole is missed by.
    half = 0.05 / math.sqrt(2.0)
    taken = 1.0 - len(found) * cell
    assert math.pi * (0.2 - half) ** 2 < taken < math.pi * (0.2 + half) ** 2
    with pytest.raises(PygenError, match="no multiple"):
        lattice(plate, 0.06)


def test_measures_that_are_known_and_those_that_are_not() -> None:
    """Parts whose boxes do not overlap add up; all else is refused."""
    far = SQUARE.translated(1.0, 0.0)
    assert (SQUARE | far).measure == 2.0
    assert (SQUARE - far).measure == 1.0
    for shape in (SQUARE | DISC, SQUARE & DISC, SQUARE - DISC):
        with pytest.raises(PygenError, match="not known"):
            _ = shape.measure
    with pytest.raises(PygenError, match="do not meet"):
        _ = SQUARE & SQUARE.translated(2.0, 0.0)
    with pytest.raises(PygenError, match="2 and 3 dimensions"):
        _ = SQUARE | Sphere((0.0, 0.0, 0.0), 1.0)


@pytest.mark.parametrize(
    ("shape", "back"),
    [
        (DISC.translated(0.5, -0.25), lambda x: x - [0.5, -0.25]),
        (DISC.scaled((2.0, 0.5)), lambda x: x / [2.0, 0.5]),
        (DISC.scaled(2.0, centre=(1.0, 1.0)), lambda x: (x + 1.0) / 2.0),
        (DISC.mirrored(0, 0.25), lambda x: [0.5, 0.0] + x * [-1.0, 1.0]),
        # Turned by 90 degrees counter-clockwise (x, y) comes from (y, -x).
        (DISC.rotated(90.0), lambda x: np.column_stack([x[:, 1], -x[:, 0]])),
    ],
)
def test_a_moved_shape_holds_what_comes_from_the_shape(shape: Shape, back) -> None:  # type: ignore[no-untyped-def]
    """A position is inside when its original is; the measure follows the determinant."""
    x = 2.0 * X
    inside = shape.contains(x)
    assert (inside == DISC.contains(np.asarray(back(x)))).all()
    assert 20 < np.count_nonzero(inside) < 1000
    lower, upper = shape.bounds
    assert np.all(x[inside] >= lower) and np.all(x[inside] <= upper)


def test_rotation_in_space_is_counter_clockwise_about_each_axis() -> None:
    """A point on one axis comes to the next one."""
    for axis in range(3):
        centre = [0.0, 0.0, 0.0]
        centre[(axis + 1) % 3] = 2.0
        turned = Sphere(centre, 0.5).rotated(90.0, axis=axis)
        expected = np.zeros(3)
        expected[(axis + 2) % 3] = 2.0
        assert turned.origin.tolist() == expected.tolist()


def test_shapes_moved_along_the_axes_stay_flat() -> None:
    """Their lattice ends on their faces, so that the mass is exact; turned ones are not."""
    moved = SQUARE.translated(0.013, 0.4).mirrored(0, 2.0).rotated(-90.0)
    assert moved.flat_directions == (0, 1)
    position, cell = lattice(moved, 0.1)
    assert len(position) == 100
    lower, _ = moved.bounds
    assert np.allclose(position.min(axis=0), lower + 0.05, rtol=0.0, atol=8 * EPS)
    assert cell == pytest.approx(0.01, rel=8 * EPS)
    assert SQUARE.rotated(30.0).flat_directions == ()


def test_rotated_block_by_both_fills() -> None:
    """The lattice is the block's to its rim; the fitted one is exact, with the block's inertia."""
    shape = rotated_block((0.5, 0.4), (0.4, 0.2), 30.0)
    h = 0.02
    on_lattice = fill(shape, 2, spacing=h, density=1.0)
    half = h / math.sqrt(2.0)
    assert (0.4 - 2 * half) * (0.2 - 2 * half) < on_lattice.total_volume
    # Cells that meet a block lie in the block grown by a diagonal, round at its corners.
    assert on_lattice.total_volume < 0.08 + 2 * 0.6 * half + math.pi * half**2
    fitted = fill(shape, 2, spacing=h, density=1.0, fitted=True)
    assert len(fitted) == 200
    assert fitted.total_mass == pytest.approx(0.08, rel=200 * EPS)
    offset = fitted.position - [0.5, 0.4]
    assert np.abs(fitted.mass @ offset).max() < 200 * EPS
    along = offset @ [math.cos(math.radians(30.0)), math.sin(math.radians(30.0))]
    # Sum of squares at cell centres: that of the side less h^2 of each cell, over 12.
    second = 0.08 * (0.4**2 - h**2) / 12.0
    assert fitted.mass @ along**2 == pytest.approx(second, rel=400 * EPS)


def test_swept_solids() -> None:
    """A disc and a ring swept along each axis, a disc turned to a torus."""
    rng = np.random.default_rng(5)
    x = rng.uniform(-1.0, 1.0, (5000, 3))
    for axis in range(3):
        solid = Extrusion(Circle((0.1, 0.2), 0.5), -0.5, 0.8, axis)
        across = x[:, [(axis + 1) % 3, (axis + 2) % 3]] - [0.1, 0.2]
        inside = np.sum(across**2, axis=1) <= 0.25
        inside &= np.abs(x[:, axis] + 0.1) <= 0.4
        assert (solid.contains(x) == inside).all()
        cells, sizes = solid.fitted([0.1] * 3)
        assert math.fsum(sizes.tolist()) == pytest.approx(solid.measure, rel=len(sizes) * EPS)
        assert solid.contains(cells).all()
        torus = Revolution(Circle((0.6, 0.1), 0.3), (0.0, 0.1, 0.0), axis)
        centred = x - [0.0, 0.1, 0.0]
        distance = np.hypot(*[centred[:, k] for k in range(3) if k != axis])
        expected = (distance - 0.6) ** 2 + (centred[:, axis] - 0.1) ** 2 <= 0.09
        assert (torus.contains(x) == expected).all()
        assert np.all(x[expected] >= torus.bounds[0]) and np.all(x[expected] <= torus.bounds[1])


def test_wheel_has_rim_hub_and_spokes() -> None:
    """Along a spoke all is filled, between spokes only hub and rim are."""
    shape = wheel((1.0, 2.0), 1.0, rim=0.1, hub=0.2, spokes=4, spoke_width=0.1)
    distance = np.array([0.0, 0.19, 0.5, 0.8, 0.95, 1.01])
    for k in range(8):
        angle = k * math.pi / 4.0
        ray = [1.0, 2.0] + distance[:, None] * [math.cos(angle), math.sin(angle)]
        on_spoke = k % 2 == 0
        assert shape.contains(ray).tolist() == [True, True, on_spoke, on_spoke, True, False]
    # The lattice about the centre has the symmetry of the wheel.
    position, _ = lattice(shape, 0.03125)
    offset = position - [1.0, 2.0]
    points = {tuple(x) for x in offset.tolist()}
    assert {(-y, x) for x, y in points} == points


def test_a_column_stands_on_its_foot_in_each_type() -> None:
    """Total volume: length, area, volume, volume per radian, area; the first layer is half up."""
    volume = {1: 2.0, 2: 1.0, 4: 0.5 * 0.25**2 * 2.0, 5: 1.0}
    for sim_type in SimulationType:
        foot = [0.0] * (sim_type.dimension - 1) + [0.5]
        shape = column(sim_type, foot, 0.5, 2.0)
        points = fill(shape, sim_type, spacing=0.0625, density=1.0)
        up = sim_type.dimension - 1
        assert points.position[:, up].min() == 0.53125
        assert points.position[:, up].max() == 2.5 - 0.03125
        if sim_type in volume:
            assert points.total_volume == pytest.approx(volume[sim_type], rel=100 * EPS)
    with pytest.raises(PygenError, match="r = 0"):
        column(4, (0.1, 0.0), 1.0, 1.0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Ring((0.0, 0.0), 0.5, 0.5), "below the outer"),
        (lambda: SQUARE.translated(1.0), "2 numbers"),
        (lambda: SQUARE.scaled(0.0), "above 0"),
        (lambda: SQUARE.mirrored(2), "0 to 1"),
        (lambda: SQUARE.rotated(1.0, axis=5), "0, 1 or 2"),
        (lambda: Block((0.0,), (1.0,)).rotated(1.0), "one dimension"),
        (lambda: SQUARE.translated(math.nan, 0.0), "not finite"),
        (lambda: Extrusion(Sphere((0.0,) * 3, 1.0), 0.0, 1.0), "plane"),
        (lambda: Revolution(Circle((0.1, 0.0), 0.3)), "from 0 on"),
        (lambda: wheel((0, 0), 1.0, rim=0.5, hub=0.6, spokes=3, spoke_width=0.1), "hub"),
        (lambda: rotated_block((0, 0), (1, 1, 1), 0.0), "as many sides"),
    ],
)
def test_impossible_shapes_are_refused(make, words: str) -> None:  # type: ignore[no-untyped-def]
    """Each says what is wrong."""
    with pytest.raises(PygenError, match=words):
        make()
