"""Bodies with AssignedVelocity: they move as they are told, and push others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frames import read_series
from scene import DIM, NVEL, ROUNDING, Body, Run, Scene, block, huang, numbers, run_scene

STEPS = 40
DT = 1e-3


def assigned(*velocity: float) -> str:
    """Return the lines of a body that moves with a velocity."""
    return f'boundary-class = "AssignedVelocity"\n    boundary-props = {{{numbers(velocity)}}}'


@pytest.mark.parametrize("solver", ["ExplicitUSL", "ExplicitMUSL", "ExplicitUSF"])
@pytest.mark.parametrize("transfer", ["FLIP", "APIC", "XPIC"])
@pytest.mark.parametrize("sim_type", [1, 2, 3, 4, 5])
def test_plate_obeys(mpm3d: Run, tmp_path: Path, sim_type: int, transfer: str, solver: str) -> None:
    """Gravity, a body in the way and what its file says do not change the motion of a plate."""
    dim, nvel = DIM[sim_type], NVEL[sim_type]
    wanted = [0.0 if sim_type == 4 else 1.5, -0.5, 0.25][:dim]
    lower = block(sim_type, [0.3] * dim, [0.5] * dim, [4] * dim, velocity=[9.0] * nvel)
    # In the way of the plate, also that of TYPE 4, which falls.
    way = block(sim_type, [0.5] + [0.2] * (dim - 1), [0.7] + [0.4] * (dim - 1), [4] * dim)
    scene = Scene(
        sim_type,
        lengths=[1.0] * dim,
        cells=[10] * dim,
        bodies=[Body("plate", lower, more=assigned(*wanted)), Body("way", way)],
        contacts=[huang("plate", "way")],
        dt=DT,
        t_stop=STEPS * DT,
        rate=1.0 / (STEPS * DT),
        solver=f'solver\n{{\n    class = "{solver}"\n    str-properties = {{"{transfer}"}}\n}}\n',
    )
    run_scene(mpm3d, scene, tmp_path)
    _, last = read_series(tmp_path / "frames", "fpd", 0, "plate")
    exact = np.zeros(3)
    exact[:dim] = wanted
    # Every step rounds the sum of a velocity of order 2, or a place of order 1, once more.
    assert np.abs(last.fields["velocity"] - exact).max() <= ROUNDING * STEPS * 2.0
    moved = last.fields["displacement"] - STEPS * DT * exact
    assert np.abs(moved).max() <= ROUNDING * STEPS
    assert np.abs(last.fields["density"] / 1000.0 - 1.0).max() <= ROUNDING * STEPS


def test_plate_hits_a_bar(mpm3d: Run, tmp_path: Path) -> None:
    """A bar that is hit by a plate of speed V leaves it with 2 V after 2 L/c.

    Behind the front of the wave, which leaves at c, the bar has the velocity V; the free end sends
    it back with 2 V. So the mean velocity grows by V in the time L/c.
    """
    speed, c, length, h = 0.05, 10.0, 0.4, 0.01
    # ContactHuang pushes with the common velocity of both: a heavy plate keeps its own.
    plate = block(1, [0.1], [0.2], [20], density=1e8)
    bar = block(1, [0.2], [0.2 + length], [80])
    scene = Scene(
        1,
        lengths=[1.0],
        cells=[100],
        bodies=[
            Body("plate", plate, poisson=0.0, more=assigned(speed)),
            Body("bar", bar, poisson=0.0),
        ],
        contacts=[huang("plate", "bar")],
        gravity=[0.0],
        dt=0.2 * h / c,
        t_stop=3.0 * length / c,
        rate=4.0 * c / length,
    )
    run_scene(mpm3d, scene, tmp_path)
    frames = read_series(tmp_path / "frames", "fpd", 1, "bar")
    assert len(frames) == 13
    mass = bar[:, 0] / bar[:, 0].sum()
    means = np.array([mass @ frame.fields["velocity"][:, 0] for frame in frames]) / speed
    times = np.array([frame.time for frame in frames]) * c / length
    # The front is a cell or two wide, and so is the zone of contact: 2 h/L = 5 %.
    np.testing.assert_allclose(means, np.minimum(times, 2.0), atol=0.1)
    # What the plate feels while it pushes is rho c V, what it does later is nothing.
    nodes = read_series(tmp_path / "frames", "fnd", 0, "plate")
    force = [frame.fields["contact_force_by_bar_on_plate"][:, 0].sum() for frame in nodes]
    assert np.mean(force[1:7]) == pytest.approx(-1000.0 * c * speed, rel=0.1)
    assert force[-1] == 0.0
