"""A driven wheel that slips on the ground."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from frames import Frame, read_frame
from scene import Run

ROOT = Path(__file__).resolve().parents[2]
FRICTION, GRAVITY, SPIN = 0.3, 9.81, -20.0


@pytest.fixture(scope="module")
def wheel(mpm3d: Run, tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    """Return the frames of the wheel of configs/driven_wheel."""
    folder = tmp_path_factory.mktemp("project")
    for name in ("configs/driven_wheel", "mpm_pygen"):
        shutil.copytree(ROOT / name, folder / name)
    subprocess.run(
        ["bash", folder / "configs/driven_wheel/make_points.sh"],
        env={**os.environ, "PYTHON": sys.executable},
        capture_output=True,
        check=True,
    )
    result = mpm3d("-c", "configs/driven_wheel/driven_wheel.cfg", "--threads", "1", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    paths = sorted((folder / "output/driven_wheel").glob("fpd.0.wheel.*.vtk"))
    return [read_frame(path) for path in paths]


def mean_velocity(frame: Frame) -> np.ndarray:
    """Return the velocity of the centre of mass."""
    return np.average(frame.fields["velocity"], axis=0, weights=frame.fields["mass"])


def test_friction_accelerates_it(wheel: list[Frame]) -> None:
    """While the wheel slips, Coulomb's law ties the impulses: v_x = mu (g t + v_y).

    Both sides are sums over the same contact, whose normals are vertical but for the shape of the
    wheel over the half of a cell that it sinks in: sqrt(h/R)/2 = 0.25 rad at the rims of the
    contact, of either sign. Its square, 3 % at the most, bounds the difference.
    """
    late = [frame for frame in wheel if frame.time > 0.2]
    assert len(late) > 15
    for frame in late:
        v = mean_velocity(frame)
        assert v[0] == pytest.approx(FRICTION * (GRAVITY * frame.time + v[1]), rel=0.03)
    assert mean_velocity(wheel[-1])[0] < -0.2 * SPIN


def test_it_keeps_spinning(wheel: list[Frame]) -> None:
    """The angular velocity is that of the drive, less what friction takes in a step.

    mu N R dt/I with I = m R^2/2 and N of a few m g, 0.3 * 9.81 * 2e-4/0.1 * few < 0.03 rad/s.
    """
    for frame in wheel[1:]:
        mass, x, v = frame.fields["mass"], frame.positions, frame.fields["velocity"]
        arm = x - np.average(x, axis=0, weights=mass)
        turn = np.sum(mass * (arm[:, 0] * v[:, 1] - arm[:, 1] * v[:, 0]))
        assert turn / np.sum(mass * np.sum(arm**2, axis=1)) == pytest.approx(SPIN, abs=0.03)
