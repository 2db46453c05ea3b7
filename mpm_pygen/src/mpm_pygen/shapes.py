"""Simple shapes that can be filled with points.

A shape says which positions are inside, in which box it lies and how the lattice of points is to
be placed. A new shape is one more subclass of `Shape`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.rings import annulus, ball, layers
from mpm_pygen.shape import (
    BoolArray,
    FloatArray,
    Shape,
    check_finite,
    check_positive,
    check_round,
)


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
        check_finite("corner of a block", [*self.lower, *self.upper])
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

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide into equal boxes, a whole number of them along each side."""
        lower, upper = self.bounds
        sides = upper - lower
        counts = [max(1, round(side / h)) for side, h in zip(sides, spacing, strict=True)]
        axes = [
            low + (np.arange(n) + 0.5) * side / n
            for low, side, n in zip(lower, sides, counts, strict=True)
        ]
        position = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
        return position, np.full(len(position), np.prod(sides / counts))


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
        check_round("circle", self.centre, 2, self.radius)

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

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide into sectors of rings, all of one area."""
        position, size = annulus(0.0, self.radius, _mean(spacing))
        return position + self.origin, size


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
        check_round("half circle", self.centre, 2, self.radius)

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

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide into sectors of half rings, all of one area."""
        position, size = annulus(0.0, self.radius, _mean(spacing), half=True)
        return position + self.origin, size


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
        check_round("cylinder", self.centre, 3, self.radius)
        check_positive("the length of a cylinder", self.length)
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

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide into layers of rings, all cells of one volume."""
        across = _mean([spacing[(self.axis + 1) % 3], spacing[(self.axis + 2) % 3]])
        section = annulus(0.0, self.radius, across)
        position, size = layers(*section, self.length, spacing[self.axis], self.axis)
        return position + self.origin, size


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
        check_round("sphere", self.centre, 3, self.radius)

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

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide into shells, bands of latitude and sectors."""
        position, size = ball(self.radius, _mean(spacing))
        return position + self.origin, size


@dataclass(frozen=True)
class Ring(Shape):
    """The region between two circles about one centre.

    Parameters
    ----------
    centre : Sequence[float]
        Two coordinates.
    inner, outer : float
        Radii, 0 < inner < outer.
    """

    centre: Sequence[float]
    inner: float
    outer: float

    def __post_init__(self) -> None:
        """Check centre and radii."""
        check_round("ring", self.centre, 2, self.outer)
        _check_radii("ring", self.inner, self.outer)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The square around the ring."""
        return self.origin - self.outer, self.origin + self.outer

    @property
    def measure(self) -> float:
        """Area."""
        return math.pi * (self.outer**2 - self.inner**2)

    @property
    def origin(self) -> FloatArray:
        """The centre, about which the lattice is then symmetric."""
        return np.array(self.centre, dtype=float)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        return _between(x, self.origin, self.inner, self.outer)

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide into sectors of rings."""
        position, size = annulus(self.inner, self.outer, _mean(spacing))
        return position + self.origin, size


@dataclass(frozen=True)
class Pipe(Shape):
    """A hollow circular cylinder in 3D along one of the axes.

    Parameters
    ----------
    centre : Sequence[float]
        Middle of the pipe, three coordinates.
    inner, outer, length : float
        Radii, 0 < inner < outer, and length.
    axis : int
        0, 1 or 2 for x, y or z.
    """

    centre: Sequence[float]
    inner: float
    outer: float
    length: float
    axis: int = 2

    def __post_init__(self) -> None:
        """Check the numbers."""
        _check_radii("pipe", self.inner, self.outer)
        _ = self._full

    @property
    def _full(self) -> Cylinder:
        """The cylinder without its bore."""
        return Cylinder(self.centre, self.outer, self.length, self.axis)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around the pipe."""
        return self._full.bounds

    @property
    def measure(self) -> float:
        """Volume."""
        return math.pi * (self.outer**2 - self.inner**2) * self.length

    @property
    def origin(self) -> FloatArray:
        """Centre of the lower end face."""
        return self._full.origin

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """The axis."""
        return (self.axis,)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        across = [k for k in range(3) if k != self.axis]
        centre = self.origin[across]
        return self._full.contains(x) & _between(x[:, across], centre, self.inner, self.outer)

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide into layers of rings."""
        across = _mean([spacing[(self.axis + 1) % 3], spacing[(self.axis + 2) % 3]])
        section = annulus(self.inner, self.outer, across)
        position, size = layers(*section, self.length, spacing[self.axis], self.axis)
        return position + self.origin, size


def _within(x: FloatArray, centre: FloatArray, radius: float) -> BoolArray:
    """Tell which positions are no further than `radius` from `centre`."""
    return np.asarray(np.sum((x - centre) ** 2, axis=1) <= radius**2)


def _between(x: FloatArray, centre: FloatArray, inner: float, outer: float) -> BoolArray:
    """Tell which distances from `centre` are between two radii."""
    square = np.sum((x - centre) ** 2, axis=1)
    return np.asarray((square >= inner**2) & (square <= outer**2))


def _mean(spacing: Sequence[float]) -> float:
    """Give the side of a square or cube of the same size as a cell."""
    return math.prod(spacing) ** (1.0 / len(spacing))


def _check_radii(name: str, inner: float, outer: float) -> None:
    """Check the two radii of a hollow shape."""
    check_positive(f"the inner radius of a {name}", inner)
    if not (math.isfinite(outer) and inner < outer):
        raise PygenError(
            f"the inner radius of a {name} is below the outer one, not {inner!r} and {outer!r}"
        )
