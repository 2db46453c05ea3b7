"""The scenes of walls with friction, of plates and of contacts have their closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from frames import Frame, read_series
from project_scene import run_config
from scene import EPSILON, Array, Run

GRAVITY = 9.81


def mean(frame: Frame, field: str = "velocity") -> Array:
    """Return the mean of a field of the points by mass."""
    values = frame.positions if field == "position" else frame.fields[field]
    return np.average(values, axis=0, weights=frame.fields["mass"])


def test_frictional_slope(mpm3d: Run, tmp_path: Path) -> None:
    """The block stops after v0^2/(2 g (mu cos a - sin a)) and stays."""
    folder, _ = run_config(mpm3d, "frictional_slope", tmp_path)
    frames = read_series(folder, "fpd", 0, "block")
    friction, start = 0.6, 1.0
    down, normal = GRAVITY * math.sin(math.radians(20)), GRAVITY * math.cos(math.radians(20))
    braking = friction * normal - down
    stop_time, way = start / braking, 0.5 * start**2 / braking
    # J_t = mu J_n in each step of sliding, at which it rounds, and gravity has 13 digits.
    steps = stop_time / 2e-4
    for frame in frames:
        if frame.time > 0.75 * stop_time:
            break
        v = mean(frame)
        impulse = start + down * frame.time - v[0]
        assert impulse == pytest.approx(
            friction * (normal * frame.time + v[1]), abs=64 * steps * EPSILON + 1e-11
        )
    place = [mean(frame, "position")[0] for frame in frames]
    # The base stops node by node, at most two heights of shear waves (2 h/c_s = 0.015 s) apart,
    # in which the block moves by braking t^2/2; bounces take as much. Together 2 %.
    assert place[-1] - place[0] == pytest.approx(way, rel=0.02)
    late = [x for frame, x in zip(frames, place, strict=True) if frame.time > 1.2 * stop_time]
    assert len(late) > 10
    assert max(late) - min(late) < 1e-3 * way
    # It touches the floor, and does not sink into it.
    assert np.min(frames[-1].positions[:, 1]) > 0.0
