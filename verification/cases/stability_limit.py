"""Time steps below and above the stability limit, on grids filled with points."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from functools import cache

import numpy as np
from _scheme import LinearScheme
from _waves import DENSITY, SLIP, STICK, YOUNG, Walls, symbols, walls_reflect, wave_speed
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.norms import linf
from harness.scene import DIM, Body, Scene, lattice, pressure_wave_modulus, shear_modulus
from harness.steps import ModeSteps

#: Cells along each direction when the row does not say.
CELLS = {1: 24, 2: 8, 3: 5, 4: 6, 5: 8}
#: Frames; of schemes that grow fast, more.
STEPS, FRAMES, MANY_FRAMES = 1500, 60, 150
#: Velocities at the start, over the speed of waves.
NOISE = 1e-10
STABLE_STEP = re.compile(r"stable step (\S+) s")


def counts(p: Parameters) -> list[int]:
    """Return the cells of the grid; in TYPE 4 the height does not matter."""
    n = int(p.number("grid", CELLS[p.sim_type]))
    return [n, 3] if p.sim_type == 4 else [n] * DIM[p.sim_type]


def spacing(p: Parameters) -> list[float]:
    """Return the sizes of the cells; `flat` shortens them along the last direction."""
    h = [1.0 / counts(p)[0]] * DIM[p.sim_type]
    h[-1] *= p.number("flat", 1.0)
    return h


def scene_with(p: Parameters, dt: float) -> Scene:
    """Return a filled grid with smooth walls and noise in the velocities."""
    cells, h = counts(p), spacing(p)
    shift = p.number("shift", 0.0)
    lengths = [n * s for n, s in zip(cells, h, strict=True)]
    points = lattice(
        p.sim_type,
        [shift * s for s in h],
        [(n + shift) * s for n, s in zip(cells, h, strict=True)],
        [n * p.ppc for n in cells],
        DENSITY,
    )
    noise = np.random.default_rng(1).uniform(-1.0, 1.0, points.velocity.shape)
    points.velocity[:] = NOISE * wave_speed(p) * noise
    seams = has_seams(p)
    wall = "" if seams else walls(p).section()
    body = Body("body", points, YOUNG, p.number("nu", 0.0), wall)
    frames = FRAMES if is_plain(p) else MANY_FRAMES
    made = Scene(p.sim_type, lengths, cells, [body], STEPS * dt, dt, frames, p.mapping)
    made.box, made.periodic = 1.0 / p.ppc, [seams] * len(cells)
    return made


def has_seams(p: Parameters) -> bool:
    """Tell whether the grid repeats: by default for splines, waves of which walls would mix."""
    default = "slip" if walls_reflect(p) else "seams"
    return p.sim_type != 4 and p.text("walls", default) == "seams"


def walls(p: Parameters) -> Walls:
    """Return walls all around.

    Points that are shifted along a smooth wall leave its nodes little mass; no slip holds them.
    """
    code = STICK if p.text("walls", "slip") == "stick" else SLIP
    return Walls([code] * (2 * DIM[p.sim_type]))


def needs_matrices(p: Parameters) -> bool:
    """Tell whether waves do not split: around an axis, of shifted points or splines at walls."""
    split = p.number("shift", 0.0) == 0.0 and walls_reflect(p)
    return p.sim_type == 4 or not (split or has_seams(p))


def waves(p: Parameters) -> list[ModeSteps]:
    """Return all waves between walls, of symmetric points, or with seams, with stiffness for K.

    Components are sines along themselves and cosines along the other directions.
    """
    cells, h, nu = counts(p), spacing(p), p.number("nu", 0.0)
    if p.sim_type == 1:
        scale, turn = wave_speed(p) ** 2 / h[0] ** 2, np.pi * (2.0 if has_seams(p) else 1.0)
        shift = p.number("shift", 0.0)
        found = [
            ModeSteps.of(p.scheme, turn * j / cells[0], p.ppc, shift, p.mapping)
            for j in range(1, cells[0])
        ]
        return [replace(one, k2=scale * one.k2) for one in found]
    if p.scheme.transfer in ("APIC", "MLS"):
        raise ValueError("affine fields have no closed form in several directions here")
    m, g = pressure_wave_modulus(YOUNG, nu), shear_modulus(YOUNG, nu)
    dim, result, seams = len(cells), [], has_seams(p)
    # Half waves between walls; whole ones with seams, where k and -k are alike.
    turn, shift = (2.0 if seams else 1.0) * np.pi, p.number("shift", 0.0)
    for numbers in itertools.product(*[range(n if seams else n + 1) for n in cells]):
        means = [
            symbols(turn * j / n, p.ppc, shift, p.mapping)
            for j, n in zip(numbers, cells, strict=True)
        ]
        mu = float(np.prod([one.mu for one in means]))
        gradients = np.zeros((dim, dim), dtype=complex)
        for a, b in itertools.product(range(dim), repeat=2):
            factors: list[complex] = [one.mu for one in means]
            if a == b:
                factors[a] = means[a].k2 / h[a] ** 2
            else:
                factors[a], factors[b] = means[a].mixed / h[a], np.conj(means[b].mixed) / h[b]
            gradients[a, b] = np.prod(factors)
        total = float(np.trace(gradients).real)
        lame = (m - 2.0 * g) * gradients
        stiffness = lame + g * gradients.T + g * total * np.eye(dim)
        live = [a for a in range(dim) if seams or 0 < numbers[a] < cells[a]]
        for value in np.linalg.eigvalsh(stiffness[np.ix_(live, live)]) if live else []:
            result.append(ModeSteps(p.scheme, float(value) / DENSITY, mu))
        if p.sim_type == 5:
            result.append(ModeSteps(p.scheme, g * total / DENSITY, mu))
    return result


def worst_place(p: Parameters) -> float:
    """Return the smallest limit c dt/h of waves along one direction for all places of points."""
    limits = [
        4.0 / ((2.0 - one.mu) * one.k2)
        for shift in np.linspace(0.0, 0.5 / p.ppc, 6)
        for kh in np.linspace(0.05, np.pi, 60)
        if (one := symbols(kh, p.ppc, shift, p.mapping)).k2 > 0.0
    ]
    return float(np.sqrt(min(limits)))


@cache
def scheme_of(key: tuple[object, ...]) -> LinearScheme:
    """Return the matrices of a run; `key` are its parameters without the resolution."""
    sim_type, mapping, ppc, options = key
    p = Parameters("stability_limit", sim_type, mapping, "-", ppc, 100, dict(options))
    return LinearScheme(scene_with(p, 1.0), walls(p).codes)


def scheme(p: Parameters) -> LinearScheme:
    """Return the matrices of a run."""
    return scheme_of((p.sim_type, p.mapping, p.ppc, tuple(sorted(p.options.items()))))


def limit(p: Parameters) -> float:
    """Return the largest stable time step."""
    shortest = min(spacing(p)) / wave_speed(p)
    if needs_matrices(p):
        return scheme(p).limit(0.2 * shortest, 2.5 * shortest)
    # Roundings make a stiffness of waves that have none.
    least = 1e-9 / shortest**2
    return min(wave.limit() for wave in waves(p) if wave.k2 > least)


def growth(p: Parameters, dt: float) -> float:
    """Return the factor by which the fastest growing wave grows in a step."""
    if needs_matrices(p):
        return scheme(p).growth(dt)
    return max(wave.growth(dt) for wave in waves(p))


def is_plain(p: Parameters) -> bool:
    """Tell whether the row has USL and FLIP."""
    return (p.scheme.solver, p.scheme.transfer, p.scheme.flip) == ("USL", "FLIP", 1.0)


def is_damped(p: Parameters) -> bool:
    """Tell whether a transfer takes velocities away in each step."""
    return p.scheme.flip < 1.0 or p.scheme.transfer in ("PIC", "XPIC")


def printed_limit(p: Parameters) -> float:
    """Return the step that other schemes than USL with FLIP print, over h/c.

    The steps of USL serve all of its transfers. With MUSL and USF a wave passes through the points:
    mu <= 1 - g s, g = (2/3)(1 - 1/n^2), wherever they lie, and c^2 K dt^2 <= 4 is safe for all but
    pure FLIP.
    """
    if p.scheme.solver == "USL":
        return 1.0 / float(np.sqrt(5.0 / 3.0 + 1.0 / (3.0 * p.ppc**2)))
    g = 2.0 / 3.0 * (1.0 - 1.0 / p.ppc**2)
    courant = 2.0 * np.sqrt(g) if g >= 0.5 else 1.0 / np.sqrt(1.0 - g)
    if p.scheme.transfer != "FLIP" or p.scheme.flip < 1.0:
        courant = 1.0
    h = np.array(spacing(p))
    return float(courant / np.sqrt(np.sum((min(h) / h) ** 2)))


def scene(p: Parameters) -> Scene:
    """Return the filled grid; the resolution is the time step in percent of the limit."""
    return scene_with(p, 0.01 * p.cells * limit(p))


def measure(p: Parameters, out: Output) -> Measures:
    """Return how the velocities grow, how the run ended, and what the program says of the step."""
    times, speeds = [], []
    start = NOISE * wave_speed(p)
    for frame in out.points():
        times.append(frame.time)
        speeds.append(linf(frame["velocity"]) / start)
    t, v = np.array(times), np.array(speeds)
    dt = out.scene.dt
    # The fastest wave rules where it has grown a thousandfold, and is small still.
    grown = (v > 1e3) & (np.maximum.accumulate(v) < 1e-3 / NOISE)
    rate = np.nan
    if np.count_nonzero(grown) >= 3:
        rate = float(np.polyfit(t[grown] / dt, np.log(v[grown]), 1)[0])
    printed = STABLE_STEP.search(out.text)
    unit = min(spacing(p)) / wave_speed(p)
    return {
        "growth": float(np.max(v[1:])) if len(v) > 1 else np.inf,
        "failed": float(out.status == 3),
        "warned": float("above the stable step" in out.errors),
        "rate": rate,
        "theory_rate": float(np.log(growth(p, dt))),
        "limit": limit(p) / unit,
        "shifted": float(p.number("shift", 0.0) > 0.0),
        "printed": (float(printed[1]) if printed else np.nan) / unit,
    }


def judge(r: Results) -> list[Finding]:
    """Compare with theory."""
    findings = []
    first = r.measures[0]
    safe = "safe, and within 20 % of where a grid filled with points turns unstable, for the worst "
    safe += "place of the points in their cells"
    lowest = 0.0
    if is_plain(r.first) and not first["shifted"]:
        lowest = 0.8 * min(1.0, worst_place(r.first) / first["limit"])
    if not is_plain(r.first):
        safe = "safe; wherever the points lie, hence less than the limit of these"
        wanted = printed_limit(r.first)
        name = "stable step of the program, c dt/h"
        reason = "closed form of the bound; digits printed"
        findings.append(near(name, first["printed"], wanted, 1e-4, reason))
    findings += [
        Finding(
            "stable step of the program over the limit",
            first["printed"] / first["limit"],
            lowest,
            1.0 + 1e-4 * (not is_plain(r.first)),
            np.nan,
            safe,
        ),
        Finding("limit c dt/h", first["limit"]),
    ]
    for p, m in r:
        label = f"{p.cells} % of the limit"
        if p.cells < 100:
            findings += [
                below(
                    f"growth, {label}",
                    m["growth"],
                    100.0,
                    f"all waves decay or stay over {STEPS} steps; 100 for what waves that are not "
                    "orthogonal add up to",
                ),
                below(f"failed, {label}", m["failed"], 0.0, "a stable run ends well"),
            ]
            continue
        findings += [
            Finding(
                f"failed, {label}",
                m["failed"],
                0.0 if m["shifted"] or is_damped(p) else 1.0,
                1.0,
                1.0,
                "waves grow until points run through cells, and the run stops with status 3; "
                "shifted points soon cross grid lines, which may change their limit; damped ones "
                "may come to rest where they are stable",
            ),
            Finding(
                f"growth, {label}",
                m["growth"],
                1e3,
                np.inf,
                np.nan,
                "waves grow from the noise until points cross cells",
            ),
            Finding(
                f"warned, {label}",
                m["warned"],
                1.0,
                1.0,
                1.0,
                "the program warns of a step above its limit, and names it when the run stops",
            ),
        ]
        if np.isfinite(m["rate"]):
            rate, margin = m["theory_rate"], 0.04 if has_seams(p) else 0.02
            growth = Finding(f"logarithm of the growth in a step, {label}", m["rate"])
            growth.expected, growth.high = rate, (1.0 + margin) * rate
            growth.low = (1.0 - margin if is_plain(p) else 0.8) * rate
            growth.reason = "largest eigenvalue of a step; 2 %: other waves in the fit, "
            growth.reason += "4 % with seams, where waves come in pairs"
            if not is_plain(p):
                growth.reason += ", 20 % where the fit has only 10 to 60 steps"
            findings.append(growth)
    return findings


CASE = Case(
    family="Hard cases",
    title="Time steps around the stability limit",
    statement=r"""
A grid filled with points, smooth walls all around, noise of $10^{-10}c$ in the velocities, 1500
steps. The resolution of this case is the time step in percent of the limit of theory. Measured: how
the velocities grow, how the run ends, and the stable step that the program prints.

Expected: a wave of the discrete equations with stiffness $K$ and filter $\mu$ is stable for
$K\Delta t^2 \le 4/(2-\mu)$. On symmetric points the worst of all waves runs along one direction, in
any dimension: $c\Delta t/h \le 1/\sqrt{s(1+bs)}$, $b = 2/3+1/(3n^2)$, $s = \cos^2(\pi/2N)$ on $N$
cells; waves in other directions are filtered more. Around an axis (TYPE 4), and with shifted
points, the limit is that of the eigenvalues of the linear scheme. Below it nothing grows; above it
the run fails with the growth of the largest eigenvalue, and the program has warned of it. The
printed step must be safe and within 20 % of the limit.

With a transfer that keeps $\nu$ of a wave and leaves $\beta$ of an increment (see the waves of
every integrator) the limit is $K\Delta t^2 \le 2(1+\nu)/(1+\nu-\beta)$ in USL and $\beta K\Delta
t^2 \le 2(1+\nu)$ in MUSL and USF, on hats with FLIP and $n$ = 1, 2, 3 points a cell
$c\Delta t/h$ = 2, 1.732, 1.678. The program prints what is safe for any places of the points.
""",
    source="Derived in `docs/verification.md`.",
    scene=scene,
    measure=measure,
    judge=judge,
    may_fail=True,
)
