"""The order in time of a motion that starts with an acceleration."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frames import read_series
from scene import Array, Body, Run, Scene, block, run_scene

#: Gravity of a column of 1 m with wave speed 1 m/s: strains of at most 2e-6.
G = 1e-6


def sudden_gravity(x: Array, t: float) -> Array:
    """Return the displacement of a column on a fixed base, over g, for t up to 6 s."""
    u = np.full_like(x, -0.5 * t**2)
    for m in range(4):
        up, down = np.maximum(t - 2 * m - x, 0.0), np.maximum(t - 2 * (m + 1) + x, 0.0)
        u += 0.5 * (-1) ** m * (up**2 + down**2)
    return u


def error(run: Run, folder: Path, cells: int, staggered: int, driver: str) -> float:
    """Return the largest of the root mean square errors of 20 frames over one period."""
    rows = block(1, [0.0], [1.0], [2 * cells], density=1.0)
    body = Body("column", rows, 1.0, 0.0, 'boundary-class = "CartesianBox"')
    solver = (
        f'solver {{ class = "ExplicitUSL" int-properties = {{0, 1, staggered = {staggered}}} }}\n'
    )
    # Both make steps of c dt/h = 0.2; the stable step is 0.7559.
    scene = Scene(
        1,
        [1.25],
        [5 * cells // 4],
        [body],
        t_stop=4.0,
        dt=0.2 / cells,
        rate=5.0,
        gravity=[-G],
        solver=solver,
    )
    if driver == "AdaptiveDriver":
        scene.dt = 1.0
        scene.driver = f'driver {{ class = "{driver}" properties = {{4, {-G}, cfl = 0.26458}} }}\n'
    run_scene(run, scene, folder)
    frames = read_series(folder / "frames", "fpd", 0, "column")
    assert len(frames) == 21
    misses = [
        frame.fields["displacement"][:, 0] / G - sudden_gravity(rows[:, 2], frame.time)
        for frame in frames
    ]
    return max(float(np.sqrt(np.mean(miss**2))) for miss in misses)


@pytest.mark.parametrize("driver", ["UserDefinedGravityDriver", "AdaptiveDriver"])
def test_order_of_a_sudden_load(mpm3d: Run, tmp_path: Path, driver: str) -> None:
    """First order with velocities of the start, 5/3 with those of the middles of the steps.

    The velocity has kinks, for which the scheme is of order 5/3 in h and dt together; a start that
    is off by g dt/2 is of first order.
    """
    orders = []
    for staggered in (0, 1):
        coarse, fine = (
            error(mpm3d, tmp_path / f"{staggered}_{cells}", cells, staggered, driver)
            for cells in (32, 64)
        )
        orders.append(np.log2(coarse / fine))
    assert orders[0] == pytest.approx(1.0, abs=0.15)
    assert orders[1] == pytest.approx(5 / 3, abs=0.15)
