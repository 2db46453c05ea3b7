"""Points files for mpm3d: simple shapes filled with material points on a lattice.

Examples
--------
>>> from mpm_pygen import Block, SimulationType, fill
>>> points = fill(Block((0.0, 0.0), (0.2, 0.1)), SimulationType.PLANE_STRAIN,
...               spacing=0.05, density=1000.0)
>>> len(points)
8
"""

from mpm_pygen.errors import PointsFileError, PygenError
from mpm_pygen.lattice import fill, lattice
from mpm_pygen.points import Points, read_points, write_points
from mpm_pygen.shapes import Block, Circle, Cylinder, HalfCircle, Shape, Sphere
from mpm_pygen.simulation_type import SimulationType

__all__ = [
    "Block",
    "Circle",
    "Cylinder",
    "HalfCircle",
    "Points",
    "PointsFileError",
    "PygenError",
    "Shape",
    "SimulationType",
    "Sphere",
    "fill",
    "lattice",
    "read_points",
    "write_points",
]
