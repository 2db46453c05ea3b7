"""Scenes of the bench suite."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.scenes import SCENE, SCENES, split, write_scene
from mpm_pygen import SimulationType, read_points


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_points_lie_in_the_box(scene, tmp_path: Path) -> None:
    """Every body has points, all of them inside, and together about as many as asked for."""
    case = write_scene(scene, tmp_path, 1000)
    total = 0
    for body in range(scene.bodies):
        points = read_points(tmp_path / f"block_{body}.points", SimulationType(scene.sim_type))
        dim = points.sim_type.dimension
        assert points.position[:, :dim].min() > 0.0
        assert points.position[:, :dim].max() < 1.0
        total += len(points)
    assert total == case.points
    assert 500 <= total <= 1500


def test_two_bodies_meet_in_a_plane(tmp_path: Path) -> None:
    """The lower half ends where the upper one begins, and the upper one falls on it."""
    write_scene(SCENE["3d-contact"], tmp_path, 4000)
    low, high = (read_points(tmp_path / f"block_{i}.points", SimulationType(3)) for i in (0, 1))
    gap = high.position[:, 2].min() - low.position[:, 2].max()
    spacing = low.volume[0] ** (1.0 / 3.0)
    assert gap == pytest.approx(spacing)
    assert high.velocity[0, 2] < low.velocity[0, 2]


def test_one_body_is_not_cut() -> None:
    """The whole block comes back."""
    assert split([0.1], [0.9], 1, 0.1) == [([0.1], [0.9])]


def test_the_sparse_scene_fills_little_of_its_grid(tmp_path: Path) -> None:
    """The block of the sparse scene has 32**3 of 1024**3 cells at 262,144 points."""
    case = write_scene(SCENE["3d-sparse"], tmp_path, 64)
    assert "int-properties = {1024, 1024, 1024}" in (tmp_path / "bench.cfg").read_text()
    points = read_points(tmp_path / "block_0.points", SimulationType(3))
    assert case.points == 64
    assert max(points.position.max(axis=0) - points.position.min(axis=0)) < 4.0 / 1024
