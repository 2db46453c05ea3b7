"""Standing waves of small and large amplitude along the axes of a box."""

from __future__ import annotations

from _axis_aligned import (
    PLAIN,
    WAVE_NUMBER,
    compare_bar,
    is_linear,
    judge_modes,
    make_scene,
    solution,
    starts_early,
    steps_of,
)
from _manufactured import (
    EPSILON,
    between,
    fitted,
    halvings,
    judge_start,
    measure_solution,
    tabled,
)
from harness.case import Case, Finding, Measures, Output, Parameters, Results, below
from harness.scene import Scene

#: Largest number of cells of a bar that is followed by an own program too.
FOLLOWED = 128
#: Errors of an independent program with 2 points per cell and direction, by TYPE and amplitude:
#: for linear functions and for boxes that stretch with the points (cpGIMP).
LINEAR = {
    (1, 0.05): {8: 7.67e-3, 16: 7.11e-3, 32: 1.52e-2, 64: 2.86e-2, 128: 3.91e-2, 256: 5.27e-2},
    (2, 0.001): {8: 1.26e-4, 16: 3.23e-5, 32: 8.15e-6, 64: 4.03e-6, 128: 3.86e-6},
    (2, 0.05): {8: 1.19e-2, 16: 1.19e-2, 32: 2.42e-2, 64: 4.28e-2, 128: 5.72e-2},
}
STRETCHED = {
    (1, 0.05): {8: 6.45e-3, 16: 1.61e-3, 32: 4.02e-4, 64: 1.01e-4, 128: 2.53e-5, 256: 6.31e-6},
    (2, 0.05): {8: 9.00e-3, 16: 2.23e-3, 32: 5.44e-4, 64: 1.32e-4, 128: 3.13e-5},
}
#: The same program with the functions of the matrix; at large amplitude up to 64 cells, from where
#: on the integration of the stress, of order 1, matters.
SMOOTH = {
    ("ugimp", 1, 0.0001): {8: 8.93e-6, 16: 2.28e-6, 32: 5.75e-7, 64: 1.45e-7, 128: 3.65e-8},
    ("quadratic", 1, 0.0001): {8: 1.62e-5, 16: 4.28e-6, 32: 1.09e-6, 64: 2.75e-7, 128: 6.90e-8},
    ("cubic", 1, 0.0001): {8: 1.96e-5, 16: 5.36e-6, 32: 1.38e-6, 64: 3.51e-7, 128: 8.82e-8},
    ("ugimp", 1, 0.05): {8: 6.30e-3, 16: 1.63e-3, 32: 4.45e-4, 64: 2.34e-4, 128: 4.05e-4},
    ("quadratic", 1, 0.05): {8: 7.97e-3, 16: 2.11e-3, 32: 5.72e-4, 64: 2.38e-4, 128: 3.59e-4},
    ("cubic", 1, 0.05): {8: 9.98e-3, 16: 2.73e-3, 32: 7.02e-4, 64: 1.79e-4},
    ("ugimp", 2, 0.001): {8: 1.28e-4, 16: 3.30e-5, 32: 8.47e-6, 64: 2.21e-6},
    ("quadratic", 2, 0.001): {8: 2.42e-4, 16: 6.23e-5, 32: 1.56e-5, 64: 3.91e-6},
    ("cubic", 2, 0.001): {8: 3.05e-4, 16: 7.96e-5, 32: 2.00e-5, 64: 5.02e-6},
    ("ugimp", 2, 0.05): {8: 8.80e-3, 16: 2.25e-3, 32: 6.10e-4, 64: 3.73e-4},
    ("quadratic", 2, 0.05): {8: 1.18e-2, 16: 3.03e-3, 32: 8.01e-4, 64: 3.77e-4},
    ("cubic", 2, 0.05): {8: 1.55e-2, 16: 3.99e-3, 32: 9.93e-4, 64: 2.44e-4},
    ("cpgimp domains", 1, 0.05): {8: 6.45e-3, 16: 1.61e-3, 32: 4.02e-4, 64: 1.01e-4},
    ("cpdi domains", 1, 0.05): {8: 6.75e-3, 16: 1.74e-3, 32: 4.42e-4, 64: 1.11e-4},
    ("cpgimp domains", 2, 0.05): {8: 9.00e-3, 16: 2.23e-3, 32: 5.44e-4},
    ("cpdi domains", 2, 0.05): {8: 9.41e-3, 16: 2.40e-3, 32: 6.01e-4},
}
#: Domains that follow the deformation.
CONTIGUOUS = tuple(f"{name} domains" for name in ("cpgimp", "cpdi", "cpdi2"))


def frames_of(p: Parameters) -> int:
    """Return the number of frames: the files are large in two and three dimensions."""
    return 20 if p.sim_type == 1 else 10


def scene(p: Parameters) -> Scene:
    """Return a box, at the Courant number of the row."""
    frames = frames_of(p)
    return make_scene(p, p.cells, steps_of(p, p.cells, frames), frames)


def measure(p: Parameters, out: Output) -> Measures:
    """Measure the errors over all frames."""
    measures = measure_solution(solution(p), out, staggered=starts_early(p) > 0)
    if p.sim_type == 1 and p.cells <= FOLLOWED and p.scheme == PLAIN:
        measures["own_program"] = compare_bar(p, out)
    return measures


def judge(r: Results) -> list[Finding]:
    """Judge the start, linear steps or published errors, an own program, and the orders."""
    amplitude = r.first.number("amplitude", 1e-6)
    found = judge_start(r, WAVE_NUMBER * amplitude) + halvings(r, "u_l2", "v_l2", "stress_l2")
    for p, m in r:
        if is_linear(p, p.cells) and is_followed(p):
            frames = frames_of(p)
            found += judge_modes(p, m, p.cells, steps_of(p, p.cells, frames), frames)
        if "own_program" in m:
            work = steps_of(p, p.cells, frames_of(p)) * p.cells * p.ppc
            found.append(
                below(
                    f"own program, {p.cells} cells",
                    m["own_program"],
                    10.0 * EPSILON * work,
                    "the same method by full matrices: 10 epsilon for each point and step",
                )
            )
    if amplitude <= 1e-4:
        found += judge_small(r)
        if r.first.ppc == 2:
            table = SMOOTH.get((r.first.mapping, r.first.sim_type, amplitude), {})
            reason = (
                "independent program, three digits; 2 %: its largest error is that of all steps"
            )
            found += tabled(r, "u_l2", table, amplitude, 0.02, reason)
    elif r.first.number("phase", 0.0) == 0.0:
        found += judge_large(r, amplitude)
    return found


def is_followed(p: Parameters) -> bool:
    """Tell whether linear steps are written out: not those of affine fields of splines at walls.

    The waves of `scheme_wave` have them without walls.
    """
    return not (p.mapping in ("quadratic", "cubic") and p.scheme.transfer in ("APIC", "MLS"))


def judge_small(r: Results) -> list[Finding]:
    """Judge orders: 2; stresses 1, by gradients of cells away from their middles."""
    reason = "lumped masses: dispersion of order 2 with every basis"
    scheme = r.first.scheme
    if scheme.transfer == "PIC" or scheme.flip < 1.0:
        # The strongest term for n = 2 and C = 0.2 up to kh = 1: damping a C^-1 pi kh.
        reason = "damping (1 - mu)/(2 dt) at dt = C h/c: order 1"
        return fitted(r, "u_l2", 0.75, 1.1, reason, first=32)
    if scheme.solver == "USF" and not scheme.staggered:
        reason = "stress updated first: displacements lead by a step, dt = C h/c: order 1"
        # The dispersion, with kappa up to 2.5 times that of hats, takes some of the lead back.
        least = 0.75 if r.first.mapping in ("quadratic", "cubic") else 0.85
        return fitted(r, "u_l2", least, 1.3, reason, first=32)
    last = 128 if r.first.number("amplitude", 1e-6) > 1e-6 else 10**9
    # Light nodes next to the walls of cubic functions, of order h (kh)**2.
    least = 1.8 if r.first.mapping == "cubic" else 1.9
    found = fitted(r, "u_l2", least, 2.05, reason, first=8, last=last)
    if r.first.ppc == 1:
        return found + fitted(r, "stress_l2", 1.85, 2.05, "points in the middles of cells", 16)
    if r.first.mapping == "quadratic" and scheme.transfer == "MLS":
        reason = "third moments of quadratic functions are not 0: fitted slopes of order 1"
        return found + fitted(r, "stress_l2", 0.95, 1.4, reason, first=16)
    if r.first.mapping == "cubic" and scheme.transfer in ("MLS", "XPIC"):
        reason = "order 2 inside, 1 in the cells next to walls, which is 3/2 in the mean square"
        return found + fitted(r, "stress_l2", 1.4, 2.05, reason, first=16)
    if r.first.mapping in ("quadratic", "cubic"):
        reason = "splines: slopes of order 2 at every place"
        return found + fitted(r, "stress_l2", 1.85, 2.05, reason, first=16)
    reason = "gradients of linear functions away from the middles of cells"
    return found + fitted(r, "stress_l2", 0.95, 1.1, reason, first=16)


def judge_large(r: Results, amplitude: float) -> list[Finding]:
    """Compare published errors; where points cross cells, no convergence."""
    key = (r.first.sim_type, amplitude)
    linear, compared = r.first.mapping == "linear", r.first.ppc == 2
    found = []
    if r.first.mapping in ("ugimp", "quadratic", "cubic"):
        return judge_smooth(r, amplitude)
    if compared and (linear or amplitude <= 1e-3):
        reason = (
            "independent program; 10 %: its largest error is over all steps, its rotation and "
            "stress are integrated otherwise"
        )
        found += tabled(r, "u_l2", LINEAR.get(key, {}), amplitude, 0.1, reason)
    elif compared:
        tables = (STRETCHED.get(key, {}), LINEAR.get(key, {}))
        reason = "fixed boxes: between linear functions and boxes that stretch with the points"
        found += between(r, "u_l2", tables, amplitude, 0.1, reason)
    if amplitude < 0.05:
        return found
    reason = (
        "noise of forces at nodes does not depend on h, that of accelerations grows with 1/h: "
        "no convergence, order -1 to 0"
    )
    if linear:
        return found + fitted(r, "u_l2", -1.2, -0.1, reason, first=16)
    if compared:
        early = "before the noise of min(2 F |F - 1|, F/n) of the stress takes over"
        found += fitted(r, "u_l2", 1.0, 2.2, early, last=16)
    return found + fitted(r, "u_l2", -1.5, -0.1, reason, first=32)


def judge_smooth(r: Results, amplitude: float) -> list[Finding]:
    """Judge smooth functions by a table; noise |F - 1|F/n or 2/3 (F - 1)^2 F/n comes later."""
    mapping = r.first.scheme.functions(r.first.mapping)
    reason = (
        "independent program; 20 %: stress there by the logarithm, here in rate form, which adds "
        "dt/2 times the integral of L^2: CFL pi^2/(2N) of the strain"
    )
    found = []
    if r.first.ppc == 2:
        table = SMOOTH.get((mapping, r.first.sim_type, amplitude), {})
        found = tabled(r, "u_l2", table, amplitude, 0.2, reason)
    if mapping == "cubic":
        reason = "order 2: noise of (2/3)(F - 1)^2 F/n is below the dispersion of these cells"
        return found + fitted(r, "u_l2", 1.8, 2.15, reason, first=8, last=128)
    if mapping in CONTIGUOUS:
        reason = "order 2: domains stay side by side, and uniform stress makes no force at nodes"
        return found + fitted(r, "u_l2", 1.8, 2.15, reason, first=8)
    reason = "order 2 before the noise of |F - 1| F/n takes over"
    found += fitted(r, "u_l2", 1.7, 2.15, reason, first=8, last=32)
    if amplitude >= 0.05:
        reason = "noise of |F - 1| F/n in forces, whatever h: accelerations grow with 1/h"
        found += fitted(r, "u_l2", -1.2, 0.0, reason, first=64)
    return found


CASE = Case(
    family="Manufactured solutions",
    title="Standing waves along the axes of a box",
    statement=r"""
A box with sides of 1 m between smooth walls moves by

$$u_i = A \sin(\pi X_i) \sin(\pi c t + \phi_i), \qquad c^2 = M/\rho,\; M = \lambda + 2G,$$

with $\phi = (0, \pi)$ in two and $(0, 2\pi/3, 4\pi/3)$ in three dimensions. In TYPE 5 nothing
moves out of the plane. Nothing turns, so that the Jaumann rate has the integral $T_{ii} = \lambda
\ln J + 2G \ln F_{ii}$ with $F_{ii} = 1 + \pi A \cos(\pi X_i) \sin(\pi c t + \phi_i)$. The body
force per unit mass that this motion needs is $b_i = \pi^2 u_i (c^2 J/F_{ii}^2 - c^2)$; the
program evaluates it at the points. The runs begin in the exact state and last one period.

Measured: largest norms over the frames of the errors of displacement, velocity (compared half a
step earlier, where symplectic Euler steps have it) and stress, over $A$, $\pi c A$, $\pi M A$.

**Small amplitude.** While the points stay in their cells the steps are linear, and a few numbers
followed through the steps (amplitudes of grid velocity, point velocities, displacements and
stresses of a wave) give the exact errors of the scheme: of order 2, but of order 1 for the
stress, which away from the middle of a cell is that of the middle. The runs must show these
numbers, neither more nor less. Corner-averaged functions give the same numbers, because their
boxes, half as wide as the points' own, stay in the cells.

**Large amplitude.** At $A = 0.05$ m points cross cells. Uniform stress then makes a force at
nodes of up to $F/n$ of the stress times the area (linear functions, $n$ points per cell) or $2 F
|F - 1|$ of it (corner-averaged, until that reaches $F/n$), whatever the size of the cells, so
that accelerations are wrong by $1/h$. Refinement at fixed $n$ must not converge. With uGIMP and
quadratic functions the force is $|F-1|F/n$, and order 2 ends between 32 and 64 cells; with cubic
ones it is $\frac23(F-1)^2F/n$, and order 2 holds for all cells of this case. Domains that stretch
with the points (cpGIMP, CPDI, CPDI2) make no such force: order 2 throughout. The errors of
linear functions and of smooth ones are compared with those of an independent program; in one
dimension each run is also repeated by a second program of full matrices, which must agree to
rounding.
""",
    source=(
        "Fields: Wallstedt and Guilkey, J. Comput. Phys. 227 (2008) 9628-9642; stress and body "
        "force for the Jaumann rate, linear steps and noise: derived here. Convergence of the "
        "linear functions: Steffen, Kirby and Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922-948"
    ),
    scene=scene,
    measure=measure,
    judge=judge,
    error="u_l2",
    order=2.0,
)
