"""Polygons: what is inside, areas, body-fitted cells, profiles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mpm_pygen import Polygon, PygenError, fill, lattice, naca, slope, wedge

EPS = float(np.finfo(float).eps)
#: An L with a notch, clockwise, and a square hole.
ANGLE = ((0, 0), (0, 2), (1, 2), (1, 1), (2, 1), (2, 0))
HOLE = ((0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75))


def test_area_and_content_of_a_polygon_with_a_hole() -> None:
    """Shoelace area; a lattice with its cells along the edges has exactly that area."""
    shape = Polygon(ANGLE, (HOLE,))
    assert shape.measure == 2.75
    position, cell = lattice(shape, 0.125)
    assert len(position) * cell == 2.75
    x, y = position.T
    assert not np.any((x > 1) & (y > 1))
    assert not np.any((abs(x - 0.5) < 0.25) & (abs(y - 0.5) < 0.25))


def test_positions_on_edges_and_corners_are_inside() -> None:
    """On both sides, slanted edges included; a little further they are outside."""
    triangle = Polygon(((0, 0), (3, 0), (0, 1)))
    on_edge = np.array([[0, 0], [1.5, 0], [3, 0], [0, 0.5], [0, 1], [1.5, 0.5], [0.3, 0.9]])
    assert triangle.contains(on_edge).all()
    # A ray that passes through a corner counts it once.
    diamond = Polygon(((0, -1), (1, 0), (0, 1), (-1, 0)))
    assert diamond.contains(np.array([[-0.5, 0.0], [0.5, 0.0]])).all()
    assert not diamond.contains(np.array([[-1.001, 0.0], [1.001, 0.0], [-2.0, 1.0]])).any()


def test_area_differs_by_less_than_the_cells_on_the_edges() -> None:
    """A cell in doubt is within half a diagonal of an edge: a band around the outline."""
    corners = ((0.1, 0.0), (1.0, 0.3), (0.7, 1.1), (0.0, 0.8))
    shape = Polygon(corners)
    h = 0.02
    points = fill(shape, 2, spacing=h, density=1.0)
    sides = np.roll(corners, -1, axis=0) - np.array(corners)
    outline = float(np.sum(np.hypot(*sides.T)))
    half = h / math.sqrt(2.0)
    assert abs(points.total_volume - shape.measure) < outline * half + math.pi * half**2
    assert points.total_volume != shape.measure


def test_quadrilateral_cells_have_its_area_and_first_moment() -> None:
    """Cells fill it without a gap: area and first moment are those of its two triangles."""
    corners = np.array([[0.1, 0.0], [1.0, 0.3], [0.7, 1.1], [0.0, 0.8]])
    shape = Polygon(corners.tolist())
    points = fill(shape, 2, spacing=0.05, density=1.0, fitted=True)
    assert points.total_volume == pytest.approx(shape.measure, rel=len(points) * EPS)
    moment = np.zeros(2)
    for b, c in ((1, 2), (2, 3)):
        u, v = corners[b] - corners[0], corners[c] - corners[0]
        moment += 0.5 * (u[0] * v[1] - u[1] * v[0]) * (corners[0] + corners[b] + corners[c]) / 3.0
    assert np.allclose(points.volume @ points.position, moment, rtol=len(points) * EPS, atol=0)
    assert shape.contains(points.position).all()
    # Clockwise corners make the same cells.
    again = fill(Polygon(corners[::-1].tolist()), 2, spacing=0.05, density=1.0, fitted=True)
    assert math.isclose(again.total_volume, points.total_volume, rel_tol=len(points) * EPS)
    # A spacing of 0.05 makes cells of about that area.
    assert shape.measure / len(points) == pytest.approx(0.05**2, rel=0.1)


def test_triangle_and_slope() -> None:
    """Areas of a wedge and of an embankment with and without a toe."""
    tip = wedge((1.0, 2.0), 3.0, 30.0)
    assert tip.measure == pytest.approx(0.5 * 9.0 * math.tan(math.pi / 6.0), rel=16 * EPS)
    assert tip.contains(np.array([[3.9, 3.6], [1.5, 2.1]])).all()
    assert not tip.contains(np.array([[1.1, 2.1]])).any()
    points = fill(tip, 2, spacing=0.1, density=1.0, fitted=True)
    assert points.total_volume == pytest.approx(tip.measure, rel=len(points) * EPS)
    bank = slope((0.0, 0.0), crest=2.0, height=1.0, degrees=45.0)
    assert bank.measure == pytest.approx(2.0 + 0.5, rel=16 * EPS)
    deep = slope((0.0, 0.0), crest=2.0, height=1.0, degrees=45.0, toe=0.5)
    assert deep.measure == pytest.approx(2.5 + 0.5 * 4.0, rel=16 * EPS)
    for degrees in (0.0, 90.0, math.nan):
        with pytest.raises(PygenError, match="angle"):
            wedge((0, 0), 1.0, degrees)


def test_profile_has_the_area_and_the_line_of_its_formula() -> None:
    """Symmetric: the integral of the thickness; cambered: the mean of both sides is the line."""
    # 2 5 t times the integral of the polynomial with the closed trailing edge.
    formula = 0.2969 * 2 / 3 - 0.126 / 2 - 0.3516 / 3 + 0.2843 / 4 - 0.1036 / 5
    profile = naca("0012", 2.0, stations=400)
    # Trapezia over n cosine stations leave out an area of the order of 1/n^2.
    assert profile.measure == pytest.approx(4.0 * 10 * 0.12 * formula, rel=2e-5)
    x = np.array([[0.6, 0.119], [0.6, -0.119], [0.6, 0.121], [0.6, -0.121], [-0.01, 0.0]])
    # At 30 % of the chord the thickness is nearly the nominal 12 %.
    assert profile.contains(x).tolist() == [True, True, False, False, False]
    cambered = naca("4412", 1.0)
    assert cambered.contains(np.array([[0.4, 0.04]])).all()
    top = 0.04 + 0.5 * 0.12
    assert cambered.bounds[1][1] == pytest.approx(top, abs=0.005)
    turned = naca("0012", 1.0, nose=(1.0, 1.0), degrees=90.0)
    lower, upper = turned.bounds
    assert (lower[1], upper[1]) == pytest.approx((0.0, 1.0), abs=4 * EPS)
    for digits in ("001", "00x2", "0000", "0412"):
        with pytest.raises(PygenError, match="digits"):
            naca(digits, 1.0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Polygon(((0, 0), (1, 1))), "three corners"),
        (lambda: Polygon(((0, 0), (1, 1), (2, 2))), "area above 0"),
        (lambda: Polygon(((0, 0), (1, 0), (math.nan, 1))), "not a number"),
        (lambda: Polygon(ANGLE).fitted([0.1, 0.1]), "3 or 4 corners"),
        (lambda: Polygon(((0, 0), (2, 0), (0.5, 0.5), (0, 2))).fitted([0.1, 0.1]), "points in"),
    ],
)
def test_impossible_polygons_are_refused(make, words: str) -> None:  # type: ignore[no-untyped-def]
    """Each says what is wrong."""
    with pytest.raises(PygenError, match=words):
        make()
