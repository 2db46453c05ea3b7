"""Boxes cut into triangles or tetrahedra, as Gmsh files."""

from __future__ import annotations

import itertools
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from mpm_pygen.errors import PygenError
from mpm_pygen.expressions import evaluate

#: Gmsh's names of lines, triangles and tetrahedra, by their number of nodes.
_KIND = {2: 1, 3: 2, 4: 4}
#: Most nodes of a mesh: text of some hundred megabytes.
_MOST = 5_000_000

Integers = npt.NDArray[np.int64]


def write_box_mesh(
    path: str | os.PathLike[str],
    lower: Sequence[float],
    upper: Sequence[float],
    cells: Sequence[int],
    image: Sequence[str] = (),
) -> int:
    """Write the mesh of a box: two triangles in each cell, or six tetrahedra.

    Parameters
    ----------
    path : str or os.PathLike
        The file, Gmsh version 4.1 as text.
    lower, upper : Sequence[float]
        Corners, two or three numbers.
    cells : Sequence[int]
        Cells along each side.
    image : Sequence[str]
        Expressions of x, y (and z) that give the positions of the nodes; those of the box when
        left out.

    Returns
    -------
    int
        Number of triangles or tetrahedra. The sides have the tags 1 to 6: -x, +x, -y, +y, -z, +z.
    """
    dim = len(cells)
    if dim not in (2, 3) or len(lower) != dim or len(upper) != dim:
        raise PygenError("a mesh needs corners and cells of two or three directions")
    if min(cells) < 1:
        raise PygenError("a mesh has at least one cell along each side")
    if any(a >= b for a, b in zip(lower, upper, strict=True)):
        raise PygenError("each number of the lower corner must be below that of the upper one")
    if len(image) not in (0, dim):
        raise PygenError(f"the map needs {dim} expressions")
    if np.prod([float(n) + 1.0 for n in cells]) > _MOST:
        raise PygenError(f"the mesh has more than {_MOST} nodes: use fewer cells")
    nodes = np.arange(np.prod([n + 1 for n in cells])).reshape([n + 1 for n in cells], order="F")
    lines = [np.linspace(a, b, n + 1) for a, b, n in zip(lower, upper, cells, strict=True)]
    x = np.zeros((nodes.size, 3))
    for d, values in enumerate(np.meshgrid(*lines, indexing="ij")):
        x[:, d] = values.ravel(order="F")
    if image:
        places = dict(zip("xyz", x[:, :dim].T.copy(), strict=False))
        for d, text in enumerate(image):
            x[:, d] = evaluate(text, places)
        if not np.isfinite(x).all():
            raise PygenError("the map gives numbers that are not finite")
    blocks = [(dim, 1, _simplices(nodes))]
    for d in range(dim):
        for end in (0, 1):
            face = np.take(nodes, -end, axis=d)
            blocks.append((dim - 1, 1 + 2 * d + end, _simplices(face)))
    _write(Path(path), _text(x, blocks))
    return len(blocks[0][2])


def _write(path: Path, text: str) -> None:
    """Write a file: whole, or not at all."""
    temporary = path.parent / f".{path.name}.{os.getpid()}.tmp"
    try:
        temporary.write_text(text, "ascii", newline="\n")
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _simplices(nodes: Integers) -> Integers:
    """Cut a lattice of nodes into simplices, one for each order of the edges of a cell."""
    found = []
    for way in itertools.permutations(range(nodes.ndim)):
        place = [0] * nodes.ndim
        corners = [nodes[_cells(place)]]
        for d in way:
            place[d] = 1
            corners.append(nodes[_cells(place)])
        found.append(np.stack([corner.ravel(order="F") for corner in corners], axis=1))
    return np.stack(found, axis=1).reshape(-1, nodes.ndim + 1)


def _cells(place: list[int]) -> tuple[slice, ...]:
    """Give the nodes at one corner of all cells."""
    return tuple(slice(i, -1 if i == 0 else None) for i in place)


def _text(x: npt.NDArray[np.float64], blocks: list[tuple[int, int, Integers]]) -> str:
    """Give the text of a file."""
    n, count = len(x), sum(len(cells) for _, _, cells in blocks)
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Nodes", f"1 {n} 1 {n}"]
    lines += [f"{blocks[0][0]} 1 0 {n}", *map(str, range(1, n + 1))]
    lines += [" ".join(map(repr, position)) for position in x.tolist()]
    lines += ["$EndNodes", "$Elements", f"{len(blocks)} {count} 1 {count}"]
    number = 0
    for dim, tag, cells in blocks:
        lines.append(f"{dim} {tag} {_KIND[cells.shape[1]]} {len(cells)}")
        for nodes in (cells + 1).tolist():
            number += 1
            lines.append(f"{number} " + " ".join(map(str, nodes)))
    return "\n".join([*lines, "$EndElements"]) + "\n"
