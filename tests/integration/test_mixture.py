"""Grains and the fluid in their pores: drag, buoyancy, settling, pore pressure."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from frames import Frame, read_series
from mixture import GRAVITY, RHO_FLUID, RHO_GRAIN, Slurry
from scene import EPSILON, Body, Run, block, write_points

#: A column of uniaxial strain, full of slurry.
COLUMN = {
    "sim_type": 1,
    "lengths": [1.0],
    "cells": [20],
    "lower": [0.0],
    "upper": [1.0],
}


def series(folder: Path, body: int, name: str) -> list[Frame]:
    """Return the frames of the points of a body."""
    return read_series(folder / "frames", "fpd", body, name)


@pytest.mark.parametrize("solver", ["ExplicitUSL", "ExplicitMUSL", "ExplicitUSF"])
def test_relative_velocity_decays(mpm3d: Run, tmp_path: Path, solver: str) -> None:
    """In a periodic box each step divides it by 1 + dt C (1/m_s + 1/m_f); momentum stays."""
    steps, dt = 20, 1e-3
    scene = Slurry(
        sim_type=2,
        lengths=[0.4, 0.4],
        cells=[4, 4],
        lower=[0.0, 0.0],
        upper=[0.4, 0.4],
        dt=dt,
        t_stop=steps * dt,
        rate=1.0 / (steps * dt),
        gravity=0.0,
        grain_velocity=[0.3, -0.2],
        fluid_velocity=[-0.1, 0.1],
        grid="CartesianCustom",
        periodic=[1, 1],
        boundary="",
        solver=solver,
        diameter=0.02,
    )
    scene.run(mpm3d, tmp_path)
    phi, n = scene.packing, 1.0 - scene.packing
    masses = np.array([phi * RHO_GRAIN, n * RHO_FLUID])
    slip = np.array([0.4, -0.3]) / (1.0 + dt * scene.drag() * np.sum(1.0 / masses)) ** steps
    mean = (masses[0] * np.array([0.3, -0.2]) + masses[1] * np.array([-0.1, 0.1])) / sum(masses)
    # Rounding of some twenty terms in each of twenty steps.
    tolerance = 64.0 * steps * EPSILON
    for body, name, part in ((0, "sand", masses[1]), (1, "water", -masses[0])):
        velocity = series(tmp_path, body, name)[-1].fields["velocity"][:, :2]
        expected = mean + slip * part / np.sum(masses)
        np.testing.assert_allclose(velocity, np.tile(expected, (64, 1)), atol=tolerance)
    assert 0.05 < np.linalg.norm(slip) < 0.45


def test_settling_velocity(mpm3d: Run, tmp_path: Path) -> None:
    """A uniform suspension in a closed column settles as Carman and Kozeny say."""
    phi = 0.5
    mixture = phi * RHO_GRAIN + (1.0 - phi) * RHO_FLUID
    scene = Slurry(
        **COLUMN,
        dt=5e-4,
        t_stop=0.5,
        rate=10.0,
        diameter=3e-3,
        viscosity=0.05,
        bulk=1e6,
        effective=mixture,
    )
    scene.run(mpm3d, tmp_path)
    n = 1.0 - phi
    speed = n**3 * (RHO_GRAIN - RHO_FLUID) * GRAVITY * scene.diameter**2 / (180.0 * phi)
    speed /= scene.viscosity
    sand, water = series(tmp_path, 0, "sand"), series(tmp_path, 1, "water")
    middle = np.abs(sand[0].positions[:, 0] - 0.5) < 0.2
    fallen = np.mean(sand[-1].fields["displacement"][middle, 0])
    risen = np.mean(water[-1].fields["displacement"][middle, 0])
    # Inertia holds the start back by m/C, some ms; the fluid is compressible by p/K = 0.02.
    time = sand[-1].time
    assert fallen == pytest.approx(-speed * time, rel=0.03)
    # What goes down goes up: n v_f = -phi v_s.
    assert risen == pytest.approx(phi / n * speed * time, rel=0.05)
    # The pore pressure carries the whole weight there.
    depth = 1.0 - water[-1].positions[middle, 0]
    pressure = water[-1].fields["pressure"][middle]
    slope = np.polyfit(depth, pressure, 1)[0]
    assert slope == pytest.approx(mixture * GRAVITY, rel=0.03)


@pytest.mark.parametrize("sim_type", [2, 4])
def test_grains_as_heavy_as_the_fluid_stay(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Buoyancy balances their weight: they sink at a small part of the way of free fall."""
    scene = Slurry(
        sim_type=sim_type,
        lengths=[0.4, 1.0],
        cells=[4, 10],
        lower=[0.0, 0.0],
        upper=[0.4, 1.0],
        dt=5e-4,
        t_stop=0.2,
        rate=5.0,
        grain=RHO_FLUID,
        effective=RHO_FLUID,
        viscosity=1e-3,
        diameter=0.05,
    )
    scene.run(mpm3d, tmp_path)
    sand = series(tmp_path, 0, "sand")[-1]
    # The pressure acts at the points, half of their distance below the surface at the top.
    inner = sand.positions[:, 1] < 0.8
    fallen = np.abs(sand.fields["displacement"][inner, :2])
    assert float(np.max(fallen)) < 0.02 * 0.5 * GRAVITY * 0.2**2


def make_piston(folder: Path, name: str) -> Slurry:
    """Write the points of a plate; return a scene in which it rests on a slurry."""
    mixture, plate = 0.5 * (RHO_GRAIN + RHO_FLUID), 2000.0
    body = Body("plate", block(1, [1.0], [1.2], [8], density=plate), modulus=1e6)
    contact = f"""contact
{{
    class = "{name}"
    name = "piston"
    properties = {{0.3819}}
    str-properties = {{"plate", "sand", "water"}}
}}
"""
    write_points(folder / "plate.points", body.rows)
    return Slurry(
        sim_type=1,
        lengths=[1.5],
        cells=[30],
        lower=[0.0],
        upper=[1.0],
        dt=2e-4,
        t_stop=0.2,
        rate=5.0,
        bulk=1e6,
        # The depth counts from the highest point, half a distance of points below the plate.
        surface=0.2 * plate / mixture + 0.0125,
        effective=mixture,
        more=[body.section(), contact],
    )


@pytest.mark.parametrize("name", ["SlurryContact", "SlurryContact_ReflectedBoundary"])
def test_piston(mpm3d: Run, tmp_path: Path, name: str) -> None:
    """A plate on a slurry rests on the pressure in its pores, which was given at the start."""
    make_piston(tmp_path, name).run(mpm3d, tmp_path)
    fallen = np.abs(series(tmp_path, 2, "plate")[-1].fields["displacement"][:, 0])
    assert float(np.max(fallen)) < 0.02 * 0.5 * GRAVITY * 0.2**2
    water = series(tmp_path, 1, "water")[-1]
    top = water.positions[:, 0] > 0.8
    mixture, plate = 0.5 * (RHO_GRAIN + RHO_FLUID), 2000.0
    weight = (0.2 * plate + mixture * (1.0 - water.positions[top, 0])) * GRAVITY
    np.testing.assert_allclose(water.fields["pressure"][top], weight, rtol=0.05)
    force = read_series(tmp_path / "frames", "fnd", 2, "plate")[-1]
    held = force.fields["contact_force_by_sand_and_water_on_plate"][:, 0]
    # Its weight, and its inertia in the last swing.
    assert float(np.sum(held)) == pytest.approx(0.2 * plate * GRAVITY, rel=0.1)


def test_mixture_solver(mpm3d: Run, tmp_path: Path) -> None:
    """ExplicitMixtureSolver has the mixture and the contact in it: the same piston."""
    scene = make_piston(tmp_path, "SlurryContact")
    # A pressure at the start would change the masses of one of the fluids, not of the other.
    scene.effective, scene.t_stop = 0.0, 0.05
    scene.run(mpm3d, tmp_path)
    expected = [series(tmp_path, i, name)[-1] for i, name in enumerate(("sand", "water", "plate"))]
    text = (tmp_path / "scene.cfg").read_text()
    text = text[: text.index("contact {")] + scene.more[0]
    text = text.replace(
        'class = "ExplicitUSL"',
        f'class = "ExplicitMixtureSolver" properties = {{{scene.diameter!r}, {RHO_FLUID!r}}} '
        'str-properties = {"sand", "water", "plate"}',
    )
    text = re.sub(
        r'"SlurryFluidPhase"\n    material-props = \{(.*), .*\}\n    material-str-props.*\n',
        r'"BarotropicViscousFluid"\n    material-props = {\1}\n',
        text,
    )
    (tmp_path / "scene.cfg").write_text(text)
    shutil.rmtree(tmp_path / "frames")
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    for i, name in enumerate(("sand", "water", "plate")):
        found = series(tmp_path, i, name)[-1]
        # Some hundred steps of roundings of the pressure.
        np.testing.assert_allclose(found.positions, expected[i].positions, atol=1e-8)
        pressure, scale = found.fields["pressure"], 1e4
        np.testing.assert_allclose(pressure, expected[i].fields["pressure"], atol=1e-5 * scale)


def test_column_collapse_driver(mpm3d: Run, tmp_path: Path) -> None:
    """Its pressures are those of rest: a bed between walls stays, and so do they."""
    phi = 0.6
    scene = Slurry(
        sim_type=2,
        lengths=[0.2, 0.6],
        cells=[4, 12],
        lower=[0.0, 0.0],
        upper=[0.2, 0.5],
        dt=2e-4,
        t_stop=0.1,
        rate=10.0,
        packing=phi,
        bulk=1e6,
        boundary='boundary-class = "CartesianBoxCustom" boundary-int-props = {1, 1, 1, -1}',
    )
    scene.write(tmp_path)
    text = (tmp_path / "scene.cfg").read_text()
    driver = (
        'driver { class = "ColumnCollapseDriver" '
        f"properties = {{0.1, {RHO_GRAIN!r}, {phi!r}, {RHO_FLUID!r}}} "
        'str-properties = {"sand", "water"} }\n'
    )
    (tmp_path / "scene.cfg").write_text(re.sub(r"driver \{.*\n", driver, text))
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    for i, name, weight in (
        (0, "sand", phi * (RHO_GRAIN - RHO_FLUID) * GRAVITY),
        (1, "water", RHO_FLUID * GRAVITY),
    ):
        first, last = series(tmp_path, i, name)[:: len(series(tmp_path, i, name)) - 1]
        depth = 0.4875 - first.positions[:, 1]
        np.testing.assert_allclose(first.fields["pressure"], weight * depth, atol=1e-9 * weight)
        # The surface lies half a distance of points higher, which makes the bed swing a little.
        tolerance = 2.0 * weight * 0.0125
        np.testing.assert_allclose(last.fields["pressure"], weight * depth, atol=tolerance)
        moved = np.max(np.abs(last.fields["displacement"]))
        assert float(moved) < 0.02 * 0.5 * GRAVITY * 0.1**2


def test_threads_and_restart(mpm3d: Run, tmp_path: Path) -> None:
    """The same bits with two threads, and from a checkpoint."""
    scene = Slurry(
        sim_type=2,
        lengths=[1.0, 1.0],
        cells=[40, 40],
        lower=[0.1, 0.0],
        upper=[0.9, 0.8],
        dt=2e-4,
        t_stop=8e-3,
        rate=250.0,
        packing=0.55,
        effective=0.55 * RHO_GRAIN + 0.45 * RHO_FLUID,
        flags="",
        shift=[0.025, 0.5],
    )
    scene.run(mpm3d, tmp_path / "one", "--set", "serializer.properties={250, save_time = 4e-3}")
    scene.run(mpm3d, tmp_path / "two", environment={"OMP_NUM_THREADS": "2"})
    saved = sorted((tmp_path / "one" / "save").iterdir())[0]
    expected = {p.name: p.read_bytes() for p in (tmp_path / "one" / "frames").glob("*.vtk")}
    assert len(expected) == 4 * 3
    for path in (tmp_path / "two" / "frames").glob("*.vtk"):
        assert path.read_bytes() == expected[path.name], path.name
    last = [p for p in (tmp_path / "one" / "frames").iterdir() if p.name.endswith("2.vtk")]
    for path in last:
        path.unlink()
    result = mpm3d("-r", saved, cwd=tmp_path / "one")
    assert (result.returncode, result.stderr) == (0, "")
    for path in last:
        assert path.read_bytes() == expected[path.name], path.name
