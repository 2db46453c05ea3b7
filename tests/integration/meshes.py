"""Gmsh files of boxes cut into triangles or tetrahedra, and what classes need them in a scene."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

#: Name of the mesh that examples speak of.
MESH = "box.msh"
#: TYPE of scenes with classes that are not for plane strain.
TYPE_OF = {"Linear1DNonUniform": 1, "TetrahedralGridLinear": 3}
#: Cells along each side, by TYPE: few in 3D.
CELLS = {1: 20, 2: 10, 3: 6}

TRIANGLES = """grid
{
    class = "TriangularGridLinear"
    str-properties = {"box.msh"}
}"""
TETRAHEDRA = TRIANGLES.replace("Triangular", "Tetrahedral")
#: Type of Gmsh elements by their number of nodes.
KIND = {1: 15, 2: 1, 3: 2, 4: 4}

Integers = npt.NDArray[np.int64]


def type_of(example: str) -> int:
    """Return the TYPE of a scene with the example of a class."""
    name = re.search(r'class = "(\w+)"', example)
    return TYPE_OF.get(name[1], 2) if name else 2


def needs_mesh(example: str) -> bool:
    """Whether the example of a class works on a mesh only."""
    return "GeneralCustomBoundary" in example


def box_mesh(
    dim: int, cells: int, lower: float = 0.0, upper: float = 1.0
) -> tuple[npt.NDArray[np.float64], Integers, Integers, Integers]:
    """Cut a square or cube into simplices.

    Returns
    -------
    tuple
        Positions (nodes, 3); nodes of the cells; nodes of the sides; tags of the sides, 1 to 2 dim
        for the faces -x, +x, -y ...
    """
    line = np.linspace(lower, upper, cells + 1)
    steps = [(cells + 1) ** d for d in range(dim)]
    lattice = np.meshgrid(*[line] * dim, indexing="ij")
    x = np.zeros(((cells + 1) ** dim, 3))
    for d in range(dim):
        x[:, d] = lattice[dim - 1 - d].ravel()
    found, sides, tags = [], [], []
    for place in itertools.product(range(cells), repeat=dim):
        start = sum(i * step for i, step in zip(place, steps, strict=True))
        # A cube has a simplex for each order in which its edges lead from corner to corner.
        for way in itertools.permutations(range(dim)):
            found.append([start, *(start + np.cumsum([steps[d] for d in way]))])
    last = cells
    index = np.stack([np.arange(len(x)) // step % (cells + 1) for step in steps], axis=1)
    for cell in found:
        for face in itertools.combinations(cell, dim):
            for d in range(dim):
                for end in (0, last):
                    if all(index[node, d] == end for node in face):
                        sides.append(face)
                        tags.append(1 + 2 * d + (end == last))
    order = np.argsort(tags, kind="stable")
    return x, np.array(found), np.array(sides)[order], np.array(tags)[order]


def write_mesh(
    path: Path, dim: int, cells: int, version: str = "4.1", *, binary: bool = False
) -> None:
    """Write the mesh of a unit square or cube."""
    x, found, sides, tags = box_mesh(dim, cells)
    write_msh(
        path,
        x,
        [(dim - 1, int(tag), sides[tags == tag]) for tag in np.unique(tags)] + [(dim, 1, found)],
        version,
        binary=binary,
    )


def write_msh(
    path: Path,
    x: npt.NDArray[np.float64],
    blocks: list[tuple[int, int, Integers]],
    version: str,
    *,
    binary: bool,
) -> None:
    """Write nodes, and blocks of elements: dimension, entity and group, nodes from 0."""
    data = bytearray()

    def line(text: str = "") -> None:
        data.extend(text.encode() + b"\n")

    def put(kind: str, *values: float) -> None:
        if binary:
            data.extend(np.array(values, kind).tobytes())
        else:
            line(" ".join(map(repr, np.array(values).tolist())))

    line("$MeshFormat")
    line(f"{version} {int(binary)} 8")
    if binary:
        data.extend(np.array([1], "i4").tobytes())
        line()
    line("$EndMeshFormat")
    old = version == "2.2"
    count = sum(len(elements) for _, _, elements in blocks)
    line("$Nodes")
    if old:
        line(str(len(x)))
        for number, position in enumerate(x.tolist(), start=1):
            if binary:
                put("i4", number)
                put("f8", *position)
            else:
                line(f"{number} " + " ".join(map(repr, position)))
    else:
        put("i8", 1, len(x), 1, len(x))
        put("i4", 2, 1, 0)
        put("i8", len(x))
        for number in range(1, len(x) + 1):
            put("i8", number)
        for position in x:
            put("f8", *position)
    line("$EndNodes" if not binary else "\n$EndNodes")
    line("$Elements")
    if old:
        line(str(count))
    else:
        put("i8", len(blocks), count, 1, count)
    number = 0
    for dim, group, elements in blocks:
        kind = KIND[elements.shape[1]]
        if not old:
            put("i4", dim, group, kind)
            put("i8", len(elements))
        elif binary:
            put("i4", kind, len(elements), 2)
        for nodes in (elements + 1).tolist():
            number += 1
            if not old:
                put("i8", number, *nodes)
            elif binary:
                put("i4", number, group, group, *nodes)
            else:
                put("i4", number, kind, 2, group, group, *nodes)
    line("$EndElements" if not binary else "\n$EndElements")
    path.write_bytes(bytes(data))
