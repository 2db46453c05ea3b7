"""Solids swept from plane shapes, and things put together from simple shapes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.rings import layers
from mpm_pygen.shape import (
    BoolArray,
    FloatArray,
    Shape,
    Union,
    check_finite,
    check_positive,
)
from mpm_pygen.shapes import Block, Circle, Cylinder, Ring
from mpm_pygen.simulation_type import SimulationType


@dataclass(frozen=True)
class Extrusion(Shape):
    """A plane shape swept along an axis of 3D.

    Parameters
    ----------
    section : Shape
        In 2D. Its coordinates are the two directions across the axis in cyclic order: x y for the
        axis z, y z for x, z x for y.
    start, length : float
        Coordinate along the axis at which the solid starts, and its length.
    axis : int
        0, 1 or 2 for x, y or z.
    """

    section: Shape
    start: float
    length: float
    axis: int = 2

    def __post_init__(self) -> None:
        """Check the section and the numbers."""
        _check_section("extrusion", self.section, self.axis)
        check_finite("start of an extrusion", [self.start])
        check_positive("the length of an extrusion", self.length)

    @property
    def _across(self) -> list[int]:
        """The directions of the section."""
        return [(self.axis + 1) % 3, (self.axis + 2) % 3]

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around the solid."""
        lower, upper = np.full(3, self.start), np.full(3, self.start + self.length)
        lower[self._across], upper[self._across] = self.section.bounds
        return lower, upper

    @property
    def measure(self) -> float:
        """Area of the section times length."""
        return self.section.measure * self.length

    @property
    def origin(self) -> FloatArray:
        """Origin of the section, at the start."""
        origin = np.full(3, self.start)
        origin[self._across] = self.section.origin
        return origin

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """The axis, and the flat directions of the section."""
        flat = [self._across[k] for k in self.section.flat_directions]
        return tuple(sorted([self.axis, *flat]))

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        along = x[:, self.axis]
        inside = (along >= self.start) & (along <= self.start + self.length)
        return inside & self.section.contains(x[:, self._across])

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Stack the cells of the section."""
        cells = self.section.fitted([spacing[k] for k in self._across])
        position, size = layers(*cells, self.length, spacing[self.axis], self.axis)
        position[:, self.axis] += self.start
        return position, size


@dataclass(frozen=True)
class Revolution(Shape):
    """A plane shape turned about an axis of 3D.

    Parameters
    ----------
    section : Shape
        In 2D, with the coordinates distance from the axis (0 and above) and height along it.
    centre : Sequence[float]
        Position of distance 0 and height 0.
    axis : int
        0, 1 or 2 for x, y or z.
    """

    section: Shape
    centre: Sequence[float] = (0.0, 0.0, 0.0)
    axis: int = 2

    def __post_init__(self) -> None:
        """Check section and centre."""
        _check_section("solid of revolution", self.section, self.axis)
        if len(self.centre) != 3:
            raise PygenError(f"the centre of a solid has 3 coordinates, not {len(self.centre)}")
        check_finite("centre of a solid", self.centre)
        if self.section.bounds[0][0] < 0.0:
            raise PygenError("the section of a solid of revolution has distances from 0 on")

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around the solid."""
        (_, low), (radius, high) = self.section.bounds
        lower, upper = np.full(3, -radius), np.full(3, radius)
        lower[self.axis], upper[self.axis] = low, high
        return lower + self.centre, upper + self.centre

    @property
    def measure(self) -> float:
        """Not known."""
        raise PygenError("the measure of a solid of revolution is not known")

    @property
    def origin(self) -> FloatArray:
        """The axis, at the origin of the section."""
        origin = np.array(self.centre, dtype=float)
        origin[self.axis] += self.section.origin[1]
        return origin

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        offset = x - np.array(self.centre, dtype=float)
        across = [k for k in range(3) if k != self.axis]
        distance = np.sqrt(np.sum(offset[:, across] ** 2, axis=1))
        return self.section.contains(np.column_stack([distance, offset[:, self.axis]]))


def rotated_block(
    centre: Sequence[float], sides: Sequence[float], degrees: float, *, axis: int = 2
) -> Shape:
    """Make a rectangle or box that is turned about its centre.

    Parameters
    ----------
    centre, sides : Sequence[float]
        Middle and lengths, two or three numbers.
    degrees : float
        Angle, counter-clockwise.
    axis : int
        In 3D the direction of the axis of the rotation.
    """
    if len(sides) != len(centre):
        raise PygenError(f"a block has as many sides as its centre numbers, not {len(sides)}")
    lower = [c - 0.5 * s for c, s in zip(centre, sides, strict=True)]
    upper = [c + 0.5 * s for c, s in zip(centre, sides, strict=True)]
    return Block(lower, upper).rotated(degrees, centre=centre, axis=axis)


def column(
    sim_type: SimulationType | int, foot: Sequence[float], width: float, height: float
) -> Shape:
    """Make a column that stands on its foot: the shape of a column collapse.

    Parameters
    ----------
    sim_type : SimulationType
        Kind of simulation, which tells what is up: x, y, z, z, y in TYPE 1 to 5.
    foot : Sequence[float]
        Middle of the foot; in TYPE 4 r is 0.
    width, height : float
        Width in 2D, diameter in TYPE 3 and 4; height. TYPE 1 has no width.

    Returns
    -------
    Shape
        An interval, rectangle or cylinder.
    """
    sim_type = SimulationType(sim_type)
    if len(foot) != sim_type.dimension:
        raise PygenError(f"the foot of a column has {sim_type.dimension} numbers, not {len(foot)}")
    check_positive("the width of a column", width)
    check_positive("the height of a column", height)
    up = foot[-1]
    if sim_type is SimulationType.UNIAXIAL_STRAIN:
        return Block((up,), (up + height,))
    if sim_type is SimulationType.THREE_D:
        return Cylinder((foot[0], foot[1], up + 0.5 * height), 0.5 * width, height)
    if sim_type is SimulationType.AXISYMMETRIC:
        if foot[0] != 0.0:
            raise PygenError(f"the foot of a column has r = 0 in TYPE 4, not {foot[0]!r}")
        return Block((0.0, up), (0.5 * width, up + height))
    return Block((foot[0] - 0.5 * width, up), (foot[0] + 0.5 * width, up + height))


def wheel(
    centre: Sequence[float],
    radius: float,
    *,
    rim: float,
    hub: float,
    spokes: int,
    spoke_width: float,
) -> Shape:
    """Make a spoked wheel in a plane; `Extrusion` makes it a solid.

    Parameters
    ----------
    centre : Sequence[float]
        Two coordinates.
    radius, rim, hub : float
        Outer radius, thickness of the rim, radius of the hub.
    spokes : int
        Number of spokes, the first of which points along the first direction.
    spoke_width : float
        Width of a spoke.
    """
    for name, value in (("rim", rim), ("hub", hub), ("spoke", spoke_width)):
        check_positive(f"the size of the {name} of a wheel", value)
    if not hub < radius - rim:
        raise PygenError("the hub of a wheel ends inside its rim")
    if spokes < 1:
        raise PygenError(f"a wheel has at least one spoke, not {spokes}")
    inner = radius - rim
    half = 0.5 * spoke_width
    # A spoke starts in the middle of the hub and ends inside the rim; half of its width may not
    # reach over the hub.
    if not half < hub:
        raise PygenError("a spoke of a wheel is narrower than its hub")
    x, y = centre
    end = math.sqrt(radius**2 - half**2) if half < radius else inner
    bar = Block((x, y - half), (x + min(end, inner + 0.5 * rim), y + half))
    turned = [bar.rotated(360.0 * k / spokes, centre=centre) for k in range(spokes)]
    return Union((Ring(centre, inner, radius), Circle(centre, hub), *turned))


def _check_section(name: str, section: Shape, axis: int) -> None:
    """Check what all swept solids have."""
    if section.dimension != 2:
        raise PygenError(
            f"the section of an {name} is plane, not of {section.dimension} directions"
        )
    if axis not in (0, 1, 2):
        raise PygenError(f"the axis of an {name} is 0, 1 or 2, not {axis!r}")
