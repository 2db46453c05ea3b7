"""Drivers that write a table of their own: a chute at steady state, fish with random muscles."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from checkpoints import MIXTURE
from frames import Frame, read_series
from scene import EPSILON, Array, Run, block, numbers, write_points


def read_table(path: Path) -> dict[str, Array]:
    """Return the columns of a table by their names."""
    names, *rows = path.read_text().splitlines()
    table = np.array([[float(value) for value in row.split(",")] for row in rows])
    return dict(zip(names.split(","), table.T, strict=True))


SAND = (0.3819, 0.6435, 0.279, 0.005, 2500.0)


def chute_config(height: float, slope: float, cells: int, t_stop: float) -> str:
    """Return the config of a bed on a rough floor, which goes on without end along x."""
    h = height / cells
    mu_1, mu_2, number, size, density = SAND
    reals = [t_stop, 9.81, mu_1, mu_2, number, size, density, height, slope, 0.6]
    return f"""job {{ dt = 1e-4 TYPE = 2 }}
serializer
{{
    class = "DefaultVTK"
    properties = {{20}}
    int-properties = {{nodes = 0}}
    str-properties = {{"frames", "save", "test"}}
}}
driver
{{
    class = "ChuteFlowDriver"
    properties = {{{numbers(reals)}}}
    str-properties = {{"tables/chute.csv"}}
}}
solver {{ class = "ExplicitUSL" str-properties = {{transfer = "APIC"}} }}
grid
{{
    class = "CartesianCustom"
    properties = {{{4 * h}, {height + 2 * h}}}
    int-properties = {{4, {cells + 2}, 1, 0}}
}}
body
{{
    class = "DefaultBody"
    name = "bed"
    point-file = "bed.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
    material-class = "Sand_SachithLocal"
    material-props = {{E = 1e6, nu = 0.3, d = {size}, mu_s = {mu_1}, rho_s = {density},
                       rho_c = 1500, mu_2 = {mu_2}, I_0 = {number}}}
    boundary-class = "CartesianBoxCustom"
    boundary-int-props = {{3, 3, 0, -1}}
}}
"""


def bagnold(y: Array, height: float, slope: float) -> Array:
    """Return the velocities of steady flow, where friction is tan(slope) everywhere."""
    mu_1, mu_2, number, size, density = SAND
    angle = math.radians(slope)
    excess = (math.tan(angle) - mu_1) / (mu_2 - math.tan(angle))
    rate = excess * number / (size * math.sqrt(density))
    weight = math.sqrt(0.6 * density * 9.81 * math.cos(angle))
    return 2.0 / 3.0 * rate * weight * (height**1.5 - np.maximum(0.0, height - y) ** 1.5)


def test_a_chute_stays_at_its_steady_state(mpm3d: Run, tmp_path: Path) -> None:
    """A bed that starts with the profile of Bagnold keeps it; the table tells so."""
    height, slope, cells = 0.1, 25.0, 10
    h = height / cells
    rows = block(2, [0.0, 0.0], [4 * h, height], [8, 2 * cells], density=1500.0)
    rows[:, 4] = bagnold(rows[:, 3], height, slope)
    write_points(tmp_path / "bed.points", rows)
    (tmp_path / "scene.cfg").write_text(chute_config(height, slope, cells, 0.3))
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    table = read_table(tmp_path / "tables/chute.csv")
    np.testing.assert_allclose(table["time"], 0.05 * np.arange(7), rtol=1e-9)
    mass, speed = rows[:, 0], rows[:, 4]
    mean = float(mass @ speed) / float(mass.sum())
    # The first line is that of the points: linear momentum is that of the nodes.
    assert table["mean_velocity_x"][0] == pytest.approx(mean, rel=64 * EPSILON)
    assert table["centre_y"][0] == pytest.approx(0.5 * height, rel=64 * EPSILON)
    assert table["highest_y"][0] == pytest.approx(height - 0.25 * h, rel=64 * EPSILON)
    # The profile has a mean of 3/5 of the velocity of the surface.
    top = float(bagnold(np.array(height), height, slope))
    assert mean == pytest.approx(0.6 * top, rel=(h / height) ** 2)
    norm = top * math.sqrt(4 * h * height * 9 / 20)
    assert np.all(table["velocity_error"] < 0.05 * norm)
    np.testing.assert_allclose(table["mean_velocity_x"], mean, rtol=0.03)
    assert np.all(np.abs(table["centre_y"] - 0.5 * height) < 0.02 * height)
    assert np.all(table["overshoot"] < 0.1)


def test_a_gentle_slope_holds_the_grains(mpm3d: Run, tmp_path: Path) -> None:
    """Below the angle of friction the bed at rest stays there."""
    height, cells = 0.1, 10
    h = height / cells
    rows = block(2, [0.0, 0.0], [4 * h, height], [8, 2 * cells], density=1500.0)
    write_points(tmp_path / "bed.points", rows)
    (tmp_path / "scene.cfg").write_text(chute_config(height, 15.0, cells, 0.1))
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    table = read_table(tmp_path / "tables/chute.csv")
    assert table["velocity_error"][0] == 0.0
    # The waves of its settling: strains p/E of 1e-3 at a speed of 30 m/s.
    assert np.all(np.abs(table["largest_velocity_x"]) < 0.03)


def fish_config(driver: str, muscles: list[float]) -> str:
    """Return the config of a fish that lies on a rough floor."""
    return f"""job {{ dt = 2e-3 TYPE = 2 }}
serializer
{{
    class = "DefaultVTK"
    properties = {{20}}
    int-properties = {{17, nodes = 0}}
    str-properties = {{"frames", "save", "test"}}
}}
driver {{ {driver} }}
solver {{ class = "ExplicitUSL" }}
grid {{ class = "CartesianLinear" properties = {{1, 1}} int-properties = {{20, 20}} }}
body
{{
    class = "DefaultBody"
    name = "fish"
    point-file = "fish.points"
    point-class = "DefaultPoints"
    node-class = "DefaultNodes"
    material-class = "Fish"
    material-props = {{1e4, 0.3, {numbers(muscles)}}}
    boundary-class = "CartesianBox"
}}
"""


def swim(run: Run, folder: Path, driver: str, muscles: list[float]) -> list[Frame]:
    """Run a fish and return its frames."""
    folder.mkdir()
    rows = block(2, [0.3, 0.0], [0.7, 0.2], [16, 8])
    write_points(folder / "fish.points", rows)
    (folder / "scene.cfg").write_text(fish_config(driver, muscles))
    (folder / "mixture.txt").write_text(MIXTURE)
    result = run("-c", "scene.cfg", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    return read_series(folder / "frames", "fpd", 0, "fish")


@pytest.mark.parametrize("mixture", [False, True])
def test_runs_of_a_fish_are_those_of_its_muscles(mpm3d: Run, tmp_path: Path, mixture: bool) -> None:
    """Each line of the table is what a run of its own with the same muscles does."""
    name, files = "FishRandomSampleDriver", '"a/table.csv"'
    if mixture:
        name, files = "FishMixtureModelRandomSampleDriver", '"a/table.csv", "mixture.txt"'
    driver = f"""class = "{name}"
    properties = {{0.1, 0.01, 0.05, 10, 30, 0, 3}}
    int-properties = {{3, seed = 5}}
    str-properties = {{{files}, "fish"}}"""
    frames = swim(mpm3d, tmp_path / "many", driver, [0.0] * 9)
    # Those of the first run.
    assert [frame.time for frame in frames] == pytest.approx([0.0, 0.05, 0.1])
    table = read_table(tmp_path / "many/a/table.csv")
    np.testing.assert_array_equal(table["sample"], [1, 2, 3])
    alone = 'class = "UserDefinedGravityDriver" properties = {0.1, 0, 0}'
    found = []
    for k in range(3):
        muscles = [float(values[k]) for values in list(table.values())[1:10]]
        if not mixture:
            assert np.all((np.array(muscles[:3]) >= 0.01) & (np.array(muscles[:3]) <= 0.05))
        frames = swim(mpm3d, tmp_path / str(k), alone, muscles)
        moved = frames[-1].fields["displacement"]
        # All points have the same mass; a mean of 128 numbers rounds.
        scale = np.max(np.abs(moved))
        for axis, column in enumerate(("displacement_x", "displacement_y")):
            assert abs(table[column][k] - np.mean(moved[:, axis])) <= 256 * EPSILON * scale
        found.append(table["displacement_x"][k])
    # The floor holds the fish, which moves, and each time elsewhere.
    assert np.min(np.abs(found)) > 1e-6
    assert len(set(found)) == 3
