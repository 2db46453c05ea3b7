"""Shapes from closed surface meshes."""

from __future__ import annotations

import itertools
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpm_pygen.errors import PygenError
from mpm_pygen.shape import BoolArray, FloatArray, IntArray, Shape

#: Rays are compared with the triangles in blocks of about this many pairs.
PAIRS = 2_000_000


@dataclass(frozen=True, eq=False)
class Mesh(Shape):
    """The inside of a closed surface of triangles in 3D.

    Parameters
    ----------
    vertices : FloatArray
        `(n, 3)`.
    triangles : IntArray
        `(m, 3)`, numbers of vertices, counter-clockwise seen from outside.
    """

    vertices: FloatArray
    triangles: IntArray

    def __post_init__(self) -> None:
        """Check that the surface is closed and encloses a volume."""
        if not np.all(np.isfinite(self.vertices)):
            raise PygenError("a vertex of a mesh is not finite")
        edges = np.concatenate([self.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
        forward = {tuple(edge) for edge in edges.tolist()}
        loose = sum((b, a) not in forward for a, b in forward)
        if len(forward) != len(edges) or loose:
            raise PygenError(
                f"the surface is not closed, or its triangles do not turn the same way: {loose} "
                f"edges have one triangle, {len(edges) - len(forward)} have two of one sense"
            )
        if not self.measure > 0.0:
            raise PygenError("the mesh is inside out: its triangles turn clockwise from outside")

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """The box around the vertices in use."""
        used = self.vertices[np.unique(self.triangles)]
        return used.min(axis=0), used.max(axis=0)

    @property
    def measure(self) -> float:
        """Volume."""
        a, b, c = (self.vertices[self.triangles[:, k]] - self.vertices[0] for k in range(3))
        return float(np.sum(np.cross(a, b) * c) / 6.0)

    @property
    def origin(self) -> FloatArray:
        """The middle of the bounds."""
        lower, upper = self.bounds
        return np.asarray(0.5 * (lower + upper))

    def contains(self, x: FloatArray) -> BoolArray:
        """Tell which positions the surface winds around: rays along z, one for each x and y."""
        rays, member = np.unique(x[:, :2], axis=0, return_inverse=True)
        member = member.ravel()
        order = np.argsort(member, kind="stable")
        starts = np.searchsorted(member[order], np.arange(len(rays) + 1))
        winding = np.zeros(len(x), dtype=int)
        block = max(1, PAIRS // len(self.triangles))
        for first in range(0, len(rays), block):
            for ray, height, sense in zip(*self._hits(rays[first : first + block]), strict=True):
                points = order[starts[first + ray] : starts[first + ray + 1]]
                winding[points] += np.where(x[points, 2] <= height, sense, 0)
        return np.asarray(winding != 0)

    def _hits(self, rays: FloatArray) -> tuple[list[int], list[float], list[int]]:
        """Find where rays meet the surface: as often out of the body as into it.

        A ray that grazes an upright face may miss one of the triangles above and below by
        round-off; it is moved a little aside.
        """
        corners = self.vertices[self.triangles]
        lower, upper = self.bounds
        aside = 1e-10 * (upper - lower)[:2] * np.array([0.618, 0.414])
        rays = rays.copy()
        for _ in range(4):
            ray, height, sense = _crossings(rays, corners)
            open_rays = np.bincount(ray, weights=sense, minlength=len(rays)) != 0.0
            if not np.any(open_rays):
                break
            rays[open_rays] += aside
        return ray.tolist(), height.tolist(), sense.tolist()


def _crossings(rays: FloatArray, corners: FloatArray) -> tuple[IntArray, FloatArray, IntArray]:
    """Find where rays along z meet triangles: ray, height, and 1 out or -1 into the body."""
    px, py = rays[:, 0][:, None], rays[:, 1][:, None]
    crossed = np.zeros((len(rays), len(corners)), dtype=bool)
    for k in range(3):
        (ax, ay), (bx, by) = corners[:, k, :2].T, corners[:, (k + 1) % 3, :2].T
        # An edge is taken from its lower end by both of its triangles, so that round-off gives a
        # ray next to it to one of them and not to both or none.
        swap = (by < ay) | ((by == ay) & (bx < ax))
        lx, ly = np.where(swap, bx, ax), np.where(swap, by, ay)
        ux, uy = np.where(swap, ax, bx), np.where(swap, ay, by)
        spans = (ly <= py) & (py < uy)
        crossed ^= spans & ((ux - lx) * (py - ly) - (uy - ly) * (px - lx) > 0.0)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    ray, triangle = np.nonzero(crossed & (normal[:, 2] != 0.0))
    a, normal = corners[triangle, 0], normal[triangle]
    offset = rays[ray] - a[:, :2]
    height = a[:, 2] - np.sum(normal[:, :2] * offset, axis=1) / normal[:, 2]
    sense = np.where(normal[:, 2] > 0.0, 1, -1)
    return ray, height, sense


def read_mesh(path: str | os.PathLike[str], *, scale: float = 1.0) -> Mesh:
    """Read a closed surface.

    Parameters
    ----------
    path : str or PathLike
        STL (text or binary) or OBJ; other formats are left to the package trimesh.
    scale : float
        What the coordinates are multiplied by, 0.001 for a drawing in millimetres.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".stl":
        corners = _read_stl(path)
        vertices, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
        triangles = index.reshape(-1, 3)
    elif suffix == ".obj":
        vertices, triangles = _read_obj(path)
    else:
        vertices, triangles = _read_other(path)
    if len(triangles) == 0:
        raise PygenError(f"{path} has no triangle")
    # Triangles without an extent close nothing.
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    try:
        return Mesh(vertices * scale, triangles)
    except PygenError as error:
        raise PygenError(f"{path}: {error}") from None


def _read_stl(path: Path) -> FloatArray:
    """Read the corners of the triangles, `(m, 3, 3)`."""
    data = path.read_bytes()
    if len(data) >= 84:
        (count,) = struct.unpack_from("<I", data, 80)
        if len(data) == 84 + 50 * count:
            facets = np.frombuffer(
                data, dtype=[("numbers", "<f4", 12), ("attribute", "<u2")], offset=84
            )
            return facets["numbers"][:, 3:].reshape(-1, 3, 3).astype(float)
    numbers = []
    for line, fields in _lines(path, data):
        if fields[0] == "vertex":
            numbers.append(_numbers(path, line, fields[1:4]))
    if len(numbers) % 3:
        raise PygenError(f"{path} is no STL file: {len(numbers)} vertices make no triangles")
    return np.array(numbers, dtype=float).reshape(-1, 3, 3)


def _read_obj(path: Path) -> tuple[FloatArray, IntArray]:
    """Read vertices and faces; faces of more than three corners become fans."""
    vertices: list[list[float]] = []
    triangles: list[list[int]] = []
    for line, fields in _lines(path, path.read_bytes()):
        if fields[0] == "v":
            vertices.append(_numbers(path, line, fields[1:4]))
        elif fields[0] == "f":
            try:
                face = [int(field.split("/")[0]) for field in fields[1:]]
            except ValueError:
                raise PygenError(f"{path}:{line}: a face has numbers of vertices") from None
            # Numbers are from 1 on, or from the last vertex back.
            face = [k - 1 if k > 0 else len(vertices) + k for k in face]
            if len(face) < 3 or not all(0 <= k < len(vertices) for k in face):
                raise PygenError(f"{path}:{line}: a face has at least 3 vertices that were given")
            triangles += [[face[0], b, c] for b, c in itertools.pairwise(face)]
    return np.array(vertices, dtype=float).reshape(-1, 3), np.array(triangles).reshape(-1, 3)


def _read_other(path: Path) -> tuple[FloatArray, IntArray]:
    """Let trimesh read."""
    try:
        import trimesh
    except ImportError:
        raise PygenError(
            f"{path}: STL and OBJ are read; other meshes need the package trimesh"
        ) from None
    try:
        mesh = trimesh.load_mesh(path)
    except (ValueError, KeyError, NotImplementedError) as error:
        raise PygenError(f"{path}: trimesh does not read it: {error}") from None
    return np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=int)


def _lines(path: Path, data: bytes) -> Iterator[tuple[int, list[str]]]:
    """Give the numbers and words of lines that are not empty."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        raise PygenError(f"{path}: this is no text, and no binary STL file") from None
    for line, content in enumerate(text.splitlines(), start=1):
        fields = content.split("#")[0].split()
        if fields:
            yield line, fields


def _numbers(path: Path, line: int, fields: list[str]) -> list[float]:
    """Read three coordinates."""
    try:
        numbers = [float(field) for field in fields]
    except ValueError:
        numbers = []
    if len(numbers) != 3:
        raise PygenError(f"{path}:{line}: a vertex has three numbers")
    return numbers
