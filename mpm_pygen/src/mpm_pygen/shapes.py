"""Shapes that can be filled with points.

A shape says which positions are inside, in which box it lies and how the lattice of points is to
be placed. A new shape, or a boolean combination of shapes, is one more subclass of `Shape`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mpm_pygen.errors import PygenError

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]


class Shape(ABC):
    """A region of 1D, 2D or 3D space."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner of the smallest box around the shape, each `(dimension,)`."""

    @property
    @abstractmethod
    def measure(self) -> float:
        """Exact length, area or volume."""

    @property
    @abstractmethod
    def origin(self) -> FloatArray:
        """A position at which cells of the lattice meet, `(dimension,)`."""

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """Directions closed by two planes, on which cells of the lattice have to end."""
        return ()

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return len(self.bounds[0])

    @abstractmethod
    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside or on the surface.

        Parameters
        ----------
        x : FloatArray
            Positions, `(n, dimension)`.

        Returns
        -------
        BoolArray
            One value a position, `(n,)`.
        """


@dataclass(frozen=True)
class Block(Shape):
    """An interval, rectangle or box with sides along the axes.

    Parameters
    ----------
    lower, upper : Sequence[float]
        Opposite corners, as many numbers as the space has directions.
    """

    lower: Sequence[float]
    upper: Sequence[float]

    def __post_init__(self) -> None:
        """Check the corners."""
        _check_finite("corner of a block", [*self.lower, *self.upper])
        if len(self.lower) != len(self.upper) or not 1 <= len(self.lower) <= 3:
            raise PygenError(
                "the corners of a block need the same number of coordinates, 1 to 3, not "
                f"{len(self.lower)} and {len(self.upper)}"
            )
        for low, high in zip(self.lower, self.upper, strict=True):
            if not low < high:
                raise PygenError(
                    f"the lower corner of a block is below the upper one, not {low!r} and {high!r}"
                )

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The two corners."""
        return np.array(self.lower, dtype=float), np.array(self.upper, dtype=float)

    @property
    def measure(self) -> float:
        """Product of the sides."""
        lower, upper = self.bounds
        return float(np.prod(upper - lower))

    @property
    def origin(self) -> FloatArray:
        """The lower corner."""
        return self.bounds[0]

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """All directions."""
        return tuple(range(len(self.lower)))

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        lower, upper = self.bounds
        return np.asarray(np.all((x >= lower) & (x <= upper), axis=1))


@dataclass(frozen=True)
class Circle(Shape):
    """A disc in a plane.

    Parameters
    ----------
    centre : Sequence[float]
        Two coordinates.
    radius : float
        Above 0.
    """

    centre: Sequence[float]
    radius: float

    def __post_init__(self) -> None:
        """Check centre and radius."""
        _check_round("circle", self.centre, 2, self.radius)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The square around the circle."""
        return self.origin - self.radius, self.origin + self.radius

    @property
    def measure(self) -> float:
        """Area."""
        return math.pi * self.radius**2

    @property
    def origin(self) -> FloatArray:
        """The centre, about which the lattice is then symmetric."""
        return np.array(self.centre, dtype=float)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        return _within(x, self.origin, self.radius)


@dataclass(frozen=True)
class HalfCircle(Shape):
    """The half of a disc on the upper side of its centre in the first direction.

    With a centre at r = 0 this is the meridian section of a sphere on the axis.

    Parameters
    ----------
    centre : Sequence[float]
        Two coordinates.
    radius : float
        Above 0.
    """

    centre: Sequence[float]
    radius: float

    def __post_init__(self) -> None:
        """Check centre and radius."""
        _check_round("half circle", self.centre, 2, self.radius)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The rectangle around the half circle."""
        lower = np.array([self.centre[0], self.centre[1] - self.radius], dtype=float)
        return lower, self.origin + self.radius

    @property
    def measure(self) -> float:
        """Area."""
        return 0.5 * math.pi * self.radius**2

    @property
    def origin(self) -> FloatArray:
        """The centre."""
        return np.array(self.centre, dtype=float)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        return _within(x, self.origin, self.radius) & (x[:, 0] >= self.centre[0])


@dataclass(frozen=True)
class Cylinder(Shape):
    """A circular cylinder in 3D along one of the axes.

    Parameters
    ----------
    centre : Sequence[float]
        Middle of the cylinder, three coordinates.
    radius, length : float
        Above 0.
    axis : int
        0, 1 or 2 for x, y or z.
    """

    centre: Sequence[float]
    radius: float
    length: float
    axis: int = 2

    def __post_init__(self) -> None:
        """Check centre, radius, length and axis."""
        _check_round("cylinder", self.centre, 3, self.radius)
        _check_positive("the length of a cylinder", self.length)
        if self.axis not in (0, 1, 2):
            raise PygenError(f"the axis of a cylinder is 0, 1 or 2, not {self.axis!r}")

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around the cylinder."""
        half = np.full(3, self.radius)
        half[self.axis] = 0.5 * self.length
        centre = np.array(self.centre, dtype=float)
        return centre - half, centre + half

    @property
    def measure(self) -> float:
        """Volume."""
        return math.pi * self.radius**2 * self.length

    @property
    def origin(self) -> FloatArray:
        """Centre of the lower end face."""
        origin = np.array(self.centre, dtype=float)
        origin[self.axis] = self.bounds[0][self.axis]
        return origin

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """The axis."""
        return (self.axis,)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        across = [k for k in range(3) if k != self.axis]
        lower, upper = self.bounds
        along = x[:, self.axis]
        inside = _within(x[:, across], self.origin[across], self.radius)
        inside &= (along >= lower[self.axis]) & (along <= upper[self.axis])
        return inside


@dataclass(frozen=True)
class Sphere(Shape):
    """A ball in 3D.

    Parameters
    ----------
    centre : Sequence[float]
        Three coordinates.
    radius : float
        Above 0.
    """

    centre: Sequence[float]
    radius: float

    def __post_init__(self) -> None:
        """Check centre and radius."""
        _check_round("sphere", self.centre, 3, self.radius)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The cube around the sphere."""
        return self.origin - self.radius, self.origin + self.radius

    @property
    def measure(self) -> float:
        """Volume."""
        return 4.0 / 3.0 * math.pi * self.radius**3

    @property
    def origin(self) -> FloatArray:
        """The centre, about which the lattice is then symmetric."""
        return np.array(self.centre, dtype=float)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        return _within(x, self.origin, self.radius)


def _within(x: FloatArray, centre: FloatArray, radius: float) -> BoolArray:
    """Tell which positions are no further than `radius` from `centre`."""
    return np.asarray(np.sum((x - centre) ** 2, axis=1) <= radius**2)


def _check_round(name: str, centre: Sequence[float], dimension: int, radius: float) -> None:
    """Check what all round shapes have."""
    if len(centre) != dimension:
        raise PygenError(f"the centre of a {name} has {dimension} coordinates, not {len(centre)}")
    _check_finite(f"centre of a {name}", centre)
    _check_positive(f"the radius of a {name}", radius)


def _check_finite(name: str, values: Sequence[float]) -> None:
    """Refuse infinities and NaN."""
    for value in values:
        if not math.isfinite(value):
            raise PygenError(f"a coordinate of the {name} is {value!r}, which is not a number")


def _check_positive(name: str, value: float) -> None:
    """Refuse what is not a finite number above 0."""
    if not (math.isfinite(value) and value > 0.0):
        raise PygenError(f"{name} is a number above 0, not {value!r}")
