"""Frames of a run: legacy VTK files as the program writes them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
TITLE = re.compile(rb"Frame (\d+), Time (\S+)")
BLOCK = re.compile(
    rb"^(?:POINTS (?P<points>\d+) double"
    rb"|(?P<kind>SCALARS|VECTORS|TENSORS) (?P<name>\S+) double(?: 1\nLOOKUP_TABLE default)?"
    rb"|CELLS .*|CELL_TYPES .*|POINT_DATA .*)\n",
    re.MULTILINE,
)
COMPONENTS = {b"SCALARS": 1, b"VECTORS": 3, b"TENSORS": 9}


@dataclass
class Frame:
    """One file: points of a body, or nodes of the grid as a body sees it."""

    number: int
    time: float
    #: (n, 3)
    x: Array
    #: By name: (n,), (n, 3) or, tensors row by row, (n, 3, 3).
    fields: dict[str, Array]

    def __getitem__(self, name: str) -> Array:
        """Return a field."""
        return self.fields[name]


def read_frame(path: Path) -> Frame:
    """Read one file."""
    data = path.read_bytes()
    title = TITLE.search(data)
    if title is None:
        raise ValueError(f"{path}: no title with frame and time")
    blocks = list(BLOCK.finditer(data))
    x = np.empty((0, 3))
    fields: dict[str, Array] = {}
    ends = [match.start() for match in blocks[1:]] + [len(data)]
    for match, end in zip(blocks, ends, strict=True):
        if match["points"] is None and match["kind"] is None:
            continue
        values = np.fromstring(data[match.end() : end].decode(), sep=" ")
        if match["points"] is not None:
            x = values.reshape(-1, 3)
        else:
            shape = {1: (-1,), 3: (-1, 3), 9: (-1, 3, 3)}[COMPONENTS[match["kind"]]]
            fields[match["name"].decode()] = values.reshape(shape)
    return Frame(int(title[1]), float(title[2]), x, fields)


class Series:
    """The frames of one body, read one by one when they are asked for."""

    def __init__(self, folder: Path, kind: str, body: int, name: str) -> None:
        self.paths = sorted(folder.glob(f"{kind}.{body}.{name}.*.vtk"))

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.paths)

    def __getitem__(self, index: int) -> Frame:
        """Return a frame; -1 is the last one."""
        return read_frame(self.paths[index])

    def __iter__(self) -> Iterator[Frame]:
        """Read all frames in their order."""
        return map(read_frame, self.paths)
