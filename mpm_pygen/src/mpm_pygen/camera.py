"""Boxes in space, seen from a side: what the 3D views are drawn with."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mpm_pygen.shape import BoolArray, FloatArray, IntArray

#: Faces of a box by the signs of its half sides: direction of the normal, its sign.
_FACES = [(axis, sign) for axis in range(3) for sign in (-1.0, 1.0)]
#: Direction to the light, in the frame of the viewer: right, up, towards.
_LIGHT = np.array([-0.35, 0.75, 0.56])


@dataclass(frozen=True)
class Camera:
    """Parallel projection.

    Parameters
    ----------
    azimuth : float
        Direction from which is looked, counter-clockwise from x. [degrees]
    elevation : float
        Height above the plane of x and y. [degrees]
    """

    azimuth: float = -60.0
    elevation: float = 20.0

    @property
    def frame(self) -> FloatArray:
        """Unit vectors to the right, up, and towards the viewer, one a row."""
        a, e = math.radians(self.azimuth), math.radians(self.elevation)
        return np.array(
            [
                [-math.sin(a), math.cos(a), 0.0],
                [-math.sin(e) * math.cos(a), -math.sin(e) * math.sin(a), math.cos(e)],
                [math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)],
            ]
        )

    def project(self, x: FloatArray) -> FloatArray:
        """Give right, up and nearness of positions, `(n, 3)`.

        Parameters
        ----------
        x : FloatArray
            `(n, 3)`.
        """
        return np.asarray(x @ self.frame.T, dtype=np.float64)

    def faces(
        self, centre: FloatArray, half: FloatArray, axes: FloatArray | None = None
    ) -> tuple[FloatArray, IntArray, FloatArray]:
        """Give the faces of boxes that look to the viewer, those far away first.

        Parameters
        ----------
        centre : FloatArray
            `(n, 3)`.
        half : FloatArray
            Half sides, `(n, 3)`.
        axes : FloatArray, optional
            Directions of the sides, `(n, 3, 3)`, one a row; those of the axes when left out.

        Returns
        -------
        corners : FloatArray
            Right and up, `(m, 4, 2)`.
        box : FloatArray
            Number of the box of a face, `(m,)`.
        light : FloatArray
            How bright a face is, from 0 to 1, `(m,)`.
        """
        if axes is None:
            axes = np.broadcast_to(np.eye(3), (len(centre), 3, 3))
        frame = self.frame
        seen_axes = axes @ frame.T
        seen_centre = self.project(centre)
        corners, boxes, lights, depths = [], [], [], []
        for axis, sign in _FACES:
            normal = sign * seen_axes[:, axis]
            kept = np.flatnonzero(normal[:, 2] > 1e-9)
            sides = half[kept, :, None] * seen_axes[kept]
            middle = seen_centre[kept] + sign * sides[:, axis]
            first, second = sides[:, (axis + 1) % 3], sides[:, (axis + 2) % 3]
            loop = [first + second, second - first, -first - second, first - second]
            corners.append(np.stack([middle + side for side in loop], axis=1)[:, :, :2])
            boxes.append(kept)
            lights.append(np.clip(normal[kept] @ _LIGHT, 0.0, 1.0))
            depths.append(seen_centre[kept, 2])
        order = np.argsort(np.concatenate(depths), kind="stable")
        return (
            np.concatenate(corners)[order],
            np.concatenate(boxes)[order],
            np.concatenate(lights)[order],
        )

    def box_edges(self, lower: FloatArray, upper: FloatArray) -> FloatArray:
        """Give the edges of a box behind its content: those of the three faces at the back.

        Parameters
        ----------
        lower, upper : FloatArray
            Opposite corners, `(3,)`.

        Returns
        -------
        FloatArray
            Right and up of both ends, `(9, 2, 2)`.
        """
        towards = self.frame[2]
        far = np.where(towards > 0.0, lower, upper)
        near = np.where(towards > 0.0, upper, lower)
        edges = []
        for k in range(3):
            for other in range(3):
                # The edge along k from the far corner, and those one step to the near side.
                start = far.copy()
                if other != k:
                    start[other] = near[other]
                end = start.copy()
                end[k] = near[k]
                edges.append([start, end])
        return self.project(np.array(edges).reshape(-1, 3))[:, :2].reshape(-1, 2, 2)


def revolve(
    position: FloatArray, side: FloatArray, outside: BoolArray, sweep: tuple[float, float]
) -> tuple[FloatArray, FloatArray, FloatArray, IntArray]:
    """Turn squares of the meridian plane about the axis: boxes along the way.

    Parameters
    ----------
    position : FloatArray
        r and z of their middles, `(n, 2)`.
    side : FloatArray
        Their sides, `(n,)`.
    outside : BoolArray
        Squares on the surface of the body; of the others only the ends can be seen, `(n,)`.
    sweep : tuple[float, float]
        First and last angle. [degrees]

    Returns
    -------
    centre, half, axes : FloatArray
        Of the boxes, as for `Camera.faces`.
    source : IntArray
        Number of the square of each box, `(m,)`.
    """
    start, end = math.radians(sweep[0]), math.radians(sweep[1])
    r, z = position.T
    # About as long as wide, but no coarser than 10 degrees.
    counts = np.ceil((end - start) * np.maximum(r / side, 1.0 / 0.1745)).astype(int)
    source = np.repeat(np.arange(len(r)), counts)
    place = np.arange(len(source)) - np.repeat(np.cumsum(counts) - counts, counts)
    seen = outside[source] | (place == 0) | (place == counts[source] - 1)
    source, place = source[seen], place[seen]
    step = (end - start) / counts[source]
    angle = start + (place + 0.5) * step
    cosine, sine, zero = np.cos(angle), np.sin(angle), np.zeros(len(angle))
    centre = np.column_stack([r[source] * cosine, r[source] * sine, z[source]])
    width = 0.5 * side[source]
    half = np.column_stack([width, (r[source] + width) * np.tan(0.5 * step), width])
    axes = np.stack(
        [
            np.column_stack([cosine, sine, zero]),
            np.column_stack([-sine, cosine, zero]),
            np.column_stack([zero, zero, zero + 1.0]),
        ],
        axis=1,
    )
    return centre, half, axes, source
