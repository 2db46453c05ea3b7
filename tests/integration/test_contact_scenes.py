"""The scenes of walls with friction, of plates and of contacts have their closed forms."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from frames import Frame, read_frame, read_series
from project_scene import run_config
from scene import EPSILON, Array, Body, Run, Scene, block, run_scene

GRAVITY = 9.81


def mean(frame: Frame, field: str = "velocity") -> Array:
    """Return the mean of a field of the points by mass."""
    values = frame.positions if field == "position" else frame.fields[field]
    return np.average(values, axis=0, weights=frame.fields["mass"])


def test_frictional_slope(mpm3d: Run, tmp_path: Path) -> None:
    """The block stops after v0^2/(2 g (mu cos a - sin a)) and stays."""
    folder, _ = run_config(mpm3d, "frictional_slope", tmp_path)
    frames = read_series(folder, "fpd", 0, "block")
    friction, start = 0.6, 1.0
    down, normal = GRAVITY * math.sin(math.radians(20)), GRAVITY * math.cos(math.radians(20))
    braking = friction * normal - down
    stop_time, way = start / braking, 0.5 * start**2 / braking
    # J_t = mu J_n in each step of sliding, at which it rounds, and gravity has 13 digits.
    steps = stop_time / 2e-4
    for frame in frames:
        if frame.time > 0.75 * stop_time:
            break
        v = mean(frame)
        impulse = start + down * frame.time - v[0]
        assert impulse == pytest.approx(
            friction * (normal * frame.time + v[1]), abs=64 * steps * EPSILON + 1e-11
        )
    place = [mean(frame, "position")[0] for frame in frames]
    # The base stops node by node, at most two heights of shear waves (2 h/c_s = 0.015 s) apart,
    # in which the block moves by braking t^2/2; bounces take as much. Together 2 %.
    assert place[-1] - place[0] == pytest.approx(way, rel=0.02)
    late = [x for frame, x in zip(frames, place, strict=True) if frame.time > 1.2 * stop_time]
    assert len(late) > 10
    assert max(late) - min(late) < 1e-3 * way
    # It touches the floor, and does not sink into it.
    assert np.min(frames[-1].positions[:, 1]) > 0.0


def spin(frames: tuple[Frame, ...]) -> float:
    """Return the angular velocity of points that turn as one: angular momentum over inertia."""
    mass = np.concatenate([frame.fields["mass"] for frame in frames])
    x = np.concatenate([frame.positions for frame in frames])
    v = np.concatenate([frame.fields["velocity"] for frame in frames])
    x, v = (values - np.average(values, axis=0, weights=mass) for values in (x, v))
    turn = np.sum(mass * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]))
    return float(turn / np.sum(mass * np.sum(x**2, axis=1)))


def test_sticking_blocks(mpm3d: Run, tmp_path: Path) -> None:
    """Two equal blocks stick together: half of the speed, and a turn of the pair as one."""
    folder, report = run_config(mpm3d, "sticking_blocks", tmp_path)
    left = read_series(folder, "fpd", 0, "left")
    right = read_series(folder, "fpd", 1, "right")
    for one, other in zip(left, right, strict=True):
        # Sums over 512 points, 6,000 steps, and 10 digits in a frame.
        velocity = 0.5 * (mean(one) + mean(other))
        assert np.abs(velocity - [0.5, 0.0, 0.0]).max() < 1e-9
    late = [pair for pair in zip(left, right, strict=True) if pair[0].time > 0.7]
    assert len(late) > 20
    # They stay together: the distance of their centres changes by swinging only, whose speed is
    # below sqrt(2 * 3 J/160 kg) = 0.2 m/s, at a frequency of c/(4 * 0.8 m) = 11 Hz or more.
    distance = [
        np.linalg.norm(mean(one, "position") - mean(other, "position")) for one, other in late
    ]
    assert max(distance) - min(distance) < 2.0 * 0.2 / (2.0 * math.pi * 11.0)
    # Each turns as fast as the pair does; swings average out.
    pair = np.mean([spin(both) for both in late])
    for body in (0, 1):
        assert np.mean([spin((both[body],)) for both in late]) == pytest.approx(pair, rel=0.05)
    # J/I, of which the mapping loses 5 %: 160 kg * 1 m/s * 0.1 m over that of two squares of side
    # 0.4 m, whose centres are 0.475 m apart when they stick.
    inertia = 2 * 160.0 * (2 * 0.4**2 / 12 + (0.475 / 2) ** 2)
    assert pair == pytest.approx(16.0 / inertia, rel=0.08)
    # Energy of the rigid pair, 45 of 80 J; the rest is what linking takes, and 3 J of swinging.
    rigid = 0.5 * 320.0 * 0.5**2 + 0.5 * 16.0**2 / inertia
    energy = re.search(r"kinetic (\S+),", report)
    assert energy
    assert float(energy[1]) == pytest.approx(rigid, abs=3.0)


@pytest.mark.parametrize("flags", ["", ', "SLIP_BOUNDARY"'])
def test_linked_bars_swap_their_velocity(mpm3d: Run, tmp_path: Path, flags: str) -> None:
    """A bar that is linked to one at rest and moves away from it hands half of its velocity on.

    The joint has V/2 at once, which spreads at c: the mean velocities are V/2 after L/c, swapped
    after 2 L/c, and back after 4 L/c. Without the link, or with contact that can't pull, nothing
    happens.
    """
    speed, c, length, h = 0.05, 10.0, 0.4, 0.01
    rest = block(1, [0.2], [0.2 + length], [80])
    away = block(1, [0.2 + length], [0.2 + 2 * length], [80], velocity=[speed])
    link = f"""contact
{{
    class = "ContactLinked"
    name = "joint"
    str-properties = {{"rest", "away"{flags}}}
}}
"""
    scene = Scene(
        1,
        lengths=[1.4],
        cells=[140],
        bodies=[Body("rest", rest, poisson=0.0), Body("away", away, poisson=0.0)],
        contacts=[link],
        gravity=[0.0],
        dt=0.2 * h / c,
        t_stop=4.0 * length / c,
        rate=4.0 * c / length,
    )
    run_scene(mpm3d, scene, tmp_path)
    series = [
        read_series(tmp_path / "frames", "fpd", body, name)
        for body, name in enumerate(["rest", "away"])
    ]
    means = np.array([[mean(frame)[0] for frame in frames] for frames in series]) / speed
    times = np.array([frame.time for frame in series[0]]) * c / length
    triangle = np.interp(times, [0.0, 2.0, 4.0], [0.0, 1.0, 0.0])
    # The joint and the fronts are a cell or two wide: 2 h/L = 5 %, met four times.
    np.testing.assert_allclose(means[0], triangle, atol=0.1)
    np.testing.assert_allclose(means.sum(axis=0), 1.0, atol=1e-9)


def test_mirrored_impact(mpm3d: Run, tmp_path: Path) -> None:
    """Half a disc on half a block move as the right half of the whole."""
    folder, _ = run_config(mpm3d, "mirrored_impact", tmp_path)
    scene = tmp_path / "configs" / "mirrored_impact"
    centre = 0.6
    for name, old, new in (
        ("mirrored_impact.cfg", "{0.6, 0.8}", "{1.2, 0.8}"),
        ("mirrored_impact.cfg", "{24, 32}", "{48, 32}"),
        ("mirrored_impact.cfg", "output/mirrored_impact", "output/whole"),
        ("disc.parts", "{0.6, 0.8}", "{1.2, 0.8}"),
        ("disc.parts", "{24, 32}", "{48, 32}"),
        ("disc.parts", "{0, 0.45, 0.2}", "{0.6, 0.45, 0.2}"),
        ("block.parts", "{0.6, 0.8}", "{1.2, 0.8}"),
        ("block.parts", "{24, 32}", "{48, 32}"),
        ("block.parts", "{0, 0, 0.35, 0.2}", "{0.25, 0, 0.95, 0.2}"),
    ):
        before = (scene / name).read_text()
        assert old in before
        (scene / name).write_text(before.replace(old, new))
    assert mpm3d("-c", scene / "mirrored_impact.cfg", cwd=tmp_path).returncode == 0
    for number, body in enumerate(["disc", "block"]):
        half = read_series(folder, "fpd", number, body)
        whole = read_series(tmp_path / "output" / "whole", "fpd", number, body)
        right = whole[0].positions[:, 0] > centre
        assert right.sum() == len(half[0].positions)
        here, there = order(half[0].positions), order(whole[0].positions[right] - [centre, 0, 0])
        for one, all_of_it in zip(half, whole, strict=True):
            moved = all_of_it.positions[right][there] - [centre, 0.0, 0.0]
            # Ten digits in a frame; rounding errors of 2,000 steps with cells crossed.
            np.testing.assert_allclose(one.positions[here], moved, rtol=0.0, atol=1e-9)
        # It was worth the comparison.
        assert np.abs(mean(half[-1]) - mean(half[0]))[1] > 0.3


def order(x: Array) -> Array:
    """Return the order of points by their places."""
    return np.lexsort(np.round(x, 6).T)


def test_pushed_block(mpm3d: Run, tmp_path: Path) -> None:
    """The plate goes on as told, the block with it, and the force is that of friction."""
    folder, _ = run_config(
        mpm3d,
        "pushed_block",
        tmp_path,
        *("--set", "job.dt=5e-4", "--set", "serializer.properties={1000}"),
        *("--set", "driver.properties={0.5}"),
    )
    speed, friction, weight, h = 0.2, 0.3, 60.0 * GRAVITY, 0.05
    plates = read_every(folder, "fpd.0.plate", 50)
    blocks = read_every(folder, "fpd.1.block", 50)
    assert len(plates) == len(blocks) == 11
    for frame in plates:
        np.testing.assert_allclose(frame.fields["velocity"], [[speed, 0, 0]] * 56, atol=1e-10)
        np.testing.assert_allclose(
            frame.positions - plates[0].positions, [[speed * frame.time, 0, 0]] * 56, atol=1e-10
        )
    # The half widths of both are 0.2 m; contact begins up to a cell before they touch, and the
    # block slides at most (0.2 m/s)^2/(2 mu g) ahead when it is hit.
    late = range(2, 11)
    for i in late:
        gap = mean(blocks[i], "position")[0] - mean(plates[i], "position")[0]
        assert 0.2 < gap < 0.2 + h + speed**2 / (2.0 * friction * GRAVITY)
    # Momentum of the block: plate less floor. Every other step is seen, and pushes last a wave's
    # way through the block and back, 2 * 0.3 m/c or 16 frames.
    nodes = read_every(folder, "fnd.0.plate", 1)[101:]
    time = blocks[-1].time - blocks[2].time
    assert len(nodes) == round(1000 * time)
    change = 60.0 * (mean(blocks[-1]) - mean(blocks[2]))
    force = -np.mean([node.fields["contact_force_by_block_on_plate"][:, 0].sum() for node in nodes])
    assert force == pytest.approx(
        (change[0] + friction * (weight * time + change[1])) / time, rel=1.0 / 16.0
    )


def read_every(folder: Path, name: str, n: int) -> list[Frame]:
    """Read every n-th frame of a body."""
    return [read_frame(path) for path in sorted(folder.glob(f"{name}.*.vtk"))[::n]]
