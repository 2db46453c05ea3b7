"""Nearly incompressible bodies: smoothed volumes that only the material sees do not lock.

How much plain and smoothed cells bend is verified by the rows of `locking`.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from frames import read_series
from scene import Body, Run, Scene, block, run_scene

#: A cantilever of 4 m x 1 m on cells of 0.25 m, two points a cell and direction.
LENGTH, CELL = 4.0, 0.25
#: Young's modulus of plane strain, E/(1 - nu^2), and density.
MODULUS, DENSITY = 1e6, 1000.0
SMOOTHING = """solver
{
    class = "ExplicitUSLwithVolumetricStrainSmoothing"
    int-properties = {0, 1}
    str-properties = {"%s"}
}
"""


def deflection(run: Run, folder: Path, poisson: float, flag: str = "") -> float:
    """Return the deflection of the tip under the own weight over that of a Timoshenko beam."""
    young = MODULUS * (1.0 - poisson**2)
    inertia, shear = 1.0 / 12.0, young / (2.0 * (1.0 + poisson))
    load = 1e-3 * 8.0 * MODULUS * inertia / LENGTH**4
    expected = load * LENGTH**4 / (8.0 * MODULUS * inertia)
    expected += load * LENGTH**2 / (2.0 * shear * 5.0 / 6.0)
    rows = block(2, [0.0, 2.0], [LENGTH, 3.0], [32, 8], density=DENSITY)
    body = Body("beam", rows, young, poisson, 'boundary-class = "CartesianBox"')
    slowest = 3.516 * math.sqrt(MODULUS * inertia / DENSITY) / LENGTH**2
    t_stop = 12.0 / slowest
    driver = f"""driver
{{
    class = "QuasiStaticDriver"
    properties = {{{t_stop!r}, 0, {-load / DENSITY!r}, viscous = {2.0 * slowest!r}, cfl = 0.6}}
}}
"""
    scene = Scene(
        2,
        lengths=[6.0, 5.0],
        cells=[24, 20],
        bodies=[body],
        t_stop=t_stop,
        dt=1.0,
        rate=1.0 / t_stop,
        cpdi=0,
        driver=driver,
        solver=SMOOTHING % flag if flag else None,
    )
    run_scene(run, scene, folder)
    last = read_series(folder / "frames", "fpd", 0, "beam")[-1]
    tip = rows[:, 2] > LENGTH - 0.5 * CELL
    return float(-last.fields["displacement"][tip, 1].mean() / expected)


def test_compressible_beam(mpm3d: Run, tmp_path: Path) -> None:
    """At nu = 0.3 four cells over the height give the deflection with smoothing, too."""
    assert deflection(mpm3d, tmp_path / "smooth", 0.3, "USE_ZHANG_CELLS") == pytest.approx(
        1.0, abs=0.1
    )


@pytest.mark.slow
def test_anti_locking_only(mpm3d: Run, tmp_path: Path) -> None:
    """At nu = 0.499 the beam bends as it should when points keep their own volumes."""
    flags = 'USE_ZHANG_CELLS", "ANTI_LOCKING_ONLY'
    assert deflection(mpm3d, tmp_path, 0.499, flags) == pytest.approx(1.0, abs=0.1)
