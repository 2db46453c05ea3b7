"""Frames, read with VTK's reader of legacy files."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader

Array = npt.NDArray[np.float64]
NAME = re.compile(r"(fpd|fnd)\.(\d+)\.(.+)\.(\d{10})\.vtk")
TITLE = re.compile(r"mpm3d \w+: Frame (\d+), Time (\S+)")
FIELD = re.compile(r"^(?:SCALARS|VECTORS|TENSORS) (\S+) double", re.MULTILINE)


@dataclass
class Frame:
    """The content of one file."""

    #: Number and time of the title line.
    number: int
    time: float
    #: (n, 3)
    positions: Array
    #: VTK cell types, and the nodes of each cell.
    cell_types: list[int]
    cells: list[list[int]]
    #: By name: (n), (n, 3) or, tensors row by row, (n, 9).
    fields: dict[str, Array]


def read_frame(path: Path) -> Frame:
    """Read a file; any complaint of the reader fails the test."""
    complaints: list[str] = []
    reader = vtkUnstructuredGridReader()
    reader.AddObserver("ErrorEvent", lambda _reader, event: complaints.append(event))
    reader.AddObserver("WarningEvent", lambda _reader, event: complaints.append(event))
    reader.SetFileName(str(path))
    reader.ReadAllScalarsOn()
    reader.ReadAllVectorsOn()
    reader.ReadAllTensorsOn()
    reader.Update()
    assert not complaints, f"{path}: {complaints}"
    grid, title = reader.GetOutput(), TITLE.fullmatch(reader.GetHeader())
    assert title, reader.GetHeader()
    data = grid.GetPointData()
    names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
    types, cells = [], []
    for i in range(grid.GetNumberOfCells()):
        types.append(grid.GetCellType(i))
        ids = grid.GetCell(i).GetPointIds()
        cells.append([ids.GetId(k) for k in range(ids.GetNumberOfIds())])
    return Frame(
        number=int(title[1]),
        time=float(title[2]),
        positions=vtk_to_numpy(grid.GetPoints().GetData()).copy(),
        cell_types=types,
        cells=cells,
        fields={name: vtk_to_numpy(data.GetArray(name)).copy() for name in names},
    )


def field_names(path: Path) -> list[str]:
    """Return the names of the fields in the order of the file."""
    return FIELD.findall(path.read_text())


def frame_path(folder: Path, kind: str, body: int, name: str, number: int) -> Path:
    """Return the path of a frame; kind is fpd (points) or fnd (nodes)."""
    return folder / f"{kind}.{body}.{name}.{number:010d}.vtk"


def read_series(folder: Path, kind: str, body: int, name: str) -> list[Frame]:
    """Read all frames of one body, which must be numbered without a gap."""
    paths = sorted(folder.glob(f"{kind}.{body}.{name}.*.vtk"))
    assert paths, f"no frames {kind}.{body}.{name} in {folder}"
    series = [read_frame(path) for path in paths]
    assert [frame.number for frame in series] == list(range(len(series)))
    assert paths == [frame_path(folder, kind, body, name, i) for i in range(len(paths))]
    return series
