"""A run that is killed leaves whole frames, and at most one file of a temporary name."""

from __future__ import annotations

import re
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from frames import NAME, read_frame
from scene import Body, Scene, block

TEMPORARY = re.compile(r"(fpd|fnd)\.0\.cube\.\d{10}\.vtk\.tmp\d+")


@pytest.mark.parametrize("wait", [0.0, 0.01, 0.03, 0.07])
def test_killed_run(executable: Path, tmp_path: Path, wait: float) -> None:
    """Whatever the moment, every file with the name of a frame can be read to its end."""
    rows = block(3, [0.2] * 3, [0.8] * 3, [12] * 3)
    # A frame each step: nearly all time is spent on writing.
    scene = Scene(
        3,
        lengths=[1.0] * 3,
        cells=[20] * 3,
        bodies=[Body("cube", rows)],
        dt=1e-4,
        t_stop=1e3,
        rate=1e4,
        digits=15,
    )
    scene.write(tmp_path)
    frames = tmp_path / "frames"
    with subprocess.Popen(
        [executable, "-c", "scene.cfg", "-q"], cwd=tmp_path, stderr=subprocess.PIPE
    ) as process:
        deadline = time.monotonic() + 60.0
        while not list(frames.glob("fpd.*.0000000002.vtk")):
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.001)
        time.sleep(wait)
        process.send_signal(signal.SIGKILL)
        process.wait()

    names = sorted(path.name for path in frames.glob("*.vtk*"))
    whole = [name for name in names if NAME.fullmatch(name)]
    rest = [name for name in names if not NAME.fullmatch(name)]
    assert len(whole) >= 5
    assert len(rest) <= 1
    assert all(TEMPORARY.fullmatch(name) for name in rest)
    for name in whole[:1] + whole[-1:] + [n for n in whole if n.startswith("fpd")][-1:]:
        frame = read_frame(frames / name)
        # The last field of each file is there, and full.
        values = frame.fields["density" if name.startswith("fpd") else "active"]
        assert len(values) == (len(rows) if name.startswith("fpd") else 21**3)
        assert np.all(np.isfinite(values))
