"""AdaptiveDriver and QuasiStaticDriver: frames at exact times, steps of the state, settling."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from frames import read_series
from scene import (
    DIM,
    EPSILON,
    GRAVITY,
    NVEL,
    ROUNDING,
    TYPES,
    UP,
    Body,
    Run,
    Scene,
    block,
    drop_scene,
    run_scene,
)

BOX = 'boundary-class = "CartesianBox"\n'
HUGHES_WINGET = '    material-str-props = {rate = "hughes_winget"}'
SOLVER = 'solver { class = "ExplicitUSLwithVolumetricStrainSmoothing" }\n'
#: Two points a cell and direction: c dt <= h/sqrt(1.75).
COURANT = 1.0 / np.sqrt(1.75)


def driver(name: str, t_stop: float, gravity: list[float], *others: str, kinetic: int = 0) -> str:
    """Return a section driver."""
    reals = ", ".join([repr(t_stop), *map(repr, gravity), *others])
    integers = "int-properties = {1}" if kinetic else ""
    return f'driver\n{{\n    class = "{name}"\n    properties = {{{reals}}}\n    {integers}\n}}\n'


def test_frames_at_exact_times(mpm3d: Run, tmp_path: Path) -> None:
    """Frames hold the states at multiples of 1/rate, whatever the steps."""
    rate, t_stop = 70.0, 0.1
    section = driver("AdaptiveDriver", t_stop, [0.0, -GRAVITY])
    result = run_scene(mpm3d, drop_scene(dt=0.05, rate=rate, driver=section), tmp_path)
    assert re.search(
        r"^time:    t = 0 to 0.1 s, dt at most 0.05 s, about \d+ steps$", result.stdout, re.M
    )
    assert re.search(r"^running about \d+ steps on 1 thread$", result.stdout, re.M)
    series = read_series(tmp_path / "frames", "fpd", 0, "drop")
    assert [frame.time for frame in series] == [k / rate for k in range(7)] + [t_stop]
    for frame in series:
        # The increments of the velocity are g dt: g t for whatever steps, each with its roundings.
        speed = frame.fields["velocity"][:, 1]
        assert np.allclose(speed, -GRAVITY * frame.time, rtol=100 * ROUNDING, atol=0.0)


def test_steps_of_the_stable_length(mpm3d: Run, tmp_path: Path) -> None:
    """The number of steps is that of cfl times the limit of waves and points together."""
    body = Body("drop", block(2, [0.4, 0.4], [0.6, 0.6], [4, 4], velocity=[2.0, 0.0]))
    limit = COURANT * 0.1 / body.wave_speed()
    step = 0.5 / (1.0 / limit + 2.0 / 0.1)
    section = driver("AdaptiveDriver", 0.1, [0.0, 0.0])
    scene = drop_scene(bodies=[body], dt=1.0, driver=section)
    check = tmp_path / "check"
    scene.write(check)
    report = mpm3d("-c", "scene.cfg", "--check", cwd=check)
    assert (report.returncode, report.stderr) == (0, "")
    assert "BELOW" not in report.stdout
    steps = int(np.ceil(0.1 / step))
    assert f"about {steps} steps" in report.stdout
    result = run_scene(mpm3d, scene, tmp_path)
    assert f"done: {steps} steps to t = 0.1 s" in result.stdout


def test_same_bits_with_two_threads(mpm3d: Run, tmp_path: Path) -> None:
    """Steps, damping and smoothed volumes do not depend on the number of threads."""
    rows = block(2, [0.0, 0.0], [0.5, 0.5], [100, 100])
    body = Body("block", rows, more=BOX + HUGHES_WINGET)
    section = driver(
        "QuasiStaticDriver", 0.01, [3.0, -GRAVITY], "cfl = 0.5", "viscous = 9", kinetic=1
    )
    scene = Scene(
        2, [1.0, 1.0], [100, 100], [body], 0.01, rate=100.0, driver=section, solver=SOLVER
    )
    states = []
    for threads in (1, 2):
        folder = tmp_path / str(threads)
        run_scene(mpm3d, scene, folder, "--threads", str(threads))
        states.append((folder / "frames" / "fpd.0.block.0000000001.vtk").read_bytes())
    assert states[0] == states[1]


@pytest.mark.parametrize("sim_type", TYPES)
@pytest.mark.parametrize("damping", ["viscous", "kinetic"])
def test_column_settles(mpm3d: Run, tmp_path: Path, sim_type: int, damping: str) -> None:
    """A column between rollers comes to rest with the stress -rho g (H - y)."""
    dim, up, height, cells = DIM[sim_type], UP[sim_type], 1.0, 8
    upper = [0.25] * dim
    upper[up] = height
    counts = [4] * dim
    counts[up] = 2 * cells
    density = 1000.0
    rows = block(sim_type, [0.0] * dim, upper, counts, density=density)
    body = Body("column", rows, more='boundary-class = "CartesianSmoothBox"', modulus=1e7)
    lengths, boxes = [0.25] * dim, [2] * dim
    lengths[up], boxes[up] = 1.25 * height, 10
    slowest = np.pi * body.wave_speed() / (2.0 * height)
    gravity = [0.0] * NVEL[sim_type]
    gravity[up] = -GRAVITY
    t_stop = 16.0 / slowest
    others = ["cfl = 0.5", f"viscous = {2.0 * slowest!r}"]
    if damping == "kinetic":
        others = others[:1]
    section = driver(
        "QuasiStaticDriver", t_stop, gravity, *others, kinetic=int(damping == "kinetic")
    )
    scene = Scene(
        sim_type, lengths, boxes, [body], t_stop, dt=1.0, rate=1.0 / t_stop, driver=section
    )
    run_scene(mpm3d, scene, tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "column")[-1]
    stress = last.fields["cauchy_stress"].reshape(-1, 3, 3)[:, up, up]
    # Points of a layer of cells share their mean stress, that of the centre of the layer.
    layer = np.minimum((rows[:, 2 + up] * cells).astype(int), cells - 1)
    for k in range(cells):
        mean = stress[layer == k].mean()
        expected = -density * GRAVITY * (height - (k + 0.5) / cells)
        # Gravity over stiffness is 1e-3; (1 + 16) exp(-16) of the motion is left when viscous.
        tolerance = 2e-3 if damping == "viscous" else 2e-2
        assert mean == pytest.approx(expected, abs=tolerance * density * GRAVITY * height)
    assert last.time == pytest.approx(t_stop, rel=EPSILON)
