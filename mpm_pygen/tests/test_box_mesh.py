"""Meshes of boxes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mpm_pygen.box_mesh import write_box_mesh
from mpm_pygen.cli import main
from mpm_pygen.errors import PygenError


def _read(path: Path) -> tuple[np.ndarray, dict[tuple[int, int], np.ndarray]]:
    """Read the nodes, and the elements by dimension and tag."""
    words = path.read_text().split()
    start = words.index("$Nodes") + 1
    n = int(words[start + 1])
    x = np.array(words[start + 8 + n : start + 8 + 4 * n], float).reshape(n, 3)
    at = words.index("$Elements") + 5
    found = {}
    for _ in range(int(words[words.index("$Elements") + 1])):
        dim, tag, kind, count = map(int, words[at : at + 4])
        width = {1: 3, 2: 4, 4: 5}[kind]
        rows = np.array(words[at + 4 : at + 4 + width * count], int).reshape(count, width)
        found[dim, tag] = rows[:, 1:] - 1
        at += 4 + width * count
    assert words[at] == "$EndElements"
    return x, found


@pytest.mark.parametrize("dim", [2, 3])
def test_cells_fill_the_box(tmp_path: Path, dim: int) -> None:
    """Volumes sum to that of the box, and sides lie where their tags say."""
    lower, upper, cells = [0.5, -1.0, 2.0][:dim], [1.5, 1.0, 2.5][:dim], [2, 3, 1][:dim]
    path = tmp_path / "box.msh"
    n = write_box_mesh(path, lower, upper, cells)
    x, found = _read(path)
    assert n == len(found[dim, 1]) == {2: 12, 3: 36}[dim]
    corners = x[found[dim, 1]][:, :, :dim]
    volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / {2: 2, 3: 6}[dim]
    assert volumes.sum() == pytest.approx(np.prod(np.subtract(upper, lower)))
    assert volumes.min() > 0
    for d in range(dim):
        for end, value in enumerate((lower[d], upper[d])):
            assert np.all(x[found[dim - 1, 1 + 2 * d + end]][:, :, d] == value)


def test_map(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nodes are moved by expressions."""
    path = tmp_path / "slope.msh"
    words = ["box-mesh", "--min", "0", "0", "--max", "2", "1", "--cells", "4", "2"]
    assert main([*words, "--map", "x", "y - 0.5*x", "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}: 16 triangles\n"
    x, found = _read(path)
    floor = x[found[1, 3]]
    assert np.allclose(floor[:, :, 1], -0.5 * floor[:, :, 0])


@pytest.mark.parametrize(
    ("lower", "upper", "cells", "image"),
    [
        ([0.0], [1.0], [2], []),
        ([0.0, 0.0], [1.0, 1.0], [2, 0], []),
        ([0.0, 0.0], [1.0, 0.0], [2, 2], []),
        ([0.0, 0.0], [1.0, 1.0], [2, 2], ["x"]),
        ([0.0, 0.0], [1.0, 1.0], [2, 2], ["x", "log(y)"]),
        ([0.0, 0.0], [1.0, 1.0], [9999, 9999], []),
    ],
)
def test_bad_input(
    tmp_path: Path, lower: list[float], upper: list[float], cells: list[int], image: list[str]
) -> None:
    """Nothing is written."""
    with pytest.raises(PygenError):
        write_box_mesh(tmp_path / "box.msh", lower, upper, cells, image)
    assert not list(tmp_path.iterdir())
