"""Points and their file: layout for each TYPE, round trip, refused files."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest

from mpm_pygen import (
    Points,
    PointsFileError,
    PygenError,
    SimulationType,
    read_points,
    write_points,
)

LAYOUT = {
    1: "1\n0.1 0.2 0.5 1.0 1\n",
    2: "1\n0.1 0.2 0.5 0.25 1.0 2.0 1\n",
    3: "1\n0.1 0.2 0.5 0.25 0.125 1.0 2.0 3.0 1\n",
    4: "1\n0.1 0.2 0.5 0.25 0 1.0 2.0 3.0 1\n",
    5: "1\n0.1 0.2 0.5 0.25 0 1.0 2.0 3.0 1\n",
}


def _one(sim_type: int) -> Points:
    """Make a single point with numbers that are easy to find again."""
    kind = SimulationType(sim_type)
    return Points(
        sim_type=kind,
        mass=np.array([0.1]),
        volume=np.array([0.2]),
        position=np.array([[0.5, 0.25, 0.125][: kind.dimension]]),
        velocity=np.array([[1.0, 2.0, 3.0][: kind.components]]),
        active=np.array([True]),
    )


def _random(kind: SimulationType, n: int) -> Points:
    """Make points with all digits in use and numbers of very different size."""
    rng = np.random.default_rng(7)
    return Points(
        sim_type=kind,
        mass=10.0 ** rng.uniform(-300.0, 300.0, n),
        volume=10.0 ** rng.uniform(-12.0, 12.0, n),
        position=rng.uniform(0.0, 1.0, (n, kind.dimension)) + 1e-3,
        velocity=rng.normal(size=(n, kind.components)),
        active=rng.uniform(size=n) < 0.5,
    )


def _columns(points: Points) -> list[bytes]:
    """Give the bits of everything that a file holds."""
    names = ("mass", "volume", "position", "velocity", "active")
    return [np.ascontiguousarray(getattr(points, name)).tobytes() for name in names]


@pytest.mark.parametrize("sim_type", LAYOUT)
def test_layout_of_each_type(tmp_path: Path, sim_type: int) -> None:
    """The file is this text, its columns are as many as the TYPE names."""
    write_points(tmp_path / "one.points", _one(sim_type))
    text = (tmp_path / "one.points").read_text()
    assert text == LAYOUT[sim_type]
    assert len(text.splitlines()[1].split()) == len(SimulationType(sim_type).columns)


@pytest.mark.parametrize("sim_type", list(SimulationType))
def test_round_trip_keeps_all_bits(tmp_path: Path, sim_type: SimulationType) -> None:
    """Written and read again: the same numbers in the same order."""
    points = _random(sim_type, 200)
    write_points(tmp_path / "random.points", points)
    found = read_points(tmp_path / "random.points", sim_type)
    assert found.sim_type is sim_type
    assert _columns(found) == _columns(points)


@pytest.mark.parametrize("sim_type", [4, 5])
def test_short_lines_are_read(tmp_path: Path, sim_type: int) -> None:
    """Types 4 and 5 may leave out the third component; white space is free."""
    path = tmp_path / "short.points"
    path.write_text(" 2 \r\n0.1\t0.2  0.5 0.25 1 2 1 \r\n0.1 0.2 0.5 0.25 0 1 2 3 0\n\n \n")
    points = read_points(path, sim_type)
    assert points.position.tolist() == [[0.5, 0.25]] * 2
    assert points.velocity.tolist() == [[1.0, 2.0, 0.0], [1.0, 2.0, 3.0]]
    assert points.active.tolist() == [True, False]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", 1, "number of points"),
        ("0\n", 1, "number of points"),
        ("1.5\n1 1 0 0 0 0 1\n", 1, "number of points"),
        ("-1\n1 1 0 0 0 0 1\n", 1, "number of points"),
        ("2\n1 1 0 0 0 0 1\n", 1, "2 points announced, 1 lines follow"),
        ("1\n1 1 0 0 0 0 1\n1 1 0 0 0 0 1\n", 1, "1 points announced, 2 lines follow"),
        ("2\n1 1 0 0 0 0 1\n1 1 0 0 0 0\n", 3, "7 columns"),
        ("1\n1 1 0 0 0 0 0 0 1\n", 2, "7 columns"),
        ("1\n1 1 0 word 0 0 1\n", 2, "'word' is not a number"),
        ("1\n1 1 0 nan 0 0 1\n", 2, "position .* not finite"),
        ("1\n1 1 0 0 inf 0 1\n", 2, "velocity .* not finite"),
        ("1\n-1 1 0 0 0 0 1\n", 2, "mass"),
        ("1\n1 0 0 0 0 0 1\n", 2, "volume"),
        ("1\nnan 1 0 0 0 0 1\n", 2, "mass"),
        ("1\n1 1 0 0 0 0 2\n", 2, "last column"),
    ],
)
def test_bad_files_are_refused_with_their_line(
    tmp_path: Path, text: str, line: int, words: str
) -> None:
    """The error names file and line."""
    path = tmp_path / "bad.points"
    path.write_text(text)
    with pytest.raises(PointsFileError, match=words) as caught:
        read_points(path, SimulationType.PLANE_STRAIN)
    assert caught.value.line == line
    assert str(caught.value).startswith(f"{path}:{line}: ")


def test_other_bad_files(tmp_path: Path) -> None:
    """A binary, a folder, a missing file, a point on the axis."""
    binary = tmp_path / "binary.points"
    binary.write_bytes(bytes(range(256)))
    with pytest.raises(PointsFileError, match="no text"):
        read_points(binary, 2)
    with pytest.raises(OSError, match="directory"):
        read_points(tmp_path, 2)
    with pytest.raises(FileNotFoundError):
        read_points(tmp_path / "missing.points", 2)
    axis = tmp_path / "axis.points"
    axis.write_text("1\n1 1 0 0 0 0 0 0 1\n")
    assert len(read_points(axis, 5)) == 1
    with pytest.raises(PointsFileError, match="r is above 0"):
        read_points(axis, 4)


def test_points_are_checked_when_made() -> None:
    """Wrong sizes and values are refused, with the number of the point."""
    good = _random(SimulationType.AXISYMMETRIC, 5)
    for name, words in (("mass", "mass"), ("volume", "volume"), ("velocity", "velocity")):
        values = getattr(good, name).copy()
        values[3] = np.nan
        with pytest.raises(PygenError, match=f"point 3: the {words}"):
            dataclasses.replace(good, **{name: values})
    position = good.position.copy()
    position[2, 0] = 0.0
    with pytest.raises(PygenError, match="point 2: r is above 0"):
        dataclasses.replace(good, position=position)
    with pytest.raises(PygenError, match="shape"):
        dataclasses.replace(good, velocity=good.velocity[:, :2])
    with pytest.raises(PygenError, match="at least one point"):
        dataclasses.replace(good, mass=np.array([]))


def test_a_failed_write_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When the file cannot be finished the old one stays and nothing else is left behind."""
    path = tmp_path / "kept.points"
    write_points(path, _one(2))

    def refuse(source: object, target: object) -> None:
        raise OSError("no room")

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(OSError, match="no room"):
        write_points(path, _one(1))
    assert path.read_text() == LAYOUT[2]
    assert os.listdir(tmp_path) == ["kept.points"]
