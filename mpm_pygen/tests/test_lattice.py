"""Filling shapes: counts, positions, masses, refused spacings."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mpm_pygen import (
    Block,
    Circle,
    Cylinder,
    HalfCircle,
    PygenError,
    SimulationType,
    Sphere,
    fill,
    lattice,
)

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize(
    ("sim_type", "lower", "upper", "count"),
    [
        (1, (0.1,), (0.4,), 12),
        (2, (0.1, 0.1), (0.4, 0.3), 12 * 8),
        (3, (0.0, 0.1, 0.2), (0.1, 0.3, 0.5), 4 * 8 * 12),
        (4, (0.0, 0.1), (0.2, 0.4), 8 * 12),
        (5, (0.1, 0.1), (0.4, 0.3), 12 * 8),
    ],
)
def test_block_has_all_its_points_and_its_exact_mass(sim_type, lower, upper, count) -> None:  # type: ignore[no-untyped-def]
    """The mass in the file is density times measure, in TYPE 4 that of the section."""
    block = Block(lower, upper)
    points = fill(block, SimulationType(sim_type), spacing=0.025, density=1200.0)
    assert len(points) == count
    assert points.active.all()
    assert not points.velocity.any()
    # Each cell carries a few roundings of its sides, each side of the block one of its corners,
    # which a side three times shorter than its upper corner shows three times enlarged.
    mass = math.fsum(points.mass.tolist())
    assert mass == pytest.approx(1200.0 * block.measure, rel=20 * EPS, abs=0)
    volume = math.fsum(points.volume.tolist())
    assert volume == pytest.approx(block.measure, rel=20 * EPS, abs=0)


def test_block_points_are_cell_centres_with_the_last_direction_fastest() -> None:
    """Centre (index + 1/2) spacing from the lower corner."""
    position, cell = lattice(Block((1.0, 2.0), (2.0, 3.0)), [0.5, 0.25])
    assert cell == 0.125
    assert position[:4].tolist() == [[1.25, 2.125], [1.25, 2.375], [1.25, 2.625], [1.25, 2.875]]
    assert position[4:, 0].tolist() == [1.75] * 4


@pytest.mark.parametrize("spacing", [0.025, 0.03, 0.0123])
def test_circle_area_differs_by_less_than_the_cells_on_its_rim(spacing: float) -> None:
    """Count times cell lies between the areas of circles half a diagonal smaller and larger.

    A cell whose centre is inside lies in the larger circle, and a cell that meets the smaller one
    has its centre inside.
    """
    radius, half_diagonal = 0.2, spacing / math.sqrt(2.0)
    points = fill(
        Circle((0.2, 0.3), radius), SimulationType.PLANE_STRAIN, spacing=spacing, density=7.0
    )
    least = 7.0 * math.pi * (radius - half_diagonal) ** 2
    most = 7.0 * math.pi * (radius + half_diagonal) ** 2
    assert least < points.total_mass < most


def test_sphere_and_cylinder_volumes_differ_by_less_than_the_cells_on_the_surface() -> None:
    """As for the circle; the length of a cylinder is met exactly."""
    h, radius, length = 0.05, 0.4, 0.6
    sphere = fill(Sphere((0.0, 0.0, 0.0), radius), SimulationType.THREE_D, spacing=h, density=1.0)
    half = 0.5 * h * math.sqrt(3.0)
    ball = 4.0 / 3.0 * math.pi
    assert ball * (radius - half) ** 3 < sphere.total_volume < ball * (radius + half) ** 3
    half = 0.5 * h * math.sqrt(2.0)
    for axis in range(3):
        cylinder = fill(
            Cylinder((0.5, 0.5, 0.5), radius, length, axis),
            SimulationType.THREE_D,
            spacing=h,
            density=1.0,
        )
        area = cylinder.total_volume / length
        assert math.pi * (radius - half) ** 2 < area < math.pi * (radius + half) ** 2
        assert np.ptp(cylinder.position[:, axis]) == pytest.approx(length - h, rel=8 * EPS)


def test_round_lattices_are_symmetric_about_the_centre() -> None:
    """Mirrored positions are the positions again."""
    for shape in (Circle((0.5, 0.25), 0.25), Sphere((0.5, 0.25, 0.0), 0.25)):
        # The spacing is a power of two, so that all sums and differences are exact.
        position, _ = lattice(shape, 0.03125)
        mirrored = 2.0 * shape.origin - position
        assert {tuple(x) for x in mirrored.tolist()} == {tuple(x) for x in position.tolist()}


def test_axisymmetric_mass_is_that_of_the_solid_of_revolution_per_radian() -> None:
    """Midpoint sums of r are exact for a block; a sphere has 2/3 rho R^3 to the rim's cells."""
    sim_type = SimulationType.AXISYMMETRIC
    cylinder = fill(Block((0.0, 0.1), (0.2, 0.6)), sim_type, spacing=0.025, density=900.0)
    exact = 900.0 * 0.5 * 0.2**2 * 0.5
    assert cylinder.total_mass == pytest.approx(exact, rel=40 * EPS, abs=0)
    radius, h = 0.2, 0.0125
    ball = fill(HalfCircle((0.0, 0.3), radius), sim_type, spacing=h, density=900.0)
    assert (ball.position[:, 0] > 0.0).all()
    # The midpoint sum of r over a cell is exact, so the bound of the circle holds with the volumes
    # of spheres half a diagonal smaller and larger.
    half = h / math.sqrt(2.0)
    least, most = (900.0 * 2.0 / 3.0 * (radius + s * half) ** 3 for s in (-1, 1))
    assert least < ball.total_mass < most


@pytest.mark.parametrize("sim_type", list(SimulationType))
def test_velocity_is_given_to_every_point(sim_type: SimulationType) -> None:
    """As many components as the TYPE has; any other number is refused."""
    block = Block((0.0,) * sim_type.dimension, (1.0,) * sim_type.dimension)
    velocity = [1.5, -2.0, 0.25][: sim_type.components]
    points = fill(block, sim_type, spacing=0.5, density=1.0, velocity=velocity)
    assert points.velocity.tolist() == [velocity] * len(points)
    with pytest.raises(PygenError, match="components"):
        fill(block, sim_type, spacing=0.5, density=1.0, velocity=[*velocity, 0.0])


def test_a_spacing_with_few_digits_fits_and_is_adjusted() -> None:
    """0.3333333 makes three cells of a unit side, whose lengths sum to the side."""
    position, cell = lattice(Block((0.0,), (1.0,)), 0.3333333)
    assert len(position) == 3
    assert 3.0 * cell == 1.0


@pytest.mark.parametrize(
    ("side", "spacing", "nearest"),
    [(0.3, 0.04, "0.0375"), (0.3, 0.07, "0.075"), (0.3, 0.5, "0.3"), (1.0, 0.6, "0.5")],
)
def test_a_misfit_names_the_nearest_spacing(side: float, spacing: float, nearest: str) -> None:
    """The named spacing is taken when tried."""
    block = Block((0.0,), (side,))
    with pytest.raises(PygenError, match=f"nearest spacing that fits is {nearest}$"):
        lattice(block, spacing)
    lattice(block, float(nearest))


def test_a_cylinder_has_to_fit_along_its_axis_only() -> None:
    """The radius may be any."""
    lattice(Cylinder((0.0, 0.0, 0.0), 0.123, 0.5, 1), 0.05)
    with pytest.raises(PygenError, match="direction 2"):
        lattice(Cylinder((0.0, 0.0, 0.0), 0.123, 0.52, 1), 0.05)


@pytest.mark.parametrize(
    ("spacing", "words"),
    [
        (0.0, "above 0"),
        (-0.1, "above 0"),
        (math.nan, "above 0"),
        (math.inf, "above 0"),
        ([0.1, 0.1, 0.1], "one for each direction"),
        ([], "one for each direction"),
        (1e-6, "more than"),
        (5e-324, "too small"),
    ],
)
def test_impossible_spacings_are_refused(spacing, words: str) -> None:  # type: ignore[no-untyped-def]
    """Each says what is wrong."""
    with pytest.raises(PygenError, match=words):
        lattice(Block((0.0, 0.0), (1.0, 1.0)), spacing)


def test_other_impossible_fills_are_refused() -> None:
    """Too wide a lattice, wrong density, dimension and radius."""
    plane, axisymmetric = SimulationType.PLANE_STRAIN, SimulationType.AXISYMMETRIC
    with pytest.raises(PygenError, match="too wide"):
        fill(Circle((0.0, 0.0), 0.1), plane, spacing=1.0, density=1.0)
    with pytest.raises(PygenError, match="density"):
        fill(Circle((0.0, 0.0), 0.1), plane, spacing=0.1, density=0.0)
    with pytest.raises(PygenError, match="2 grid directions, the shape 3"):
        fill(Sphere((0.0, 0.0, 0.0), 0.1), plane, spacing=0.1, density=1.0)
    with pytest.raises(PygenError, match="r >= 0"):
        fill(Circle((0.05, 0.0), 0.1), axisymmetric, spacing=0.01, density=1.0)
