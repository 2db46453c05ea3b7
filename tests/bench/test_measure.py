"""Runs of programs and what is read from their output."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from bench.measure import BenchError, frames_share, phases, run, spread, stated_memory
from bench.scenes import SCENE, Case

TEXT = """memory:  44.4 MB for points and nodes
running 30 steps on 1 thread
frame 0 at t = 0 s, step 0
frames: 1 in frames (24.8 MB)
phase       seconds   share   ns per point and step
set-up        0.243
sort          0.025   3.5 %      3.50
P2G           0.191  26.6 %     26.75
output       10.141 100.0 %     19.72
"""


def test_a_run_tells_its_memory_and_time(tmp_path: Path) -> None:
    """A process that holds 100 MB for a while is seen to."""
    held = "block = bytearray(100_000_000); import time; time.sleep(0.1); print(len(block))"
    cost = run([sys.executable, "-c", held], tmp_path)
    assert cost.text == "100000000\n"
    assert 100_000_000 < cost.memory < 200_000_000
    assert 0.1 <= cost.wall < 10.0
    assert 0.0 < cost.cpu < cost.wall


def test_a_run_that_fails_is_told(tmp_path: Path) -> None:
    """The status and the text of the program are in the error."""
    with pytest.raises(BenchError, match="ended with 3:\nno"):
        run([sys.executable, "-c", "print('no'); raise SystemExit(3)"], tmp_path)


def test_phases_are_read() -> None:
    """Set-up has no share, and no other line is taken for a phase."""
    assert phases(TEXT) == {"set-up": 0.243, "sort": 0.025, "P2G": 0.191, "output": 10.141}


def test_share_of_frames(tmp_path: Path) -> None:
    """Between two frames, 1/60 s apart, are 1/60 s/dt steps of 0.216 s/30 each."""
    case = Case(SCENE["3d-linear"], tmp_path, 1000, 1e-4)
    between = 0.216 / 30 / (60.0 * 1e-4)
    assert frames_share(TEXT, case, 30) == pytest.approx(10.141 / (10.141 + between))
    assert frames_share(TEXT.replace("10.141", "0.000"), case, 30) == 0.0


def test_stated_memory_is_read() -> None:
    """In bytes; 0 when nothing is stated."""
    assert stated_memory(TEXT) == pytest.approx(44.4e6)
    assert stated_memory("") == 0.0


def test_spread() -> None:
    """Median and range of samples."""
    assert spread([3.0, 1.0, 9.0]) == {"median": 3.0, "min": 1.0, "max": 9.0}
