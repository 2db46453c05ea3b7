"""A column of water that is let go."""

from __future__ import annotations

import math

import numpy as np
from harness.case import (
    Case,
    Finding,
    Measures,
    Output,
    Parameters,
    Published,
    Results,
    below,
    near,
)
from harness.scene import Body, Scene, lattice

#: Width and height of the column, density and gravity: units of the problem.
WIDTH, HEIGHT, DENSITY, GRAVITY = 1.0, 2.0, 1.0, 1.0
#: Length of the floor.
FLOOR = 5.0
#: Speed of sound over sqrt(g H).
STIFFNESS = 20.0
#: Martin and Moyce, column twice as high as wide, 2.25 inches wide: place of the front over the
#: width of the column, by t sqrt(2 g/a).
MEASURED = {
    0.41: 1.11,
    0.84: 1.22,
    1.19: 1.44,
    1.43: 1.67,
    1.63: 1.89,
    1.83: 2.11,
    1.98: 2.33,
    2.20: 2.56,
    2.32: 2.78,
    2.51: 3.00,
    2.65: 3.22,
    2.83: 3.44,
    2.98: 3.67,
    3.11: 3.89,
    3.33: 4.11,
}
LAST = 3.33
#: Times T at two measured places, between which the speed of the front is taken.
PASSED = (1.43, 3.33)
PASSING = PASSED[1] - PASSED[0]
#: End of the start.
EARLY = 0.75
#: Times T of the table that are compared.
COMPARED = (1.43, 2.20, 3.33)
FRAMES = 36
#: From T = t sqrt(2 g/a) to t.
UNIT = math.sqrt(WIDTH / (2.0 * GRAVITY))


def scene(p: Parameters) -> Scene:
    """Return the column at the left wall; `cells` are those of its width."""
    h = WIDTH / p.cells
    counts = [p.cells * p.ppc, 2 * p.cells * p.ppc]
    points = lattice(2, [0.0, 0.0], [WIDTH, HEIGHT], counts, DENSITY)
    cells = [round(FLOOR * p.cells), round(1.5 * HEIGHT * p.cells)]
    c = STIFFNESS * math.sqrt(GRAVITY * HEIGHT)
    steps = FRAMES * math.ceil(LAST * UNIT * c / (FRAMES * 0.4 * h))
    fluid = (
        'material-class = "BarotropicViscousFluid"\n'
        f"    material-props = {{{DENSITY * c**2!r}, 0.0}}\n"
        '    material-str-props = {"NO_TENSION"}'
    )
    boundary = 'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {1, -1, 1, -1}'
    return Scene(
        2,
        [FLOOR, 1.5 * HEIGHT],
        cells,
        [Body("water", points, 1.0, 0.0, boundary, fluid)],
        LAST * UNIT,
        LAST * UNIT / steps,
        FRAMES,
        p.mapping,
        gravity=[0.0, -GRAVITY],
        digits=10,
    )


def measure(p: Parameters, out: Output) -> Measures:
    """Return the front at the times of the table, its speed, the first push, and the energy."""
    spacing = WIDTH / (p.cells * p.ppc)
    times, fronts, centres, energies = [], [], [], []
    for frame in out.points():
        times.append(frame.time / UNIT)
        # The foremost point stands for water half of a spacing further.
        fronts.append(float(np.max(frame.x[:, 0])) + 0.5 * spacing)
        centres.append(float(np.mean(frame.x[:, 0])) - 0.5 * WIDTH)
        v2 = np.sum(frame["velocity"][:, :2] ** 2, axis=1)
        energies.append(float(np.mean(0.5 * v2 + GRAVITY * frame.x[:, 1])))
    found = {f"front_{time:.2f}": float(np.interp(time, times, fronts)) for time in MEASURED}
    places = [MEASURED[time] for time in PASSED]
    arrivals = np.interp(places, fronts, times)
    found["speed"] = float((places[-1] - places[0]) / (arrivals[1] - arrivals[0]))
    found["lead_first"], found["lead_last"] = (np.array(PASSED) - arrivals).tolist()
    early = [(t, x) for t, x in zip(times, centres, strict=True) if t <= EARLY]
    squares = np.array([[t**2, t**4] for t, _ in early])
    found["push"] = float(np.linalg.lstsq(squares, [x for _, x in early], rcond=None)[0][0])
    found["e_push"] = abs(found["push"] / push() - 1.0)
    found["gained"] = max(energies) / energies[0] - 1.0
    found["lost"] = 1.0 - energies[-1] / energies[0]
    return found


def push() -> float:
    """Return (x - a/2)/(a T**2) of the centre of the water at first, without compression.

    The pressure that starts the water is harmonic: 0 at the free top and side, without slope at
    the wall, with the slope of the weight at the floor. Its force on the wall moves the centre.
    """
    force = 0.0
    for n in range(200):
        k = (n + 0.5) * math.pi / WIDTH
        force += (
            (-1) ** n
            * 2.0
            * (1.0 - 2.0 * math.exp(-k * HEIGHT) / (1.0 + math.exp(-2.0 * k * HEIGHT)))
            / (WIDTH * k**3)
        )
    acceleration = GRAVITY * force / (WIDTH * HEIGHT)
    return 0.5 * acceleration * UNIT**2 / WIDTH


def measured_speed() -> float:
    """Return the measured speed between two places, in widths and units of T."""
    return (MEASURED[PASSED[1]] - MEASURED[PASSED[0]]) / PASSING


def judge(r: Results) -> list[Finding]:
    """Expect the exact start, and a front between the measured one and Ritter's."""
    findings = []
    for p, m in r:
        h = WIDTH / p.cells
        c = STIFFNESS * math.sqrt(GRAVITY * HEIGHT)
        start = near(
            f"push of the wall, {p.cells} cells",
            m["push"],
            push(),
            (2.0 * HEIGHT / (c * UNIT * EARLY)) ** 2,
            "harmonic pressure; the square of the time of sound, up and down, over that of the fit",
        )
        findings.append(start)
        for time in COMPARED:
            front = Finding(f"front at T = {time:.2f}, {p.cells} cells", m[f"front_{time:.2f}"])
            front.low, front.high = MEASURED[time] - h, 1.0 + 2.0 * time
            front.reason = (
                "not a cell behind the measured one, which waits for the gate and has friction, "
                "nor ahead of that of shallow water, 1 + 2 T"
            )
            findings.append(front)
        speed = Finding(f"speed of the front between two places, {p.cells} cells", m["speed"])
        # Places and times are told to 0.01: half of that at both ends.
        speed.low, speed.high = measured_speed() - 0.01 * (1.0 + measured_speed()) / PASSING, 2.0
        speed.expected = measured_speed()
        speed.reason = (
            "from the measured one, with friction, less the digits of the table, to that of "
            "shallow water, 2 sqrt(g H)"
        )
        findings.append(speed)
        energy = below(
            f"kinetic and potential energy gained over that of the start, {p.cells} cells",
            m["gained"],
            1.0 / STIFFNESS**2,
            "none but what compression gives back, g H/c²",
        )
        findings.append(energy)
    return findings


def published(r: Results) -> list[Published]:
    """Return the measured fronts beside ours."""
    source = "Martin and Moyce 1952, quoted at second hand"
    fronts = [
        Published(
            f"front over width of the column at T = {time:.2f}",
            source,
            MEASURED[time],
            r.measures[-1][f"front_{time:.2f}"],
        )
        for time in COMPARED
    ]
    last = r.measures[-1]
    start = "exact: derived here"
    return [
        *fronts,
        Published("mean dZ/dT, Z = 1.67 to 4.11", source, measured_speed(), last["speed"]),
        Published("way of the centre over a T² at the start", start, push(), last["push"]),
    ]


CASE = Case(
    family="Fluid",
    title="Dam break",
    statement=r"""
Water in a column of width $a$ and height $H = 2a$ between a wall and a gate is let go on a smooth,
dry floor. $T = t \sqrt{2g/a}$; the sound speed is $20 \sqrt{gH}$, so that the weight compresses the
water by 0.25 %. No viscosity; `NO_TENSION` lets the water part; `cells` are those of $a$.

*Exact* at the start: the pressure is harmonic, 0 on top and at the side that was let go, with the
slope of the weight at the floor, $p = \sum_n A_n \cos(k_n x) \sinh(k_n (H - y))$, $k_n = (n +
\frac12)\pi/a$. Its force on the wall, $\rho g a^2 \cdot 2\sum_n (-1)^n (1 - 1/\cosh k_n H)/(k_n
a)^3$, moves the centre of the water by $0.0569\, a\, T^2$ at first. *Bounds* of the front $Z =
x/a$: $Z = 1 + 2T$, the front of shallow water on a dry bed, $2\sqrt{gH}$ (Ritter); and the front
that Martin and Moyce measured with a column of 2.25 inches, which started behind a gate that took
time to leave and ran over a bed with friction. Their table is taken from the literature on free
surfaces, where it is quoted, not from the paper itself.

Measured: the way of the centre, fitted with $T^2$ and $T^4$ up to $T = 0.75$; the foremost point
and half of a spacing; by how much $T$ it comes to two measured places earlier (`lead_first`,
`lead_last`) and its mean speed between them; kinetic and potential energy.

Ours comes to every measured place earlier, by nearly the same time, $T$ = 0.2 to 0.3: that is the
gate, and makes most of the difference at equal times. Between the same two places the speeds agree
to a few per cent. Energy gets lost in linear functions, where points cross cells.
""",
    source=(
        "Martin and Moyce, Phil. Trans. R. Soc. A 244 (1952) 312-324; Ritter, Z. VDI 36 (1892) "
        "947-954; pressure at the start derived here"
    ),
    scene=scene,
    measure=measure,
    judge=judge,
)
