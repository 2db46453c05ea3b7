"""Free fall and free flight: exact but for rounding, in every TYPE and with both mappings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from frames import read_series
from scene import (
    DIM,
    GRAVITY,
    NVEL,
    ROUNDING,
    TYPES,
    UP,
    Body,
    Run,
    Scene,
    block,
    positions,
    run_scene,
)

STEPS = 50
DT = 1e-3
MAPPINGS = pytest.mark.parametrize("cpdi", [0, 1])
ALL_TYPES = pytest.mark.parametrize("sim_type", TYPES)


def falling_scene(sim_type: int, **changes: object) -> Scene:
    """Make a block in the middle of a grid with cells of 0.1 m, 2 points a cell and direction."""
    dim = DIM[sim_type]
    rows = block(sim_type, [0.4] * dim, [0.6] * dim, [4] * dim)
    settings: dict[str, object] = {
        "lengths": [1.0] * dim,
        "cells": [10] * dim,
        "bodies": [Body("faller", rows)],
        "dt": DT,
        "t_stop": STEPS * DT,
        "rate": 1.0 / (STEPS * DT),
    }
    return Scene(sim_type, **{**settings, **changes})  # type: ignore[arg-type]


@MAPPINGS
@ALL_TYPES
def test_free_fall_is_exact(mpm3d: Run, tmp_path: Path, sim_type: int, cpdi: int) -> None:
    """After n steps the centre of mass has moved -g dt^2 n (n + 1)/2."""
    run_scene(mpm3d, falling_scene(sim_type, cpdi=cpdi), tmp_path)
    last = read_series(tmp_path / "frames", "fpd", 0, "faller")[-1]
    mass = last.fields["mass"]
    moved = mass @ last.fields["displacement"] / mass.sum()
    velocity = mass @ last.fields["velocity"] / mass.sum()

    fall = GRAVITY * DT**2 * STEPS * (STEPS + 1) / 2
    speed = GRAVITY * DT * STEPS
    up = UP[sim_type]
    assert abs(moved[up] + fall) <= ROUNDING * STEPS * fall
    assert abs(velocity[up] + speed) <= ROUNDING * STEPS * speed
    others = [component for component in range(3) if component != up]
    if sim_type == 4:
        # Hoop stresses, themselves rounding errors, do not cancel along r.
        others.remove(0)
    assert np.all(np.abs(moved[others]) <= ROUNDING * STEPS * fall)
    assert np.all(np.abs(velocity[others]) <= ROUNDING * STEPS * speed)


@MAPPINGS
@pytest.mark.parametrize("sim_type", [1, 2, 3, 5])
def test_fall_under_any_gravity(mpm3d: Run, tmp_path: Path, sim_type: int, cpdi: int) -> None:
    """Every component of velocities falls, the third one of TYPE 5 included."""
    gravity = np.zeros(3)
    gravity[: NVEL[sim_type]] = [3.0, -5.0, 7.0][: NVEL[sim_type]]
    scene = falling_scene(sim_type, cpdi=cpdi, gravity=gravity[: NVEL[sim_type]].tolist())
    run_scene(mpm3d, scene, tmp_path)
    first, last = read_series(tmp_path / "frames", "fpd", 0, "faller")
    mass = last.fields["mass"]
    moved = mass @ last.fields["displacement"] / mass.sum()

    expected = gravity * DT**2 * STEPS * (STEPS + 1) / 2
    tolerance = ROUNDING * STEPS * np.linalg.norm(expected)
    assert np.all(np.abs(moved - expected) <= tolerance)
    # What the TYPE has no direction for stays at its place.
    assert np.array_equal(last.positions[:, DIM[sim_type] :], first.positions[:, DIM[sim_type] :])


@MAPPINGS
@ALL_TYPES
@pytest.mark.parametrize(
    "components",
    [
        pytest.param((5.0123, -6.0456, 4.0789), id="between-nodes"),
        # Whole parts of a cell in a step: now and then points lie on a node line, where the node
        # beyond it gets a gradient but no mass, or 1e-16 of one.
        pytest.param((5.0, -6.0, 4.0), id="over-nodes"),
    ],
)
def test_free_flight_is_exact(
    mpm3d: Run, tmp_path: Path, sim_type: int, cpdi: int, components: tuple[float, float, float]
) -> None:
    """Without gravity every point keeps its velocity, across several cells."""
    dim, nvel = DIM[sim_type], NVEL[sim_type]
    velocity = np.zeros(3)
    velocity[:nvel] = components[:nvel]
    if sim_type == 4:
        # Only along z is a straight line free of hoop strain and inertia of the basis.
        velocity[[0, 2]] = 0.0
    rows = block(sim_type, [0.4] * dim, [0.6] * dim, [4] * dim, velocity=velocity[:nvel].tolist())
    bodies = [Body("flyer", rows)]
    run_scene(
        mpm3d, falling_scene(sim_type, cpdi=cpdi, bodies=bodies, gravity=[0.0] * nvel), tmp_path
    )
    last = read_series(tmp_path / "frames", "fpd", 0, "flyer")[-1]

    way = velocity * STEPS * DT
    in_plane = np.where(np.arange(3) < dim, way, 0.0)
    speed = float(np.linalg.norm(velocity))
    # A step moves a point by less than its distance from the origin, about 1 m, where it rounds.
    tolerance = ROUNDING * STEPS
    assert np.all(np.abs(last.fields["velocity"] - velocity) <= tolerance * speed)
    assert np.all(np.abs(last.fields["displacement"] - way) <= tolerance)
    assert np.all(np.abs(last.positions - positions(rows, sim_type) - in_plane) <= tolerance)
