"""Points files, configs and results of mpm3d.

Examples
--------
>>> from mpm_pygen import Block, SimulationType, fill
>>> points = fill(Block((0.0, 0.0), (0.2, 0.1)), SimulationType.PLANE_STRAIN,
...               spacing=0.05, density=1000.0)
>>> len(points)
8
"""

from mpm_pygen.box_mesh import write_box_mesh
from mpm_pygen.clouds import Cloud
from mpm_pygen.config import Body, Config, Job, Object, Parts, check_config, find_program
from mpm_pygen.config_reader import read_config, read_parts
from mpm_pygen.errors import PointsFileError, PygenError
from mpm_pygen.filling import fill, mixture
from mpm_pygen.frames import Frame, Frames
from mpm_pygen.history import History, make_history, read_history
from mpm_pygen.lattice import lattice
from mpm_pygen.mesh import Mesh, read_mesh
from mpm_pygen.points import Points, read_points, write_points
from mpm_pygen.polygons import Polygon, naca, slope, wedge
from mpm_pygen.raster import Raster, read_image
from mpm_pygen.shape import Difference, Intersection, Shape, Transformed, Union
from mpm_pygen.shape_text import read_shape
from mpm_pygen.shapes import Block, Circle, Cylinder, HalfCircle, Pipe, Ring, Sphere
from mpm_pygen.simulation_type import SimulationType
from mpm_pygen.solids import Extrusion, Revolution, column, rotated_block, wheel

__all__ = [
    "Block",
    "Body",
    "Circle",
    "Cloud",
    "Config",
    "Cylinder",
    "Difference",
    "Extrusion",
    "Frame",
    "Frames",
    "HalfCircle",
    "History",
    "Intersection",
    "Job",
    "Mesh",
    "Object",
    "Parts",
    "Pipe",
    "Points",
    "PointsFileError",
    "Polygon",
    "PygenError",
    "Raster",
    "Revolution",
    "Ring",
    "Shape",
    "SimulationType",
    "Sphere",
    "Transformed",
    "Union",
    "check_config",
    "column",
    "fill",
    "find_program",
    "lattice",
    "make_history",
    "mixture",
    "naca",
    "read_config",
    "read_history",
    "read_image",
    "read_mesh",
    "read_parts",
    "read_points",
    "read_shape",
    "rotated_block",
    "slope",
    "wedge",
    "wheel",
    "write_box_mesh",
    "write_points",
]
