"""Standing wave in a bar with one free end."""

from __future__ import annotations

import numpy as np
from _modes import judge_mode, measure_mode, mode_scene
from _waves import FREE, LENGTH, Bar
from harness.case import Case, Finding, Measures, Output, Parameters, Results
from harness.scene import Scene


def wave_number(p: Parameters) -> float:
    """Return k of mode `mode`: an odd number of quarter waves."""
    return (2.0 * p.number("mode", 1.0) - 1.0) * np.pi / (2.0 * LENGTH)


def scene(p: Parameters) -> Scene:
    """Return a bar on a wall, its upper end free on a grid line."""
    return mode_scene(p, Bar(p, end=FREE), wave_number(p))


def measure(p: Parameters, out: Output) -> Measures:
    """Return the errors."""
    return measure_mode(p, out, wave_number(p), FREE)


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    return judge_mode(r, wave_number, FREE)


CASE = Case(
    family="Axial bar",
    title="Standing wave in a bar with one free end",
    statement=r"""
As the standing wave between two walls, but the end $X = L$ is free and $k = \pi/(2L)$. The end lies
on a grid line; a row of empty cells lies beyond it.

Expected: the wave is even about a free end, and so are the discrete equations there, where the last
node has half a mass and half a force. So all orders and constants are those of the bar between two
walls.
""",
    source="Elementary. Discrete equations: `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    error="e_u_l2",
    order=2.0,
)
