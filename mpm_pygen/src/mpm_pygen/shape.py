"""What a shape is, and shapes made from shapes: unions, differences, intersections, moved ones."""

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
IntArray = NDArray[np.int_]


class Shape(ABC):
    """A region of 1D, 2D or 3D space.

    `a | b`, `a - b` and `a & b` are union, difference and intersection.
    """

    @property
    @abstractmethod
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner of a box around the shape, each `(dimension,)`."""

    @property
    @abstractmethod
    def measure(self) -> float:
        """Exact length, area or volume; `PygenError` when there is no closed form."""

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

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide the shape into cells that follow its surface, about `spacing` wide.

        Parameters
        ----------
        spacing : Sequence[float]
            Wanted width of the cells, one number for each direction.

        Returns
        -------
        position : FloatArray
            Centroids of the cells, `(n, dimension)`.
        size : FloatArray
            Lengths, areas or volumes of the cells, `(n,)`; they sum to `measure`.
        """
        raise PygenError(
            f"a {type(self).__name__} has no body-fitted fill of its own; use the regular one"
        )

    def __or__(self, other: Shape) -> Shape:
        """Unite with another shape."""
        return Union((self, other))

    def __and__(self, other: Shape) -> Shape:
        """Keep what lies in another shape as well."""
        return Intersection(self, other)

    def __sub__(self, other: Shape) -> Shape:
        """Take another shape away."""
        return Difference(self, other)

    def translated(self, *shift: float) -> Shape:
        """Move by a vector, one number for each direction."""
        _check_count("a shift", shift, self.dimension)
        return Transformed(self, np.eye(self.dimension), np.array(shift, dtype=float))

    def rotated(
        self, degrees: float, *, centre: Sequence[float] | None = None, axis: int = 2
    ) -> Shape:
        """Turn counter-clockwise.

        Parameters
        ----------
        degrees : float
            Angle.
        centre : Sequence[float], optional
            Position that stays; the origin when left out.
        axis : int
            In 3D the direction of the axis: 0, 1 or 2 for x, y or z.
        """
        d = self.dimension
        if d == 1:
            raise PygenError("there is nothing to rotate in one dimension")
        if axis not in (0, 1, 2):
            raise PygenError(f"the axis of a rotation is 0, 1 or 2, not {axis!r}")
        first, second = (0, 1) if d == 2 else ((axis + 1) % 3, (axis + 2) % 3)
        cosine, sine = _cosine_and_sine(degrees)
        matrix = np.eye(d)
        matrix[first, first] = matrix[second, second] = cosine
        matrix[first, second], matrix[second, first] = -sine, sine
        return self._about(matrix, centre)

    def scaled(
        self, factor: float | Sequence[float], *, centre: Sequence[float] | None = None
    ) -> Shape:
        """Stretch by a factor, or by one for each direction; `centre` (the origin) stays."""
        factors = [factor] * self.dimension if isinstance(factor, float | int) else list(factor)
        _check_count("the factors of a shape", factors, self.dimension)
        for value in factors:
            check_positive("a factor", value)
        return self._about(np.diag(np.array(factors, dtype=float)), centre)

    def mirrored(self, direction: int, at: float = 0.0) -> Shape:
        """Mirror at the plane on which coordinate number `direction` (from 0) is `at`."""
        if direction not in range(self.dimension):
            raise PygenError(
                f"the direction of a mirror is 0 to {self.dimension - 1}, not {direction!r}"
            )
        matrix = np.eye(self.dimension)
        matrix[direction, direction] = -1.0
        centre = np.zeros(self.dimension)
        centre[direction] = at
        return self._about(matrix, centre.tolist())

    def _about(self, matrix: FloatArray, centre: Sequence[float] | None) -> Shape:
        """Map with a matrix and a position that stays."""
        fixed = np.zeros(self.dimension)
        if centre is not None:
            _check_count("the centre", centre, self.dimension)
            fixed = np.array(centre, dtype=float)
        return Transformed(self, matrix, fixed - matrix @ fixed)


@dataclass(frozen=True)
class Union(Shape):
    """All that lies in any of some shapes; the first one places the lattice.

    Parameters
    ----------
    parts : Sequence[Shape]
        At least one, of the same dimension.
    """

    parts: Sequence[Shape]

    def __post_init__(self) -> None:
        """Check the dimensions."""
        if not self.parts:
            raise PygenError("a union needs at least one shape")
        for part in self.parts:
            _check_same(self.parts[0], part)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around all."""
        lower = np.min([part.bounds[0] for part in self.parts], axis=0)
        return lower, np.max([part.bounds[1] for part in self.parts], axis=0)

    @property
    def measure(self) -> float:
        """The sum, when the boxes around the parts show that none overlap."""
        for k, part in enumerate(self.parts):
            for other in self.parts[:k]:
                if not _apart(part, other):
                    raise PygenError("the measure of a union of shapes that meet is not known")
        return math.fsum(part.measure for part in self.parts)

    @property
    def origin(self) -> FloatArray:
        """That of the first shape."""
        return self.parts[0].origin

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        return np.asarray(np.any([part.contains(x) for part in self.parts], axis=0))


@dataclass(frozen=True)
class Intersection(Shape):
    """All that lies in two shapes; the first one places the lattice."""

    first: Shape
    second: Shape

    def __post_init__(self) -> None:
        """Check the dimensions."""
        _check_same(self.first, self.second)
        if _apart(self.first, self.second):
            raise PygenError("the shapes of an intersection do not meet")

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box that the boxes around both have in common."""
        lower = np.maximum(self.first.bounds[0], self.second.bounds[0])
        return lower, np.minimum(self.first.bounds[1], self.second.bounds[1])

    @property
    def measure(self) -> float:
        """Not known."""
        raise PygenError("the measure of an intersection is not known")

    @property
    def origin(self) -> FloatArray:
        """That of the first shape."""
        return self.first.origin

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        return self.first.contains(x) & self.second.contains(x)


@dataclass(frozen=True)
class Difference(Shape):
    """All that lies in the first shape and not in the second."""

    first: Shape
    second: Shape

    def __post_init__(self) -> None:
        """Check the dimensions."""
        _check_same(self.first, self.second)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around the first shape."""
        return self.first.bounds

    @property
    def measure(self) -> float:
        """That of the first shape, when the boxes show that the second takes nothing away."""
        if not _apart(self.first, self.second):
            raise PygenError("the measure of a difference is not known")
        return self.first.measure

    @property
    def origin(self) -> FloatArray:
        """That of the first shape."""
        return self.first.origin

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """Those of the first shape."""
        return self.first.flat_directions

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        return self.first.contains(x) & ~self.second.contains(x)


@dataclass(frozen=True, eq=False)
class Transformed(Shape):
    """A shape after the map matrix x + shift.

    Parameters
    ----------
    shape : Shape
        What is mapped.
    matrix : FloatArray
        `(dimension, dimension)`, with an inverse.
    shift : FloatArray
        `(dimension,)`.
    """

    shape: Shape
    matrix: FloatArray
    shift: FloatArray

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (np.all(np.isfinite(self.matrix)) and np.all(np.isfinite(self.shift))):
            raise PygenError("a number of a transformation is not finite")
        if np.linalg.det(self.matrix) == 0.0:
            raise PygenError("the matrix of a transformation has no inverse")

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around the mapped box, which need not be the smallest one."""
        ends = np.stack(self.shape.bounds)
        corners = np.stack(np.meshgrid(*ends.T, indexing="ij"), axis=-1)
        mapped = corners.reshape(-1, len(self.shift)) @ self.matrix.T + self.shift
        return mapped.min(axis=0), mapped.max(axis=0)

    @property
    def measure(self) -> float:
        """Measure of the shape times the determinant."""
        return self.shape.measure * self._stretch

    @property
    def origin(self) -> FloatArray:
        """The mapped origin; the lower corner in flat directions."""
        origin = np.asarray(self.matrix @ self.shape.origin + self.shift)
        for k in self.flat_directions:
            origin[k] = self.bounds[0][k]
        return origin

    @property
    def flat_directions(self) -> tuple[int, ...]:
        """Flat directions that are along an axis again."""
        flat = []
        for k, row in enumerate(self.matrix):
            sources = np.flatnonzero(row)
            if len(sources) == 1 and sources[0] in self.shape.flat_directions:
                flat.append(k)
        return tuple(flat)

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions are inside."""
        original = np.linalg.solve(self.matrix, (x - self.shift).T).T
        return self.shape.contains(np.asarray(original, dtype=np.float64))

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Map the cells of the shape."""
        stretch = self._stretch
        factor = stretch ** (1.0 / len(self.shift))
        position, size = self.shape.fitted([h / factor for h in spacing])
        return position @ self.matrix.T + self.shift, size * stretch

    @property
    def _stretch(self) -> float:
        """What a volume grows by."""
        return abs(float(np.linalg.det(self.matrix)))


def check_positive(name: str, value: float) -> None:
    """Refuse what is not a finite number above 0."""
    if not (math.isfinite(value) and value > 0.0):
        raise PygenError(f"{name} is a number above 0, not {value!r}")


def check_finite(name: str, values: Sequence[float]) -> None:
    """Refuse infinities and NaN."""
    for value in values:
        if not math.isfinite(value):
            raise PygenError(f"a coordinate of the {name} is {value!r}, which is not a number")


def check_round(name: str, centre: Sequence[float], dimension: int, radius: float) -> None:
    """Check what all round shapes have."""
    if len(centre) != dimension:
        raise PygenError(f"the centre of a {name} has {dimension} coordinates, not {len(centre)}")
    check_finite(f"centre of a {name}", centre)
    check_positive(f"the radius of a {name}", radius)


def _check_count(name: str, values: Sequence[float], dimension: int) -> None:
    """Check that there is one number for each direction."""
    if len(values) != dimension:
        raise PygenError(f"{name} has {dimension} numbers here, not {len(values)}")


def _check_same(first: Shape, second: Shape) -> None:
    """Check that two shapes have the same dimension."""
    if first.dimension != second.dimension:
        raise PygenError(
            f"shapes of {first.dimension} and {second.dimension} dimensions cannot be combined"
        )


def _apart(first: Shape, second: Shape) -> bool:
    """Tell whether the boxes around two shapes have no interior in common."""
    lower = np.maximum(first.bounds[0], second.bounds[0])
    return bool(np.any(lower >= np.minimum(first.bounds[1], second.bounds[1])))


def _cosine_and_sine(degrees: float) -> tuple[float, float]:
    """Give exact values for multiples of a right angle."""
    quarters = degrees / 90.0
    if quarters == round(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
