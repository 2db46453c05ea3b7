"""Cells that follow circles and spheres, with their exact sizes and centroids."""

from __future__ import annotations

import itertools
import math

import numpy as np

from mpm_pygen.shape import FloatArray


def annulus(
    inner: float, outer: float, spacing: float, *, half: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Divide a disc or annulus about the origin into sectors of rings.

    Rings have one width, sectors of a ring one angle. All cells of a full disc have one area: the
    number of sectors is 4 times an odd number that grows by 2 from ring to ring.

    Parameters
    ----------
    inner, outer : float
        Radii; a disc has the inner radius 0.
    spacing : float
        Side of a square of about the same area as a cell.
    half : bool
        Make the half with a first coordinate above 0 only.

    Returns
    -------
    position, size : FloatArray
        Centroids `(n, 2)` and areas `(n,)`, ring by ring from the inside, counter-clockwise.
    """
    # A disc of rings of width w has 4 (2 k + 1) cells of pi w^2/4 in ring k.
    width = spacing if inner > 0.0 else spacing * math.sqrt(4.0 / math.pi)
    rings = max(1, round((outer - inner) / width))
    width = (outer - inner) / rings
    share = 2 if half else 1
    positions, sizes = [], []
    for k in range(rings):
        low, high = inner + k * width, inner + (k + 1) * width
        if inner > 0.0:
            sectors = 4 * max(1, round(math.pi * (high**2 - low**2) / (4.0 * spacing**2)))
        else:
            sectors = 4 * (2 * k + 1)
        angle = 2.0 * math.pi / sectors
        # Centroid of a sector of a ring.
        radius = 2.0 / 3.0 * (high**3 - low**3) / (high**2 - low**2)
        radius *= math.sin(0.5 * angle) / (0.5 * angle)
        turn = _turns(sectors // share, angle, -0.5 * math.pi if half else 0.0)
        positions.append(radius * turn)
        sizes.append(np.full(sectors // share, math.pi * (high**2 - low**2) / sectors))
    return np.concatenate(positions), np.concatenate(sizes)


def ball(radius: float, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Divide a ball about the origin into shells, bands of latitude and sectors.

    Parameters
    ----------
    radius : float
        Radius of the ball.
    spacing : float
        About the side of a cell.

    Returns
    -------
    position, size : FloatArray
        Centroids `(n, 3)` and volumes `(n,)`.
    """
    shells = max(1, round(radius / spacing))
    width = radius / shells
    positions, sizes = [], []
    for k in range(shells):
        low, high = k * width, (k + 1) * width
        middle = 0.5 * (low + high)
        bands = 2 * max(1, round(0.5 * math.pi * middle / spacing))
        edges = np.linspace(-0.5 * math.pi, 0.5 * math.pi, bands + 1)
        for south, north in itertools.pairwise(edges):
            around = 2.0 * math.pi * middle * math.cos(0.5 * (south + north))
            sectors = 4 * max(1, round(around / (4.0 * spacing)))
            angle = 2.0 * math.pi / sectors
            # Integrals of 1, z and the distance from the axis, in spherical coordinates.
            height = math.sin(north) - math.sin(south)
            volume = (high**3 - low**3) / 3.0 * height * angle
            quarter = (high**4 - low**4) / 4.0
            z = quarter * 0.5 * (math.sin(north) ** 2 - math.sin(south) ** 2) * angle / volume
            distance = quarter * 2.0 * math.sin(0.5 * angle) / volume
            distance *= 0.5 * (
                north
                - south
                + math.sin(north) * math.cos(north)
                - math.sin(south) * math.cos(south)
            )
            turn = _turns(sectors, angle, 0.0)
            positions.append(np.column_stack([distance * turn, np.full(sectors, z)]))
            sizes.append(np.full(sectors, volume))
    return np.concatenate(positions), np.concatenate(sizes)


def layers(
    position: FloatArray, size: FloatArray, length: float, spacing: float, axis: int
) -> tuple[FloatArray, FloatArray]:
    """Stack plane cells to a prism from 0 to `length` along an axis of 3D.

    Parameters
    ----------
    position, size : FloatArray
        Cells in the plane of the two other directions, in cyclic order.
    length, spacing : float
        Length of the prism, and about the height of a layer.
    axis : int
        0, 1 or 2.

    Returns
    -------
    position, size : FloatArray
        Centroids `(n, 3)` and volumes `(n,)`, layer by layer.
    """
    count = max(1, round(length / spacing))
    height = length / count
    solid = np.empty((count, len(position), 3))
    solid[:, :, (axis + 1) % 3] = position[:, 0]
    solid[:, :, (axis + 2) % 3] = position[:, 1]
    solid[:, :, axis] = height * (np.arange(count) + 0.5)[:, None]
    return solid.reshape(-1, 3), np.tile(size * height, count)


def _turns(count: int, angle: float, start: float) -> FloatArray:
    """Give unit vectors at the middles of sectors."""
    angles = start + angle * (np.arange(count) + 0.5)
    return np.column_stack([np.cos(angles), np.sin(angles)])
