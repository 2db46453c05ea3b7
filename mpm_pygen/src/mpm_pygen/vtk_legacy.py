"""Legacy VTK files in ASCII, as mpm3d writes them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mpm_pygen.clouds import Cloud
from mpm_pygen.errors import PygenError
from mpm_pygen.shape import FloatArray

_TITLE = re.compile(rb"mpm3d .*: Frame (\d+), Time (\S+)")
_HEADER = re.compile(
    rb"^(?P<kind>POINTS|CELLS|CELL_TYPES|POINT_DATA|CELL_DATA|SCALARS|VECTORS|TENSORS)"
    rb"[ \t]+(?P<rest>[^\n]*)\n(?P<table>LOOKUP_TABLE[^\n]*\n)?",
    re.MULTILINE,
)
_SHAPES: dict[str, tuple[int, ...]] = {"SCALARS": (), "VECTORS": (3,), "TENSORS": (3, 3)}


@dataclass(frozen=True)
class _Block:
    """Where the numbers of a part are in the file."""

    kind: str
    words: list[str]
    start: int
    end: int


class _LazyFields(Mapping[str, FloatArray]):
    """Fields that are parsed when they are asked for."""

    def __init__(self, path: Path, data: bytes, blocks: dict[str, _Block], count: int) -> None:
        self._path, self._data, self._blocks, self._count = path, data, blocks, count
        self._parsed: dict[str, FloatArray] = {}

    def __getitem__(self, name: str) -> FloatArray:
        """Parse a field."""
        if name not in self._parsed:
            block = self._blocks[name]
            shape = (self._count, *_SHAPES[block.kind])
            self._parsed[name] = _numbers(self._path, self._data, block, shape)
        return self._parsed[name]

    def __iter__(self) -> Iterator[str]:
        """Give the names in the order of the file."""
        return iter(self._blocks)

    def __len__(self) -> int:
        """Count the fields."""
        return len(self._blocks)


def read_title(path: Path) -> float:
    """Read the time of a frame from its title line.

    Parameters
    ----------
    path : Path
        The file.
    """
    with open(path, "rb") as file:
        file.readline()
        match = _TITLE.match(file.readline())
    if match is None:
        raise PygenError(f"{path}: the second line does not tell the time of a frame of mpm3d")
    return float(match[2])


def read_legacy(path: Path) -> Cloud:
    """Read a file of points or nodes. Fields are parsed when they are asked for.

    Parameters
    ----------
    path : Path
        The file.
    """
    data = path.read_bytes()
    headers = list(_HEADER.finditer(data))
    blocks: dict[str, _Block] = {}
    points: _Block | None = None
    cell_size, in_points = 0, False
    for header, following in zip(headers, [*headers[1:], None], strict=True):
        end = following.start() if following else len(data)
        kind = header["kind"].decode()
        words = header["rest"].decode().split()
        block = _Block(kind, words, header.end(), end)
        if kind == "POINTS":
            points = block
        elif kind == "CELLS" and len(words) == 2 and int(words[0]) > 0:
            # All cells have one size: their table has that many numbers and the size itself.
            cell_size = int(words[1]) // int(words[0]) - 1
        elif kind in ("POINT_DATA", "CELL_DATA"):
            in_points = kind == "POINT_DATA"
        elif kind in _SHAPES and in_points and words:
            blocks[words[0]] = block
    if points is None or not points.words or not points.words[0].isdigit():
        raise PygenError(f"{path}: this is no legacy VTK file in ASCII with points")
    count = int(points.words[0])
    return Cloud(
        position=_numbers(path, data, points, (count, 3)),
        fields=_LazyFields(path, data, blocks, count),
        cell_size=cell_size,
    )


def _numbers(path: Path, data: bytes, block: _Block, shape: tuple[int, ...]) -> FloatArray:
    """Parse the numbers of a part."""
    text = data[block.start : block.end].decode("ascii", "replace")
    try:
        values = np.fromstring(text, dtype=float, sep=" ")
    except ValueError:
        values = np.empty(0)
    if values.size != int(np.prod(shape)):
        name = block.words[0] if block.kind in _SHAPES else block.kind
        raise PygenError(
            f"{path}: {name} has {values.size} numbers where {int(np.prod(shape))} are needed"
        )
    return values.reshape(shape)
