"""The scenes on meshes do what their READMEs say."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from frames import read_series
from scene import GRAVITY, Run
from test_flow_scenes import run_scene


def test_ramp_of_triangles(mpm3d: Run, tmp_path: Path) -> None:
    """A smooth wall pushes along its normal only: along the ramp the disc falls by g sin(theta)."""
    frames, _ = run_scene(mpm3d, "ramp_of_triangles", "disc", tmp_path)
    along = np.array([2.0, -1.0, 0.0]) / math.sqrt(5.0)
    across = np.array([1.0, 2.0, 0.0]) / math.sqrt(5.0)
    mass = frames[0].fields["mass"] / frames[0].fields["mass"].sum()
    assert len(frames) == 36
    for frame in frames:
        expected = GRAVITY / math.sqrt(5.0) * frame.time
        # Frames have ten digits.
        assert abs(mass @ frame.fields["velocity"] @ along - expected) <= 1e-9 * (1.0 + expected)
        # It stays at the ramp, within a dent and a bounce.
        assert abs(mass @ frame.fields["displacement"] @ across) < 0.02
        assert np.min((frame.positions - [0.0, 1.0, 0.0]) @ across) > 0.0


def test_tetrahedra(mpm3d: Run, tmp_path: Path) -> None:
    """The ball leaves more slowly than it came, along the mirror plane, and the block stays."""
    block, report = run_scene(mpm3d, "tetrahedra", "block", tmp_path)
    ball = read_series(tmp_path / "output" / "tetrahedra", "fpd", 1, "ball")
    velocity = ball[-1].fields["velocity"].mean(axis=0)
    assert 0.5 < velocity[2] < 2.0
    assert abs(velocity[0] - velocity[1]) < 1e-6
    assert abs(velocity[0]) < 0.1
    assert len(block[0].positions) == 64 * 6 * 7
    centre = block[-1].positions.mean(axis=0)
    assert np.all(np.abs(centre - [0.4, 0.4, 0.2]) < 0.02)
    # Nothing passes the floor.
    assert min(float(frame.positions[:, 2].min()) for frame in block) > 0.0
    assert "left the grid" not in report
