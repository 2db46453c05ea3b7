"""Shapes: what is inside, bounds, measures, refused numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mpm_pygen import Block, Circle, Cylinder, HalfCircle, PygenError, Shape, Sphere

SHAPES = [
    Block((0.5,), (2.0,)),
    Block((-1.0, 0.0), (1.0, 0.5)),
    Block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)),
    Circle((0.3, -0.2), 0.7),
    HalfCircle((0.0, 1.0), 0.5),
    Cylinder((0.1, 0.2, 0.3), 0.4, 1.5, axis=0),
    Cylinder((0.1, 0.2, 0.3), 0.4, 1.5, axis=2),
    Sphere((1.0, 2.0, 3.0), 0.5),
]


def _name(shape: Shape) -> str:
    return f"{type(shape).__name__}-{shape.dimension}"


@pytest.mark.parametrize("shape", SHAPES, ids=_name)
def test_nothing_outside_the_bounds_is_inside(shape: Shape) -> None:
    """A position beyond any face of the bounds is outside."""
    lower, upper = shape.bounds
    # From here the shape reaches its bounds in all directions.
    middle = shape.origin
    for k in shape.flat_directions:
        middle[k] = 0.5 * (lower[k] + upper[k])
    for k in range(shape.dimension):
        for face, step in ((lower[k], -1e-6), (upper[k], 1e-6)):
            x = middle.copy()
            x[k] = face + step
            assert not shape.contains(x[None, :]).any()
            x[k] = face - step
            assert shape.contains(x[None, :]).all()


@pytest.mark.parametrize("shape", SHAPES, ids=_name)
def test_measure_agrees_with_a_count_of_random_positions(shape: Shape) -> None:
    """The share of random positions inside tells the measure to five standard deviations."""
    lower, upper = shape.bounds
    n = 40_000
    x = np.random.default_rng(1).uniform(lower, upper, (n, shape.dimension))
    share = np.count_nonzero(shape.contains(x)) / n
    expected = shape.measure / float(np.prod(upper - lower))
    deviation = math.sqrt(expected * max(0.0, 1.0 - expected) / n)
    # A block fills its bounds: then the deviation is 0 and round-off of the measure remains.
    assert abs(share - expected) <= 5.0 * deviation + 8.0 * np.finfo(float).eps


def test_half_circle_is_the_part_with_positive_r() -> None:
    """Positions at negative r are outside although the full circle holds them."""
    x = np.array([[0.1, 1.0], [-0.1, 1.0]])
    assert HalfCircle((0.0, 1.0), 0.5).contains(x).tolist() == [True, False]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Block((0.0, 0.0), (1.0,)), "same number of coordinates"),
        (lambda: Block((0.0,) * 4, (1.0,) * 4), "1 to 3"),
        (lambda: Block((0.0, 1.0), (1.0, 1.0)), "below the upper"),
        (lambda: Block((0.0, math.nan), (1.0, 1.0)), "not a number"),
        (lambda: Circle((0.0, 0.0, 0.0), 1.0), "2 coordinates"),
        (lambda: Circle((0.0, 0.0), 0.0), "above 0"),
        (lambda: HalfCircle((0.0, 0.0), -1.0), "above 0"),
        (lambda: Sphere((0.0, 0.0), 1.0), "3 coordinates"),
        (lambda: Sphere((0.0, 0.0, math.inf), 1.0), "not a number"),
        (lambda: Cylinder((0.0, 0.0, 0.0), 1.0, 0.0), "length"),
        (lambda: Cylinder((0.0, 0.0, 0.0), 1.0, 1.0, axis=3), "axis"),
    ],
)
def test_impossible_shapes_are_refused(make, words: str) -> None:  # type: ignore[no-untyped-def]
    """Each says what is wrong."""
    with pytest.raises(PygenError, match=words):
        make()
