"""The scenes that show the classes one by one do what their READMEs say."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from frames import Frame, read_series
from project_scene import ROOT, run_config
from scene import EPSILON, GRAVITY, Array, Run
from test_command_line import listed_classes


def table(path: Path) -> dict[str, Array]:
    """Read a CSV file with a line of names."""
    with path.open(newline="") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def mean(frame: Frame, field: str) -> Array:
    """Return the mean of a field of the points by mass."""
    return np.average(frame.fields[field], axis=0, weights=frame.fields["mass"])


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Find the root of a function by bisection."""
    sign = math.copysign(1.0, function(low))
    assert sign * function(high) < 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sign * function(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)


def test_every_class_has_a_scene(mpm3d: Run, tmp_path: Path) -> None:
    """Some scene of the project names each class that the program has."""
    texts = [
        path.read_text("utf-8")
        for path in sorted((ROOT / "configs").glob("*/*"))
        if path.suffix in (".cfg", ".parts")
    ]
    named = set(re.findall(r'class = "(\w+)"', "\n".join(texts)))
    classes = {name for names in listed_classes(mpm3d, tmp_path).values() for name in names}
    assert len(classes) > 70
    assert sorted(classes - named) == []


@pytest.mark.slow
def test_chute(mpm3d: Run, tmp_path: Path) -> None:
    """From rest the bed comes to Bagnold's profile, and carries its weight."""
    folder, _ = run_config(mpm3d, "chute", tmp_path)
    slope, depth, grain, friction, fast, scale = 25.0, 0.05, 0.005, 0.3819, 0.6435, 0.279
    tangent, normal = math.tan(math.radians(slope)), GRAVITY * math.cos(math.radians(slope))
    inertial = scale * (tangent - friction) / (fast - tangent)
    surface = inertial / grain * math.sqrt(0.6 * normal * depth**3) * 2.0 / 3.0
    frames = read_series(folder, "fpd", 0, "sand")
    # Every other point of 80.
    assert len(frames[-1].positions) == 40
    y, v = frames[-1].positions[:, 1], frames[-1].fields["velocity"][:, 0]
    steady = surface * (1.0 - np.clip(1.0 - y / depth, 0.0, 1.0) ** 1.5)
    # The start is forgotten as exp(-t/0.67 s): 1.1 % are left, and linear functions on ten cells
    # are off by parts of (h/H)^2 = 1 %.
    assert np.abs(v - steady).max() < 0.02 * surface
    history = table(folder / "chute.history.csv")
    assert history["gate.mass_flux"][-1] == pytest.approx(1500.0 * depth * 0.6 * surface, rel=0.02)
    # Across it rests: the normal force is that of the weight; the same (h/H)^2.
    weight = 1500.0 * normal * 0.5 * depth**2
    assert -history["gate.force_x"][-1] == pytest.approx(weight, rel=0.01)


@pytest.mark.slow
def test_driven_cavity(mpm3d: Run, tmp_path: Path) -> None:
    """The vortex turns as much around as a slow flow under a lid does, and what the row carries."""
    folder, _ = run_config(mpm3d, "driven_cavity", tmp_path)
    frames = read_series(folder, "fpd", 0, "glycerine")
    speed, side, cells = 0.1111, 0.1, 20
    # The mean over the last half of the time, against the noise of the points, of the velocity
    # across the vertical line through the middle, a row of cells after the other.
    late = frames[len(frames) // 2 :]
    x = np.concatenate([frame.positions for frame in late]) / side
    v = np.concatenate([frame.fields["velocity"] for frame in late]) / speed
    middle = np.abs(x[:, 0] - 0.5) < 1.0 / cells
    rows = np.minimum((cells * x[:, 1]).astype(int), cells - 1)
    u = np.array([v[middle & (rows == row), 0].mean() for row in range(cells)])
    stream = np.cumsum(u) / cells
    # What flows back below the eye of the vortex: 0.1 U L under a lid that is a line (Stokes flow;
    # at a Reynolds number of 10 the same to 1 %), and U h of the row of cells that is the lid here,
    # the end of which is as sharp as half a cell.
    assert -stream.min() == pytest.approx(0.1 + 1.0 / cells, abs=0.5 / cells)
    # What goes in one direction comes back in the other.
    assert abs(stream[-1]) < 0.25 / cells


@pytest.mark.slow
def test_standing_wave(mpm3d: Run, tmp_path: Path) -> None:
    """The wave swings with the period of gravity waves."""
    folder, _ = run_config(mpm3d, "standing_wave", tmp_path)
    frames = read_series(folder, "fpd", 0, "water")
    number, h, amplitude = 2.0 * math.pi / 0.4, 0.0125, 0.02
    expected = 2.0 * math.pi / math.sqrt(GRAVITY * number * math.tanh(0.2 * number))
    # The part of the motion that has the wavelength: a (cos(2 pi t/T) - 1) with the best T.
    shape = frames[0].fields["mass"] * np.cos(number * (frames[0].positions[:, 0] - 0.2))
    wave = np.array([shape @ frame.fields["displacement"][:, 1] for frame in frames])
    time = np.array([frame.time for frame in frames])

    def misfit(period: float) -> float:
        """Give the sum of squares that a period leaves."""
        columns = np.column_stack([np.ones_like(time), np.cos(2.0 * math.pi * time / period)])
        rest = wave - columns @ np.linalg.lstsq(columns, wave, rcond=None)[0]
        return float(rest @ rest)

    period = min(np.linspace(0.7, 1.4, 701) * expected, key=misfit)
    # The surface is as sharp as a cell: parts of (k h)^2 = 4 %; height adds (k a)^2/8 = 1 %.
    assert period == pytest.approx(expected, rel=(number * h) ** 2 + (number * amplitude) ** 2 / 8)
    # At the crest the probe follows a point.
    history = table(folder / "standing_wave.history.csv")
    assert history["crest.y"].max() - history["crest.y"].min() > 1.5 * amplitude


@pytest.mark.slow
def test_two_heaps(mpm3d: Run, tmp_path: Path) -> None:
    """The heap below the angle of repose stays, the one above falls to it."""
    folder, _ = run_config(mpm3d, "two_heaps", tmp_path)
    flat = read_series(folder, "fpd", 0, "flat")
    steep = read_series(folder, "fpd", 1, "steep")
    # rho g H/E = 1e-3 of strain, over 0.06 m.
    assert np.abs(flat[-1].fields["displacement"]).max() < 1e-3 * 0.06 * 1.5
    # 2 % of a triangle lie beyond 1 - sqrt(0.02) of its half width.
    x = np.abs(steep[-1].positions - [0.75, 0.0, 0.0])
    slope = x[:, 1].max() / np.quantile(x[:, 0], 0.98) * (1.0 - math.sqrt(0.02))
    # From 1 to between the friction at rest, less a tail of single grains, and that of fast flow.
    assert 0.9 * 0.3819 < slope < 0.6435
    assert np.abs(mean(steep[-1], "velocity")).max() < 0.01


@pytest.mark.slow
def test_spinning_rings(mpm3d: Run, tmp_path: Path) -> None:
    """Hoop stress balances rotation; without it a ring breathes as a mass on a spring."""
    folder, _ = run_config(mpm3d, "spinning_rings", tmp_path)
    radius, rate, modulus, density = 0.5, 10.0, 1e6, 1000.0
    means = {}
    for number, name in enumerate(["tight", "slack"]):
        with h5py.File(folder / f"points.{number}.{name}.vtkhdf") as file:
            steps = file["VTKHDF/Steps"]
            assert steps.attrs["NSteps"] == 61
            time = steps["Values"][:]
            u = file["VTKHDF/PointData/displacement"][:, 0].reshape(len(time), -1)
            means[name] = u.mean(axis=1)

    def tension(stretch: float) -> float:
        """Give the force over the area of the start of a neo-Hookean bar."""
        shear = modulus / 2.6
        lame = modulus * 0.3 / (1.3 * 0.4)
        # The square b of the stretch of its thickness leaves no stress across.
        b = root(lambda b: shear * (b - 1.0) + lame * math.log(stretch * b), 0.5, 1.5)
        return (shear * (stretch**2 - 1.0) + lame * math.log(stretch * b)) / stretch

    # Thin ring: r'' = rate^2 R^4/r^3 - T/(rho R), from r = R at rest; midpoint steps.
    r, v, n = radius, 0.0, 20
    dt = time[-1] / (60 * n)
    exact = [0.0]
    for _ in range(60):
        for _ in range(n):
            r += 0.5 * dt * v
            v += dt * (rate**2 * radius**4 / r**3 - tension(r / radius) / (density * radius))
            r += 0.5 * dt * v
        exact.append(r - radius)
    assert np.abs(means["tight"]).max() < 0.02 * max(exact)
    np.testing.assert_allclose(means["slack"], exact, atol=0.03 * max(exact))
    # Checkpoints at 0.1, 0.2 and 0.3 s, of which two are kept.
    assert len(list(folder.glob("*.h5"))) == 2


def test_sagging_beam(mpm3d: Run, tmp_path: Path) -> None:
    """The beam sags as theory has it; without smoothing it would lock."""
    folder, _ = run_config(mpm3d, "sagging_beam", tmp_path)
    frames = read_series(folder, "fpd", 0, "beam")
    length, depth, modulus, poisson, weight = 0.4, 0.1, 2e6, 0.49, 1000.0 * GRAVITY
    plane = modulus / (1.0 - poisson**2)
    shear = modulus / (2.0 * (1.0 + poisson))
    # Bending and shear (Timoshenko, shear factor 5/6).
    sag = 1.5 * weight * length**4 / (plane * depth**2) + 0.6 * weight * length**2 / shear
    tip = frames[0].positions[:, 0] > length - 0.0125
    assert tip.sum() == 8
    found = -float(np.mean(frames[-1].fields["displacement"][tip, 1]))
    assert found == pytest.approx(sag, rel=0.1)
    # At rest.
    assert np.abs(frames[-1].fields["velocity"]).max() < 1e-3 * sag * 32.5


def tillotson(density: float, energy: float) -> float:
    """Pressure of compressed water with the constants of the scene water_shock."""
    eta = density / 998.0
    mu = eta - 1.0
    return (
        (0.7 + 0.15 / (energy / (7e6 * eta**2) + 1.0)) * density * energy
        + 2.18e9 * mu
        + 1.325e10 * mu**2
    )


def test_water_shock(mpm3d: Run, tmp_path: Path) -> None:
    """Pressure, density and place of the shock are those of Rankine and Hugoniot."""
    folder, _ = run_config(mpm3d, "water_shock", tmp_path)
    frames = read_series(folder, "fpd", 0, "water")
    speed, start = 500.0, 998.0

    def off(density: float) -> float:
        """Give the pressure above that of momentum, p = rho0 us u."""
        # us is the speed of the shock relative to the water: rho0 us = rho (us - u).
        shock = speed * density / (density - start)
        pressure = start * shock * speed
        return tillotson(density, 0.5 * speed**2) - pressure

    density = root(off, 1.05 * start, 1.6 * start)
    shock = speed * density / (density - start)
    pressure = start * shock * speed
    # Frames at exactly their times.
    np.testing.assert_allclose(
        [frame.time for frame in frames], np.arange(len(frames)) / 5e4, rtol=1e-12, atol=1e-18
    )
    last = frames[-1]
    order = np.argsort(last.positions[:, 0])
    x, p = last.positions[order, 0] - 0.5, last.fields["pressure"][order]
    front = (shock - speed) * last.time
    behind = np.abs(x) < front - 0.04
    assert behind.sum() > 30
    # Artificial viscosity spreads the front, not the state behind it.
    volume = last.fields["volume"][order][behind]
    mass = last.fields["mass"][order][behind]
    assert float(volume @ p[behind] / volume.sum()) == pytest.approx(pressure, rel=0.02)
    assert float(mass.sum() / volume.sum()) == pytest.approx(density, rel=0.01)
    assert float(np.interp(-0.5 * pressure, -p[x > 0.1 * front], x[x > 0.1 * front])) == (
        pytest.approx(front, abs=0.02)
    )
    # Before it nothing has happened, but for what the viscosity spreads over some cells.
    middle = frames[len(frames) // 2]
    x = np.abs(middle.positions[:, 0] - 0.5)
    ahead = (x > (shock - speed) * middle.time + 0.06) & (x < 0.35)
    assert ahead.sum() > 10
    assert np.abs(middle.fields["pressure"][ahead]).max() < 0.01 * pressure


@pytest.mark.slow
def test_crushed_sand(mpm3d: Run, tmp_path: Path) -> None:
    """No state is beyond the yield surface, grains break, and pores close."""
    folder, _ = run_config(mpm3d, "crushed_sand", tmp_path)
    frames = read_series(folder, "fpd", 1, "sand")
    p_r, bulk, shear, energy, m_0, gamma = 1e3, 12000.0, 9000.0, 3.5e4, 1.2, 0.9
    phi_l, phi_u, low, up, theta, rho_0 = 0.25, 0.5, 0.2, 0.1, 0.85, 2650.0
    broken = np.array([mean(frame, "B") for frame in frames])
    pores = np.array([mean(frame, "phi") for frame in frames])
    # Breakage does not heal.
    assert np.all(np.diff(broken) > -1e-9)
    assert broken[0] == 0.0
    assert 0.01 < broken[-1] < 0.9
    assert pores[-1] < pores[0] - 0.005
    angle = math.pi / 15.0 + math.asin(3.0 * m_0 / (6.0 + m_0))
    steepest = 6.0 * math.sin(angle) / (3.0 - math.sin(angle)) - m_0
    largest = []
    for frame in frames[1:]:
        b, phi = frame.fields["B"], frame.fields["phi"]
        strain = (frame.fields["Be"].reshape(-1, 3, 3) - np.eye(3)) / 2.0
        e_v = np.trace(strain, axis1=1, axis2=2)
        dev = strain - e_v[:, None, None] * np.eye(3) / 3.0
        e_s = np.sqrt(2.0 / 3.0 * np.sum(dev**2, axis=(1, 2)))
        touching = e_v < 0.0
        ev, es = e_v[touching], e_s[touching]
        a = -bulk / 2.0 * (ev + 1e-3 * np.log(1.0 - ev / 1e-3))
        stored = (
            2.0 * a**3 / (3.0 * bulk)
            + 1.5 * shear * a * es**2
            + 0.25 * shear * math.sqrt(3.0 * bulk * shear) * es**3
        )
        b, phi = b[touching], phi[touching]
        density = frame.fields["density"][touching] / rho_0
        e_b = density * theta * p_r * stored
        p, q = frame.fields["p"][touching], frame.fields["q"][touching]
        least, most = phi_l * (1.0 - b) ** low, phi_u * (1.0 - b) ** up
        tau = (most - phi) / (most - least)
        m_d = gamma * (tau - (1.0 - b) * np.sqrt(e_b / energy) / gamma) * steepest
        m = np.maximum(m_0 + m_d, m_0 / 1000.0)
        y = e_b * (1.0 - b) ** 2 / energy + (q / (m * p)) ** 2 - 1.0
        largest.append(float(y.max()))
    # Frames have ten digits, of which e_v = 1 % takes two, and the energy is its third power.
    assert max(largest) < 1e-6
    assert largest[-1] > -0.05


@pytest.mark.slow
def thickened(rate: float) -> tuple[float, float, float]:
    """Return contacts, pressure and shear stress of the scene thickening_layer in steady shear."""
    packing, viscosity = 0.5, 1e-3

    def state(c: float) -> tuple[float, float]:
        a, jammed = 0.2 + 0.8 * c, 0.6 - 0.05 * c
        pressure = (1600.0 * 1e-10 * rate**2 + 2.0 * viscosity * rate) / (
            (jammed / packing - 1.0) / a
        ) ** 2
        mixed = (jammed / packing - 1.0) / a
        friction = 0.5 + 2.5 * packing * (rate * viscosity / pressure) / (a * mixed)
        return pressure, friction * pressure

    def off(c: float) -> float:
        stress = state(c)[1]
        made = (stress / 10.0) ** 1.5 * rate
        return made / (made + rate + 1e-3 * (0.6 - packing) * stress) - c

    contacts = root(off, 0.0, 1.0)
    return contacts, *state(contacts)


@pytest.mark.slow
def test_thickening_layer(mpm3d: Run, tmp_path: Path) -> None:
    """The stress is that of the closed form: 14 times the viscosity at 5 times the rate."""
    viscosity = {}
    for rate, tolerance in ((1000.0, 0.02), (200.0, 0.15)):
        folder, _ = run_config(mpm3d, "thickening_layer", tmp_path / "fast")
        if rate < 1000.0:
            # The points begin with the speeds of a slower plate.
            scene = tmp_path / "fast" / "configs" / "thickening_layer"
            script = scene / "make_points.sh"
            script.write_text(script.read_text().replace("1000*y", "200*y"))
            config = scene / "thickening_layer.cfg"
            config.write_text(
                config.read_text().replace(
                    "boundary-props = {1, 0, 0}", "boundary-props = {0.2, 0, 0}"
                )
            )
            folder, _ = run_config(mpm3d, "thickening_layer", tmp_path / "fast")
        contacts, pressure, stress = thickened(rate)
        frame = read_series(folder, "fpd", 0, "starch")[-1]
        history = table(folder / "thickening_layer.history.csv")
        # The packing at the probe drifts by 5e-4, and p goes as (phi_m/phi - 1)^-2, which makes 1 %
        # of it. In the slow run there is time for a shear of 2 only: exp(-2) = 14 % of the way to
        # the contacts are left.
        assert float(np.mean(frame.fields["c"])) == pytest.approx(contacts, rel=1.5 * tolerance)
        assert history["middle.pressure"][-1] == pytest.approx(pressure, rel=tolerance)
        assert history["middle.stress_xy"][-1] == pytest.approx(stress, rel=tolerance)
        viscosity[rate] = history["middle.stress_xy"][-1] / rate
    assert viscosity[1000.0] > 10.0 * viscosity[200.0]


def momentum(frames: list[Frame]) -> Array:
    """Return the momentum of bodies."""
    return sum(frame.fields["mass"] @ frame.fields["velocity"] for frame in frames)


@pytest.mark.slow
def test_swimming_fish(mpm3d: Run, tmp_path: Path) -> None:
    """The fish gets ahead by pushing water back: the mass centre of both stays."""
    folder, _ = run_config(mpm3d, "swimming_fish", tmp_path)
    fish = read_series(folder, "fpd", 0, "fish")
    water = read_series(folder, "fpd", 1, "water")
    mass = fish[0].fields["mass"].sum() + water[0].fields["mass"].sum()
    for frame, other in zip(fish, water, strict=True):
        # Round-off of 1,250 steps with speeds of 0.1 m/s, and ten digits in a frame.
        assert np.abs(momentum([frame, other])).max() < 1e-10 * mass
        moved = [
            body.fields["mass"] @ body.fields["displacement"] / mass for body in (frame, other)
        ]
        assert np.abs(moved[0] + moved[1]).max() < 1e-10
    samples = table(folder / "samples.csv")
    assert len(samples["sample"]) == 2
    # The first run is that of the frames.
    assert samples["displacement_x"][0] == pytest.approx(
        mean(fish[-1], "displacement")[0], rel=1e-8
    )
    # What rounding errors do is a billion times less (see fish_in_space).
    assert np.abs(samples["displacement_x"]).min() > 1e-4


def test_fish_in_space(mpm3d: Run, tmp_path: Path) -> None:
    """Without water it bends, and stays where it is."""
    folder, _ = run_config(mpm3d, "fish_in_space", tmp_path)
    samples = table(folder / "samples.csv")
    assert len(samples["sample"]) == 4
    # Both kinds of the mixture, which differ in the frequency.
    assert samples["beta_h"].min() < 18.0 < samples["beta_h"].max()
    # Round-off of 1,000 steps.
    for direction in ("displacement_x", "displacement_y"):
        assert np.abs(samples[direction]).max() < 1000 * 64 * EPSILON
    frames = read_series(folder, "fpd", 0, "fish")
    assert max(np.abs(frame.fields["displacement"]).max() for frame in frames) > 0.01


@pytest.mark.slow
def test_loose_column(mpm3d: Run, tmp_path: Path) -> None:
    """Loose sand under water contracts as it starts to flow: the water takes over its weight."""
    folder, _ = run_config(mpm3d, "loose_column", tmp_path)
    loose = collapse(folder)
    # As dense as sand is: 0.6.
    scene = tmp_path / "configs" / "loose_column"
    for name, changes in (
        ("make_points.sh", [("--density 1400", "--density 1500"), ('"440 if', '"400 if')]),
        ("loose_column.cfg", [("{0.6, 2500, 0.56, 1000}", "{0.6, 2500, 0.6, 1000}")]),
    ):
        text = (scene / name).read_text()
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (scene / name).write_text(text)
    dense = collapse(run_config(mpm3d, "loose_column", tmp_path)[0])
    # Buoyant weight of the grains at the foot.
    weight = 0.56 * 1500.0 * GRAVITY * 0.06
    early = slice(1, 4)
    assert 0.25 * weight < float(np.mean(loose[1][early])) < weight
    assert float(np.mean(dense[1][early])) < 0.25 * float(np.mean(loose[1][early]))
    assert np.all(loose[0][1:] > dense[0][1:])
    assert loose[0][-1] - 0.06 > 1.5 * (dense[0][-1] - 0.06)
    # Dense sand dilates.
    assert dense[2][-1] < dense[2][0] - 0.01


def collapse(folder: Path) -> tuple[Array, Array, Array]:
    """Return front, pressure at the foot above that of water at rest, and packing, by frames."""
    sand = read_series(folder, "fpd", 0, "sand")
    water = read_series(folder, "fpd", 1, "water")
    pressure = []
    for frame in water:
        x = frame.positions
        foot = (x[:, 0] < 0.04) & (x[:, 1] < 0.015)
        depth = x[:, 1].max() + 0.0025 - x[foot, 1]
        pressure.append(np.mean(frame.fields["pressure"][foot] - 1000.0 * GRAVITY * depth))
    front = [np.quantile(frame.positions[:, 0], 0.99) for frame in sand]
    packing = [mean(frame, "packing_fraction") for frame in sand]
    return np.array(front), np.array(pressure), np.array(packing)


@pytest.mark.slow
def test_two_intruders(mpm3d: Run, tmp_path: Path) -> None:
    """Half a cylinder at a plane of symmetry goes as deep as a whole one."""
    folder, _ = run_config(mpm3d, "two_intruders", tmp_path)
    half = read_series(folder, "fpd", 0, "half")
    whole = read_series(folder, "fpd", 1, "whole")
    other, _ = run_config(mpm3d, "half_intruder", tmp_path)
    alone = read_series(other, "fpd", 0, "half")
    paths = np.array(
        [[mean(frame, "displacement")[1] for frame in body] for body in (half, whole, alone)]
    )
    # The planes between them are planes of symmetry, but for rounding errors, which grow in 2,000
    # steps with contacts that open and close: a hundredth of a cell.
    np.testing.assert_allclose(paths[1], paths[0], rtol=0.0, atol=1e-4)
    # The solver for mixtures has the same equations; the pressure of its fluid follows another
    # way: a part of a cell.
    np.testing.assert_allclose(paths[2], paths[0], rtol=0.0, atol=5e-4)
    # They fall freely for 1.25 cm or a cell less, hit the bed and come to rest in it.
    assert -0.06 < paths[0][-1] < -0.0125
    late = paths[0][-5:]
    assert float(late.max() - late.min()) < 5e-4
    assert abs(mean(half[-1], "velocity")[1]) < 0.02


def test_rubber_disc(mpm3d: Run, tmp_path: Path) -> None:
    """A parabola, a bounce with all of its steps in frames, and a parabola."""
    folder, _ = run_config(mpm3d, "rubber_disc", tmp_path)
    frames = read_series(folder, "fpd", 0, "disc")
    window = [frame for frame in frames if 0.06 < frame.time < 0.09]
    assert len(window) in (149, 150)
    for frame in frames:
        v = mean(frame, "velocity")
        # Nothing pushes along the smooth floor.
        assert v[0] == pytest.approx(3.0, abs=1e-9)
        if frame.time < 0.05:
            assert v[1] == pytest.approx(-4.0 - GRAVITY * frame.time, abs=1e-9)
    # At the same height it is slower: the impact leaves swings, most of which the grid takes.
    before, after = (next(f for f in frames if abs(f.time - t) < 1e-9) for t in (0.05, 0.1))
    assert mean(before, "displacement")[1] == pytest.approx(
        mean(after, "displacement")[1], abs=1e-3
    )
    assert 0.8 < -mean(after, "velocity")[1] / mean(before, "velocity")[1] < 1.0
    # The floor stops it before it is reached.
    assert min(float(frame.positions[:, 1].min()) for frame in frames) > 0.0
