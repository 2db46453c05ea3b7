"""Frames of made-up runs, in the format of mpm3d."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def square_body(
    corner: Sequence[float], count: int, side: float, velocity: Sequence[float] = (0, 0, 0)
) -> dict[str, Array]:
    """Make a square or cube of points with the fields that are mostly drawn."""
    dimension = len(corner)
    axes = [corner[k] + side * (np.arange(count) + 0.5) for k in range(dimension)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, dimension)
    n = len(grid)
    position = np.zeros((n, 3))
    position[:, :dimension] = grid
    return {
        "position": position,
        "mass": np.full(n, 1000.0 * side**dimension),
        "volume": np.full(n, side**dimension),
        "velocity": np.tile(np.array(velocity, dtype=float), (n, 1)),
        "active": np.ones(n),
    }


def write_frame(
    folder: Path,
    number: int,
    time: float,
    bodies: Mapping[str, Mapping[str, Array]],
    cells: Sequence[int] = (),
) -> None:
    """Write the points of bodies, and nodes of a unit box when it has cells."""
    folder.mkdir(parents=True, exist_ok=True)
    title = f"mpm3d made up: Frame {number}, Time {time!r}"
    for k, (name, fields) in enumerate(bodies.items()):
        x = fields["position"]
        rest = {key: value for key, value in fields.items() if key != "position"}
        ends = [[1, i] for i in range(len(x))]
        path = folder / f"fpd.{k}.{name}.{number:010d}.vtk"
        path.write_text(_text(title, x, ends, 1, rest))
        if cells:
            nodes, quads, kind = _grid(cells)
            force = {"contact_force_by_a_on_b": np.ones((len(nodes), 3)) * (k + 1)}
            path = folder / f"fnd.{k}.{name}.{number:010d}.vtk"
            path.write_text(_text(title, nodes, quads, kind, force if k == 0 else {}))


def _grid(cells: Sequence[int]) -> tuple[Array, list[list[int]], int]:
    """Make nodes and cells of a unit box; of the cells only that of one node each is told."""
    axes = [np.linspace(0.0, 1.0, n + 1) for n in cells]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(cells))
    nodes = np.zeros((len(grid), 3))
    nodes[:, : len(cells)] = grid
    size = 2 ** len(cells)
    return nodes, [[size, *range(size)]], {1: 3, 2: 9, 3: 12}[len(cells)]


def _text(
    title: str, x: Array, cells: list[list[int]], kind: int, fields: Mapping[str, Array]
) -> str:
    """Write a legacy file."""
    lines = ["# vtk DataFile Version 3.0", title, "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {len(x)} double", *_rows(x)]
    lines += [f"CELLS {len(cells)} {sum(map(len, cells))}"]
    lines += [" ".join(map(str, cell)) for cell in cells]
    lines += [f"CELL_TYPES {len(cells)}", *[str(kind)] * len(cells), f"POINT_DATA {len(x)}"]
    for name, values in fields.items():
        if values.ndim == 1:
            lines += [f"SCALARS {name} double 1", "LOOKUP_TABLE default"]
        else:
            lines.append(f"{'VECTORS' if values.ndim == 2 else 'TENSORS'} {name} double")
        lines += _rows(values)
    return "\n".join(lines) + "\n"


def _rows(values: Array) -> list[str]:
    """Write numbers with all digits, three a line at most."""
    table = values.reshape(-1, 1 if values.ndim == 1 else 3)
    return [" ".join(map(repr, row)) for row in table.tolist()]
