"""Two elastic discs collide as parts of one body."""

from __future__ import annotations

import numpy as np
from _contact import reach, sums
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below, near
from harness.scene import DIM, Body, Points, Scene, lattice, pressure_wave_modulus, stable_dt

RADIUS, YOUNG, POISSON, DENSITY, SPEED = 0.2, 1000.0, 0.3, 1000.0, 0.1
CENTRES = (0.2, 0.8)
STOP, FRAMES = 3.0, 120
#: Kinetic energy of a published run with linear functions, h = 0.05: times and values over 2.6.
COURSE = {1.5: 2.212, 1.75: 0.735, 2.0: 0.169, 2.25: 1.613, 2.5: 2.375}
START = 2.6
#: Time at which the circles touch.
TOUCH = (0.6 * np.sqrt(2.0) - 2.0 * RADIUS) / (2.0 * np.sqrt(2.0) * SPEED)


def scene(p: Parameters) -> Scene:
    """Two discs, both points of one body, so that they meet in one field of velocity.

    In TYPE 3 they are a cell thick between smooth walls.
    """
    dim, n = DIM[p.sim_type], p.cells * p.ppc
    h = 1.0 / p.cells
    lengths, cells, counts = [1.0, 1.0, h][:dim], [p.cells, p.cells, 1][:dim], [n, n, p.ppc][:dim]
    box = lattice(p.sim_type, [0.0] * dim, lengths, counts, DENSITY)
    discs = []
    for centre, sign in zip(CENTRES, (1.0, -1.0), strict=True):
        disc = box.keep(np.sum((box.x[:, :2] - centre) ** 2, axis=1) < RADIUS**2)
        disc.velocity[:, :2] = sign * SPEED
        discs.append(disc)
    points = Points(
        p.sim_type,
        *(
            np.concatenate([getattr(disc, name) for disc in discs])
            for name in ("x", "volume", "mass", "velocity")
        ),
    )
    sides = 'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {-1, -1, -1, -1, 1, 1}'
    wave = float(np.sqrt(pressure_wave_modulus(YOUNG, POISSON) / DENSITY))
    return Scene(
        p.sim_type,
        lengths,
        cells,
        [Body("discs", points, YOUNG, POISSON, sides if dim == 3 else "")],
        STOP,
        stable_dt(1.0, p.cells, wave, STOP, p.number("cfl", 0.1), FRAMES),
        FRAMES,
        p.mapping,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Energies over time per unit thickness, momentum, and symmetry about the middle."""
    thick = 1.0 / p.cells if p.sim_type == 3 else 1.0
    rows, mirror = [], 0.0
    for frame in out.points():
        state = sums(out, 0, frame)
        rows.append([state.time, state.kinetic, state.strain, np.max(np.abs(state.momentum))])
        half = len(frame.x) // 2
        if p.sim_type == 2:  # the lattice of one disc is that of the other backwards
            velocity = frame["velocity"]
            mirror = max(mirror, float(np.max(np.abs(velocity[:half] + velocity[: half - 1 : -1]))))
    t, kinetic, strain, momentum = np.array(rows).T
    total, least = kinetic + strain, int(np.argmin(kinetic))
    measures = {
        "points_per_disc": 0.5 * len(frame.x) / (p.ppc if p.sim_type == 3 else 1),
        "start": kinetic[0] / thick,
        "momentum": float(np.max(momentum)) / (state.mass * SPEED),
        "mirror": mirror / SPEED,
        "end": kinetic[-1] / kinetic[0],
        "least": kinetic[least] / kinetic[0],
        "time_of_least": vertex(t, kinetic),
        "strain_max": float(np.max(strain)) / thick,
        "time_of_strain_max": vertex(t, -strain),
        "total_max": float(np.max(total)) / total[0],
        "half_step": 0.5 * out.scene.dt * float(np.max(np.abs(np.gradient(kinetic, t)))) / total[0],
        "total_loss": 1.0 - total[-1] / total[0],
        "first_loss": float(np.interp(0.001, 1.0 - kinetic[:least] / kinetic[0], t[:least])),
    }
    for time in np.arange(0.0, STOP + 1e-9, 0.125):
        measures[f"kinetic_{time:.3f}"] = float(np.interp(time, t, kinetic)) / kinetic[0]
        measures[f"strain_{time:.3f}"] = float(np.interp(time, t, strain)) / kinetic[0]
    return measures


def vertex(t: np.ndarray, y: np.ndarray) -> float:
    """Return the time of the least value by a parabola through its neighbours."""
    i = int(np.argmin(y))
    a, b, _ = np.polyfit(t[i - 1 : i + 2] - t[i], y[i - 1 : i + 2], 2)
    return float(t[i] - 0.5 * b / a)


def judge(r: Results) -> list[Finding]:
    """Conservation, and the published course at the resolution that it is for."""
    findings = []
    for p, m in r:
        findings += judge_run(p, m, f"{p.cells} cells")
    if len(r.cells) > 1 and r.first.mapping == "cpdi":
        findings += [
            Finding(
                "order of the loss of total energy",
                r.order("total_loss"),
                0.8,
                reason="loss in the layer in which the discs meet, and by the filter of the "
                "method: at least of first order",
                expected=1.0,
            ),
        ]
    return findings


def is_damped(p: Parameters) -> bool:
    """Tell whether the transfer is another than FLIP."""
    return p.scheme.transfer != "FLIP" or p.scheme.flip < 1.0


def judge_run(p: Parameters, m: Measures, label: str) -> list[Finding]:
    """Compare one run."""
    gap = (TOUCH - m["first_loss"]) * 2.0 * np.sqrt(2.0) * SPEED * p.cells
    findings = [
        below(f"momentum, {label}", m["momentum"], 1e-13, "forces inside a body"),
        below(
            f"largest total energy over that of the start, {label}",
            m["total_max"],
            1.0 + m["half_step"],
            "no source of energy; stress and velocity lie half a step apart: dt/2 times the power",
        ),
        Finding(
            f"gap at 0.1 % loss of kinetic energy/h, {label}",
            float(gap),
            0.0,
            2.0 * np.sqrt(2.0) * reach(p.ppc, p.mapping),
            reason="the discs meet when they reach one node, along the diagonal at most "
            "2 sqrt(2) times the reach of a point",
        ),
        Finding(
            f"total energy at the end, {label}",
            1.0 - m["total_loss"],
            0.0 if p.ppc == 1 or is_damped(p) else 1.0 - 0.1 * reach(p.ppc, p.mapping),
            1.0 if p.scheme.solver == "USL" else 1.0 + m["half_step"],
            reason="published runs of linear functions keep 0.92 as kinetic energy and 0.05 as "
            "strain energy; the layer in which the discs meet is as thick as the reach; no source "
            "of energy, but MUSL and USF lose little: as above",
        ),
    ]
    if p.sim_type == 2 and p.mapping == "cpdi":
        findings.append(
            below(
                f"mirror error over v, {label}",
                m["mirror"],
                1e-8,
                "point symmetry of the set-up; roundings grow in the collision",
            )
        )
    if p.cells != 20 or p.ppc != 2 or p.mapping not in ("linear", "cpdi"):
        return findings
    if is_damped(p):
        name = f"kinetic energy at the end over that at the start, {label}"
        least = Finding(name, m["end"], 0.0, 0.90)
        least.reason = "less than with FLIP: velocities that the fit does not hold are lost"
        return [*findings, least]
    findings += [
        near(f"points of a disc, {label}", m["points_per_disc"], 208.0, 0.0, "lattice"),
        near(f"kinetic energy at the start, {label}", m["start"], START, 1e-12, "208 points"),
        Finding(
            f"kinetic energy at the end over that at the start, {label}",
            m["end"],
            0.90,
            0.98,
            0.920,
            "published 0.920; the range of published runs",
        ),
        Finding(
            f"time of the least kinetic energy, {label}",
            m["time_of_least"],
            1.90,
            2.00,
            1.938,
            "published 1.938",
        ),
        near(
            f"largest strain energy, {label}",
            m["strain_max"],
            2.349,
            0.03,
            "published 2.349; 3 %: law of the rotation and definition of strain energy",
        ),
    ]
    for time, value in COURSE.items():
        findings.append(
            Finding(
                f"kinetic energy at {time}, {label}",
                m[f"kinetic_{time:.3f}"] * START,
                value - 0.13,
                value + 0.13,
                value,
                "published; 5 % of the start: a shift in time of 0.02, two thirds of h/c",
            )
        )
    return findings


CASE = Case(
    family="Elastic discs",
    title="Two elastic discs",
    statement=r"""
Two discs of radius 0.2 in the unit square, centres (0.2, 0.2) and (0.8, 0.8), velocities
$\pm(0.1, 0.1)$, $E = 1000$, $\nu = 0.3$, $\rho = 1000$, plane strain, cells of 0.05. They are
points of one body: there is no contact law, and they meet in one velocity field. TYPE 3: a slice
of one cell between smooth walls, TYPE 5: the same in 2.5D; both must agree with TYPE 2.

**Exact**: total momentum 0, point symmetry, total energy at most that of the start. The circles
touch at $t = 1.586$; the method brings them into touch earlier, when points of both reach one
node, at a gap of at most $2\sqrt2$ times the reach of a point.

**Published course** (a run of another code with linear functions at $h = 0.05$, as stored with
it; not the paper's figure): kinetic energy 2.600 at the start (208 points a disc; 2.513 for
circles), 2.212, 0.735, 0.169, 1.613, 2.375 at $t$ = 1.5, 1.75, 2, 2.25, 2.5; least at 1.938;
0.920 of the start at $t = 3$; largest strain energy 2.349. That code differs in details (rotation
of stress, when stresses are updated), hence tolerances of 5 % of the energy and $\pm 0.05$ in
time.

**Refinement**: the loss of *total* energy goes to 0, with order 1 or better. The *kinetic* energy
at $t = 3$ does not rise with refinement, because the discs vibrate after the collision and meet
later. Strain energy is $\tfrac12 \sigma : C^{-1} : \sigma\, V$. With the linear functions edges
that hardly move can gain energy (stress updated last), so that they run at the published
resolution only, with a small step.
""",
    source="Sulsky, Chen and Schreyer, CMAME 118 (1994) 179-196, problem only; course: stored "
    "results of a public MATLAB code (mpmat).",
    scene=scene,
    measure=measure,
    judge=judge,
    error="total_loss",
    order=1.0,
)
