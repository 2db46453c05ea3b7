"""Times of frames: each holds the state at the time in its title."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frames import read_series
from scene import EPSILON, GRAVITY, ROUNDING, Run, drop_scene, run_scene


def test_times_between_steps(mpm3d: Run, tmp_path: Path) -> None:
    """A frame is the first state at or after a multiple of 1/rate, labelled with its own time."""
    dt, rate = 1e-3, 300.0
    run_scene(mpm3d, drop_scene(dt=dt, rate=rate, t_start=-0.002, t_stop=0.02), tmp_path)
    for kind in ("fpd", "fnd"):
        times = [frame.time for frame in read_series(tmp_path / "frames", kind, 0, "drop")]
        # 22 ms hold 6.6 intervals of 10/3 ms.
        assert len(times) == 7
        for k, time in enumerate(times):
            steps = int(np.ceil(k / rate / dt - 1e-9))
            assert time == pytest.approx(-0.002 + steps * dt, rel=0.0, abs=4 * EPSILON * 0.02)


def test_times_on_steps(mpm3d: Run, tmp_path: Path) -> None:
    """Frames at multiples of dt miss no step to rounding, and the last is at the stop time."""
    run_scene(mpm3d, drop_scene(dt=1e-4, rate=1000.0, t_stop=0.03), tmp_path)
    series = read_series(tmp_path / "frames", "fpd", 0, "drop")
    assert len(series) == 31
    for k, frame in enumerate(series):
        assert frame.time == pytest.approx(k / 1000.0, rel=4 * EPSILON)
    assert series[-1].time == 0.03


def test_state_belongs_to_its_label(mpm3d: Run, tmp_path: Path) -> None:
    """A frame labelled t holds the state at t: n steps of free fall after n dt."""
    dt = 1e-3
    run_scene(mpm3d, drop_scene(dt=dt, rate=1000.0, t_stop=0.01), tmp_path)
    for n, frame in enumerate(read_series(tmp_path / "frames", "fpd", 0, "drop")):
        speed = GRAVITY * n * dt
        assert np.allclose(frame.fields["velocity"][:, 1], -speed, rtol=10 * ROUNDING, atol=0.0)


def test_last_step_is_shortened(mpm3d: Run, tmp_path: Path) -> None:
    """A run ends at the stop time, with a shorter last step when dt does not divide the span."""
    dt, steps, rest = 1e-3, 10, 4e-4
    t_stop = steps * dt + rest
    run_scene(mpm3d, drop_scene(dt=dt, rate=1.0 / t_stop, t_stop=t_stop), tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "drop")[-1]
    assert last.number == 1
    assert last.time == t_stop
    mass = last.fields["mass"]
    fall = GRAVITY * (dt**2 * steps * (steps + 1) / 2 + rest * t_stop)
    moved = mass @ last.fields["displacement"][:, 1] / mass.sum()
    assert moved == pytest.approx(-fall, rel=11 * ROUNDING)


def test_stop_time_within_one_step(mpm3d: Run, tmp_path: Path) -> None:
    """A span shorter than dt is one short step."""
    result = run_scene(mpm3d, drop_scene(dt=1e-3, rate=1e4, t_stop=1e-4), tmp_path)
    assert "done: 1 steps" in result.stdout or "done: 1 step " in result.stdout
    assert [f.time for f in read_series(tmp_path / "frames", "fpd", 0, "drop")] == [0.0, 1e-4]


def test_rate_above_the_steps(mpm3d: Run, tmp_path: Path) -> None:
    """There is at most one frame a step."""
    run_scene(mpm3d, drop_scene(dt=1e-3, rate=1e5, t_stop=0.005), tmp_path)
    times = [frame.time for frame in read_series(tmp_path / "frames", "fpd", 0, "drop")]
    assert times == pytest.approx([0.0, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3], rel=4 * EPSILON)


def test_rate_0(mpm3d: Run, tmp_path: Path) -> None:
    """Rate 0 writes the initial state only."""
    run_scene(mpm3d, drop_scene(rate=0.0), tmp_path)
    names = sorted(path.name for path in (tmp_path / "frames").glob("*.vtk"))
    assert names == ["fnd.0.drop.0000000000.vtk", "fpd.0.drop.0000000000.vtk"]
