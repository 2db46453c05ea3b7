"""The scenes that show the classes one by one do what their READMEs say."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from frames import Frame, read_series
from project_scene import run_config
from scene import EPSILON, GRAVITY, Array, Run


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
