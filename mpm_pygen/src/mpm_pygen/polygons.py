"""Polygons, with holes or without, and shapes drawn as polygons."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.shape import BoolArray, FloatArray, Shape, check_finite, check_positive

#: A position this near to an edge, in parts of the size of the polygon, is on the edge.
ON_EDGE = 1e-12

#: Positions are compared with the edges in blocks of about this many pairs.
PAIRS = 4_000_000


@dataclass(frozen=True)
class Polygon(Shape):
    """A polygon in a plane, whose loops may cross neither themselves nor each other.

    Parameters
    ----------
    corners : Sequence[Sequence[float]]
        At least three, in either sense of rotation.
    holes : Sequence[Sequence[Sequence[float]]]
        Loops inside it.
    """

    corners: Sequence[Sequence[float]]
    holes: Sequence[Sequence[Sequence[float]]] = field(default=())

    def __post_init__(self) -> None:
        """Check the corners."""
        for loop in (self.corners, *self.holes):
            if len(loop) < 3 or any(len(corner) != 2 for corner in loop):
                raise PygenError("a loop of a polygon has at least three corners of two numbers")
            for corner in loop:
                check_finite("corner of a polygon", corner)
        if not self.measure > 0.0:
            raise PygenError("a polygon encloses an area above 0, and its holes less than that")

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The rectangle around the corners."""
        corners = np.array(self.corners, dtype=float)
        return corners.min(axis=0), corners.max(axis=0)

    @property
    def measure(self) -> float:
        """Area, without that of the holes."""
        return _loop_area(self.corners) - math.fsum(_loop_area(hole) for hole in self.holes)

    @property
    def origin(self) -> FloatArray:
        """The lower corner of the bounds."""
        return self.bounds[0]

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions a ray to the right from which crosses the loops an odd time."""
        starts, ends = self._edges()
        lower, upper = self.bounds
        near = ON_EDGE * float(np.max(upper - lower))
        block = max(1, PAIRS // len(starts))
        inside = np.zeros(len(x), dtype=bool)
        for first in range(0, len(x), block):
            part = x[first : first + block, None, :]
            along = ends - starts
            offset = part - starts
            cross = along[:, 0] * offset[..., 1] - along[:, 1] * offset[..., 0]
            # Half-open in y, so that a ray through a corner crosses one of its two edges.
            upward = (starts[:, 1] <= part[..., 1]) & (part[..., 1] < ends[:, 1])
            downward = (ends[:, 1] <= part[..., 1]) & (part[..., 1] < starts[:, 1])
            crossings = (upward & (cross > 0.0)) | (downward & (cross < 0.0))
            length = np.sum(along**2, axis=1)
            nearest = np.clip(np.sum(offset * along, axis=-1) / length, 0.0, 1.0)
            gap = np.sum((offset - nearest[..., None] * along) ** 2, axis=-1)
            on_edge = np.any(gap <= near**2, axis=1)
            inside[first : first + block] = (np.sum(crossings, axis=1) % 2 == 1) | on_edge
        return inside

    def fitted(self, spacing: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Divide a convex quadrilateral or a triangle into rows and columns of quadrilaterals."""
        if self.holes or len(self.corners) > 4:
            raise PygenError(
                "a polygon has a body-fitted fill when it has 3 or 4 corners and no hole; "
                "use the regular one, or a union of quadrilaterals"
            )
        corners = np.array([*self.corners, self.corners[-1]][:4], dtype=float)
        if _signed_area(corners) < 0.0:
            corners = corners[::-1]
        sides = np.roll(corners, -1, axis=0) - corners
        turns = np.cross(_solid(sides), _solid(np.roll(sides, -1, axis=0)))[:, 2]
        if np.any(turns < 0.0):
            raise PygenError("a quadrilateral with a body-fitted fill has no corner that points in")
        step = math.sqrt(math.prod(spacing))
        lengths = np.sqrt(np.sum(sides**2, axis=1))
        counts = [max(1, round(0.5 * (lengths[k] + lengths[k + 2]) / step)) for k in (0, 1)]
        u, v = (np.linspace(0.0, 1.0, n + 1) for n in counts)
        u, v = u[:, None, None], v[None, :, None]
        nodes = (
            (1 - u) * (1 - v) * corners[0]
            + u * (1 - v) * corners[1]
            + u * v * corners[2]
            + (1 - u) * v * corners[3]
        )
        cells = [nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]]
        return _centroids(np.stack(cells, axis=2).reshape(-1, 4, 2))

    def _edges(self) -> tuple[FloatArray, FloatArray]:
        """Give start and end of the edges of all loops, without edges of length 0."""
        loops = [np.array(loop, dtype=float) for loop in (self.corners, *self.holes)]
        starts = np.concatenate(loops)
        ends = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
        kept = np.any(starts != ends, axis=1)
        return starts[kept], ends[kept]


def wedge(corner: Sequence[float], length: float, degrees: float) -> Polygon:
    """Make a right-angled triangle on the ground.

    Parameters
    ----------
    corner : Sequence[float]
        Its tip, on the left.
    length : float
        Length of the side on the ground.
    degrees : float
        Angle at the tip, above 0 and below 90.

    Returns
    -------
    Polygon
        With the upright side on the right; `mirrored` puts it on the left.
    """
    check_positive("the length of a wedge", length)
    height = length * math.tan(_slope_angle(degrees))
    x, y = corner
    return Polygon(((x, y), (x + length, y), (x + length, y + height)))


def slope(
    corner: Sequence[float], *, crest: float, height: float, degrees: float, toe: float = 0.0
) -> Polygon:
    """Make an embankment: level ground, which falls to the right.

    Parameters
    ----------
    corner : Sequence[float]
        Lower left corner.
    crest : float
        Length of the level top.
    height : float
        Height of the top above the foot of the slope.
    degrees : float
        Angle of the slope, above 0 and below 90.
    toe : float
        Depth of the ground below the foot of the slope; it goes on to the right by its height.

    Returns
    -------
    Polygon
        Four corners without a toe, six with one.
    """
    check_positive("the crest of a slope", crest)
    check_positive("the height of a slope", height)
    run = height / math.tan(_slope_angle(degrees))
    x, y = corner
    if toe == 0.0:
        return Polygon(((x, y), (x + crest + run, y), (x + crest, y + height), (x, y + height)))
    check_positive("the toe of a slope", toe)
    foot = x + crest + run
    return Polygon(
        (
            (x, y),
            (foot + height, y),
            (foot + height, y + toe),
            (foot, y + toe),
            (x + crest, y + toe + height),
            (x, y + toe + height),
        )
    )


def naca(
    digits: str,
    chord: float,
    *,
    nose: Sequence[float] = (0.0, 0.0),
    degrees: float = 0.0,
    stations: int = 100,
) -> Shape:
    """Make an aerofoil of the NACA four-digit series with a closed trailing edge.

    Parameters
    ----------
    digits : str
        Camber in percent of the chord, its place in tenths, thickness in percent (two digits).
    chord : float
        Length.
    nose : Sequence[float]
        Position of the leading edge, about which the profile is turned.
    degrees : float
        Angle of attack: the trailing edge goes down when it is positive.
    stations : int
        Number of stations along the chord, closer at its ends.

    Returns
    -------
    Shape
        A polygon; moved when turned.
    """
    if len(digits) != 4 or not (digits.isascii() and digits.isdigit()) or digits[2:] == "00":
        raise PygenError(
            f"a profile has four digits, the last two of which are above 00, not {digits!r}"
        )
    check_positive("the chord", chord)
    if stations < 3:
        raise PygenError(f"a profile needs at least 3 stations, not {stations}")
    camber, place = int(digits[0]) / 100.0, int(digits[1]) / 10.0
    if (camber > 0.0) != (place > 0.0):
        raise PygenError("the first two digits of a profile are both 0 or both above 0")
    t = 0.5 * (1.0 - np.cos(np.linspace(0.0, math.pi, stations)))
    # The last coefficient is the one that closes the trailing edge.
    half = (0.2969 * np.sqrt(t) - 0.126 * t - 0.3516 * t**2 + 0.2843 * t**3 - 0.1036 * t**4) * (
        5.0 * int(digits[2:]) / 100.0
    )
    half[-1] = 0.0
    line, rise = np.zeros_like(t), np.zeros_like(t)
    if camber > 0.0:
        ahead = t < place
        line = np.where(
            ahead,
            camber / place**2 * (2.0 * place * t - t**2),
            camber / (1.0 - place) ** 2 * (1.0 - 2.0 * place + 2.0 * place * t - t**2),
        )
        rise = 2.0 * camber * (place - t) / np.where(ahead, place, 1.0 - place) ** 2
    angle = np.arctan(rise)
    upper = np.column_stack([t - half * np.sin(angle), line + half * np.cos(angle)])
    lower = np.column_stack([t + half * np.sin(angle), line - half * np.cos(angle)])
    # From the trailing edge over the upper side to the nose, and back below.
    outline = np.array(nose) + chord * np.concatenate([upper[::-1], lower[1:-1]])
    profile = Polygon(tuple(map(tuple, outline.tolist())))
    return profile.rotated(-degrees, centre=nose) if degrees else profile


def _slope_angle(degrees: float) -> float:
    """Check an angle against the ground."""
    if not 0.0 < degrees < 90.0:
        raise PygenError(f"the angle of a slope is above 0 and below 90 degrees, not {degrees!r}")
    return math.radians(degrees)


def _solid(vectors: FloatArray) -> FloatArray:
    """Add a third component, 0."""
    return np.column_stack([vectors, np.zeros(len(vectors))])


def _signed_area(loop: FloatArray) -> float:
    """Give the area of a loop, above 0 when it is counter-clockwise."""
    x, y = (loop - loop[0]).T
    return 0.5 * math.fsum((x * np.roll(y, -1) - y * np.roll(x, -1)).tolist())


def _loop_area(loop: Sequence[Sequence[float]]) -> float:
    """Give the area that a loop encloses."""
    return abs(_signed_area(np.array(loop, dtype=float)))


def _centroids(cells: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give centroids and areas of quadrilaterals, `(n, 4, 2)`, without those of no area."""
    first = cells[:, 0]
    a, b, c = (cells[:, k] - first for k in (1, 2, 3))
    # Twice the areas of the two triangles that the first corner and each far side make.
    near = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    far = b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0]
    area = 0.5 * (near + far)
    kept = area > 0.0
    moment = (near[:, None] * (a + b) + far[:, None] * (b + c)) / 6.0
    return (first[kept] + moment[kept] / area[kept, None]), area[kept]
