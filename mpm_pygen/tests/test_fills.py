"""Body-fitted and jittered fills, points per cell, fields of position, mixtures."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mpm_pygen import (
    Block,
    Circle,
    Cylinder,
    HalfCircle,
    Pipe,
    PygenError,
    Ring,
    Shape,
    Sphere,
    fill,
    mixture,
)

EPS = float(np.finfo(float).eps)
SQUARE = Block((0.0, 0.0), (1.0, 1.0))
ROUND = [
    Circle((0.5, 0.25), 0.4),
    HalfCircle((0.5, 0.25), 0.4),
    Ring((0.5, 0.25), 0.2, 0.4),
    Cylinder((0.5, 0.25, 0.0), 0.4, 0.5, axis=1),
    Pipe((0.5, 0.25, 0.0), 0.2, 0.4, 0.5, axis=0),
    Sphere((0.5, 0.25, 0.0), 0.4),
]


@pytest.mark.parametrize("shape", ROUND, ids=lambda shape: type(shape).__name__)
def test_fitted_cells_fill_round_shapes(shape: Shape) -> None:
    """Sizes sum to the measure, points are inside, first moments are those of the shape."""
    position, size = shape.fitted([0.05] * shape.dimension)
    assert math.fsum(size.tolist()) == pytest.approx(shape.measure, rel=len(size) * EPS)
    assert shape.contains(position).all()
    middle = np.mean(shape.bounds, axis=0)
    if isinstance(shape, HalfCircle):
        middle[0] = 0.5 + 4.0 * 0.4 / (3.0 * math.pi)
    moment = size @ position
    assert np.allclose(moment, shape.measure * middle, rtol=0.0, atol=len(size) * EPS)
    # Cells are about as wide as asked for.
    cell = 0.05**shape.dimension
    assert 0.4 * cell < size.min() and size.max() < 2.0 * cell


def test_polar_inertia_of_a_fitted_disc() -> None:
    """Points in centroids miss the inertia of their cells about themselves, known in closed form.

    In ring k, between k w and (k + 1) w, a centroid is at 2/3 (r2^3 - r1^3)/(r2^2 - r1^2) times
    sin(a)/a, a half the angle of a sector.
    """
    radius, h = 0.4, 0.05
    points = fill(Circle((0.0, 0.0), radius), 2, spacing=h, density=1.0, fitted=True)
    rings = round(radius / (h * math.sqrt(4.0 / math.pi)))
    assert len(points) == 4 * rings**2
    assert np.ptp(points.volume) <= 4 * EPS * points.volume[0] * rings**2
    expected, w = 0.0, radius / rings
    for k in range(rings):
        r1, r2, a = k * w, (k + 1) * w, math.pi / (4 * (2 * k + 1))
        centroid = 2.0 / 3.0 * (r2**3 - r1**3) / (r2**2 - r1**2) * math.sin(a) / a
        expected += math.pi * (r2**2 - r1**2) * centroid**2
    found = float(points.mass @ np.sum(points.position**2, axis=1))
    assert found == pytest.approx(expected, rel=len(points) * EPS)
    exact = 0.5 * math.pi * radius**4
    assert 0.0 < exact - found < points.total_mass * h**2 / 6.0 * 1.1


def test_fitted_disc_is_symmetric_by_quarter_turns() -> None:
    """Turned by 90 degrees the points are the points again, up to round-off."""
    position, _ = Circle((0.0, 0.0), 1.0).fitted([0.1, 0.1])
    turned = np.column_stack([-position[:, 1], position[:, 0]])
    gap = np.sqrt(((turned[:, None] - position[None]) ** 2).sum(axis=2)).min(axis=1)
    assert gap.max() < 16 * EPS


def test_axisymmetric_fitted_sphere_has_its_exact_volume() -> None:
    """Area times centroid is the exact volume of a cell per radian."""
    radius = 0.3
    points = fill(HalfCircle((0.0, 0.5), radius), 4, spacing=0.02, density=900.0, fitted=True)
    exact = 900.0 * 2.0 / 3.0 * radius**3
    assert points.total_mass == pytest.approx(exact, rel=len(points) * EPS)


def test_points_per_cell_make_a_lattice_of_that_many() -> None:
    """1 to 4 a direction, another number for each direction; aligned with a node of the grid."""
    for n in range(1, 5):
        points = fill(SQUARE, 2, cell=0.25, per_cell=n, density=1.0)
        index = np.floor(points.position / 0.25).astype(int)
        _, counts = np.unique(index, axis=0, return_counts=True)
        assert counts.tolist() == [n * n] * 16
    points = fill(SQUARE, 2, cell=(0.5, 0.25), per_cell=(3, 1), density=1.0)
    assert len(points) == 6 * 4
    disc = fill(Circle((0.51, 0.47), 0.3), 2, spacing=0.125, density=1.0, origin=(0.0, 0.0))
    place = disc.position / 0.125 - 0.5
    assert np.array_equal(place, np.round(place))
    with pytest.raises(PygenError, match="either the spacing"):
        fill(SQUARE, 2, density=1.0)
    with pytest.raises(PygenError, match="points per cell"):
        fill(SQUARE, 2, cell=0.5, per_cell=0, density=1.0)


def test_exact_sizes_sum_to_the_measure() -> None:
    """One factor for all."""
    shape = Circle((0.0, 0.0), 1.0)
    points = fill(shape, 2, spacing=0.13, density=2.0, exact=True)
    assert points.total_mass == pytest.approx(2.0 * math.pi, rel=len(points) * EPS)
    assert np.ptp(points.volume) == 0.0


def test_jitter_is_seeded_stays_in_the_cell_and_in_the_shape() -> None:
    """At most half a spacing times the jitter; the same seed gives the same points."""
    shape = Circle((0.0, 0.0), 1.0)
    still = fill(shape, 2, spacing=0.1, density=1.0)
    first, again, other = (
        fill(shape, 2, spacing=0.1, density=1.0, jitter=0.5, seed=s).position for s in (1, 1, 2)
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    moved = np.abs(first - still.position)
    assert 0.02 < moved.max() <= 0.025
    assert shape.contains(first).all()
    # Uniform in a cell: the variance of a coordinate is (jitter h)^2/12, to five deviations
    # sqrt(4/5 /n) of the mean of n squares; those on the rim stay, which the bound allows for.
    square = np.mean((first - still.position) ** 2)
    share = np.mean(np.any(moved > 0.0, axis=1))
    deviation = 5.0 * math.sqrt(0.8 / moved.size)
    assert square / share == pytest.approx(0.05**2 / 12.0, rel=deviation)
    with pytest.raises(PygenError, match="from 0 to 1"):
        fill(shape, 2, spacing=0.1, density=1.0, jitter=1.5)


def test_density_and_velocity_of_position() -> None:
    """Numbers, expressions and functions agree."""
    by_text = fill(
        SQUARE, 5, spacing=0.25, density="1000 + 50*y", velocity=["-y", "x**2", "sin(pi*x)"]
    )
    by_function = fill(
        SQUARE,
        5,
        spacing=0.25,
        density=lambda x: 1000.0 + 50.0 * x[:, 1],
        velocity=lambda x: np.stack([-x[:, 1], x[:, 0] ** 2, np.sin(np.pi * x[:, 0])], axis=1),
    )
    assert by_text.mass.tolist() == by_function.mass.tolist()
    assert by_text.velocity.tolist() == by_function.velocity.tolist()
    y = by_text.position[:, 1]
    assert by_text.mass.tolist() == ((1000.0 + 50.0 * y) * 0.0625).tolist()
    assert by_text.velocity[:, 0].tolist() == (-y).tolist()
    ring = fill(Block((0.5, 0.0), (1.0, 1.0)), 4, spacing=0.25, density="r*z", velocity=[0, 0, "r"])
    assert ring.velocity[:, 2].tolist() == ring.position[:, 0].tolist()
    with pytest.raises(PygenError, match="above 0, not -"):
        fill(SQUARE, 2, spacing=0.25, density="y - 0.5")
    with pytest.raises(PygenError, match="shape"):
        fill(SQUARE, 2, spacing=0.25, density=lambda x: x)
    with pytest.raises(PygenError, match="not finite"):
        fill(SQUARE, 2, spacing=0.25, density=1.0, velocity=["log(x - 0.5)", 0])


def test_mixture_of_grains_and_fluid() -> None:
    """Two bodies in one place: masses are shares of the substances."""
    points = fill(SQUARE, 2, spacing=0.25, density=1.0, velocity=[1.0, 0.0])
    grains, fluid = mixture(points, porosity="0.3 + 0.1*y", grain_density=2650, fluid_density=1000)
    pores = 0.3 + 0.1 * points.position[:, 1]
    assert grains.mass == pytest.approx((1.0 - pores) * 2650 * 0.0625, rel=4 * EPS)
    assert fluid.mass == pytest.approx(pores * 1000 * 0.0625, rel=4 * EPS)
    for body in (grains, fluid):
        assert np.array_equal(body.position, points.position)
        assert np.array_equal(body.volume, points.volume)
        assert np.array_equal(body.velocity, points.velocity)
    for wrong in (0.0, 1.0, "2*y"):
        with pytest.raises(PygenError, match="porosity"):
            mixture(grains, porosity=wrong, grain_density=1, fluid_density=1)


def test_fits_that_are_refused() -> None:
    """A shape without a fitted fill, and one with an origin."""
    with pytest.raises(PygenError, match="no body-fitted fill"):
        fill(SQUARE - Circle((0, 0), 0.1), 2, spacing=0.1, density=1.0, fitted=True)
    with pytest.raises(PygenError, match="no origin"):
        fill(SQUARE, 2, spacing=0.1, density=1.0, fitted=True, origin=(0, 0))
