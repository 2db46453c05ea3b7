"""The reader of frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from harness.frames import Series, read_frame

TEXT = """# vtk DataFile Version 2.0
verification: Frame {number}, Time {time}
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 2 double
0.25 0.5 0
7.5000000000000000E-01 0.5 0
CELLS 2 4
1 0
1 1
CELL_TYPES 2
1
1
POINT_DATA 2
SCALARS mass double 1
LOOKUP_TABLE default
1.5
2.5
VECTORS velocity double
1 2 3
-4 5E-1 6
TENSORS cauchy_stress double
1 2 3
4 5 6
7 8 9

9 8 7
6 5 4
3 2 1

"""


def test_positions_and_fields(tmp_path: Path) -> None:
    """Scalars, vectors and tensors, row by row."""
    path = tmp_path / "frame.vtk"
    path.write_text(TEXT.format(number=3, time="1.25E-01"))
    frame = read_frame(path)
    assert (frame.number, frame.time) == (3, 0.125)
    assert frame.x.tolist() == [[0.25, 0.5, 0.0], [0.75, 0.5, 0.0]]
    assert set(frame.fields) == {"mass", "velocity", "cauchy_stress"}
    assert frame["mass"].tolist() == [1.5, 2.5]
    assert frame["velocity"].tolist() == [[1.0, 2.0, 3.0], [-4.0, 0.5, 6.0]]
    assert frame["cauchy_stress"].shape == (2, 3, 3)
    assert frame["cauchy_stress"][0].tolist() == np.arange(1.0, 10.0).reshape(3, 3).tolist()
    assert frame["cauchy_stress"][1, 0].tolist() == [9.0, 8.0, 7.0]


def test_frame_without_title_is_refused(tmp_path: Path) -> None:
    """The message names the file."""
    path = tmp_path / "frame.vtk"
    path.write_text("# vtk DataFile Version 2.0\nnothing\nASCII\n")
    with pytest.raises(ValueError, match=r"frame\.vtk: no title"):
        read_frame(path)


def test_series_has_the_frames_of_one_body_in_their_order(tmp_path: Path) -> None:
    """Nodes and other bodies do not count."""
    for number in (10, 2, 0):
        path = tmp_path / f"fpd.0.bar.{number:010d}.vtk"
        path.write_text(TEXT.format(number=number, time=0.5 * number))
    (tmp_path / "fnd.0.bar.0000000000.vtk").write_text("")
    (tmp_path / "fpd.1.other.0000000000.vtk").write_text("")
    series = Series(tmp_path, "fpd", 0, "bar")
    assert len(series) == 3
    assert [frame.number for frame in series] == [0, 2, 10]
    assert series[-1].time == 5.0
