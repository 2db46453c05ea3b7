"""The five kinds of simulation and what a points file holds for each."""

from __future__ import annotations

from enum import IntEnum


class SimulationType(IntEnum):
    """`TYPE` of the `job` section of a config."""

    UNIAXIAL_STRAIN = 1
    PLANE_STRAIN = 2
    THREE_D = 3
    AXISYMMETRIC = 4
    OUT_OF_PLANE = 5

    @property
    def dimension(self) -> int:
        """Directions of the grid: the coordinates that a point has."""
        return (1, 2, 3, 2, 2)[self - 1]

    @property
    def components(self) -> int:
        """Components of a velocity, and columns of a position."""
        return (1, 2, 3, 3, 3)[self - 1]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the components, in the order of the file."""
        return (("x",), ("x", "y"), ("x", "y", "z"), ("r", "z", "theta"), ("x", "y", "z"))[self - 1]

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of the points file."""
        velocity = ("v",) if self.components == 1 else tuple(f"v{c}" for c in self.coordinates)
        return ("m", "V", *self.coordinates, *velocity, "a")

    @property
    def widths(self) -> tuple[int, ...]:
        """Numbers of columns that a reader accepts.

        Types 4 and 5 may leave out the third component of position and velocity.
        """
        full = 3 + 2 * self.components
        return (full,) if self.components == self.dimension else (full, 3 + 2 * self.dimension)
