"""The rotating block: scenes of both of its cases."""

from __future__ import annotations

from _solutions import RotatingBlock
from harness.scene import Body, Scene, lattice, section

DENSITY = 1.0
FRAMES = 10


def block(
    sim_type: int,
    dim: int,
    amplitude: float,
    youngs_modulus: float,
    spin: float,
    omega: float,
) -> RotatingBlock:
    """Return the exact solution of a block of 1 m side in the middle of a box of 2 m."""
    return RotatingBlock(
        youngs_modulus,
        0.0,
        DENSITY,
        amplitude=amplitude,
        spin=spin,
        omega=omega,
        corner=(0.5, 0.5, 0.5 if sim_type == 3 else 0.0),
        dim=dim,
    )


def block_scene(
    sim_type: int,
    exact: RotatingBlock,
    cells: int,
    ppc: int,
    t_start: float,
    length: float,
    dt: float,
    mapping: str,
) -> Scene:
    """Return the scene of a block that is `cells` wide and moves for a length of time."""
    dim = exact.dim
    corner = list(exact.corner)[:dim]
    upper = [c + 1.0 for c in corner]
    points = lattice(sim_type, corner, upper, [cells * ppc] * dim, DENSITY)
    constants = {
        "t_stop": t_start + length,
        "amplitude": exact.amplitude,
        "length": 1.0,
        "density": DENSITY,
        "E": exact.youngs_modulus,
        "spin": exact.spin,
        "omega": exact.omega,
    }
    constants |= dict(zip(("origin_x", "origin_y", "origin_z"), corner, strict=False))
    return Scene(
        sim_type,
        [2.0] * dim,
        [2 * cells] * dim,
        [Body("block", points, exact.youngs_modulus, 0.0, "CartesianSmoothBox")],
        t_start + length,
        dt,
        FRAMES,
        mapping,
        driver=section("RotatingBlockDriver", constants, {"staggered": 1}),
        t_start=t_start,
    )
