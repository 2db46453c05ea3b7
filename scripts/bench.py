"""Speed of mpm3d: ns per point and step of fixed scenes.

A scene is an elastic block in free fall that drifts across the cells of its grid. Each
measurement runs the whole program twice with two numbers of steps and divides the difference of
the wall times by the difference of the steps and the number of points, so that reading, set-up
and the first frame drop out.
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from mpm_pygen import Block, SimulationType, fill, write_points

AXES = "xyz"


@dataclass(frozen=True)
class Scene:
    """A block in a box: simulation TYPE, basis flag, grid, solver and its transfer."""

    name: str
    sim_type: int
    cpdi: int
    grid: str = "CartesianLinear"
    solver: str = "ExplicitUSL"
    transfer: str = ""


SCENES = (
    Scene("1d-linear", 1, 0),
    Scene("plane-linear", 2, 0),
    Scene("plane-cpdi", 2, 1),
    Scene("axisymmetric-linear", 4, 0),
    Scene("out-of-plane-linear", 5, 0),
    Scene("3d-linear", 3, 0),
    Scene("3d-cpdi", 3, 1),
    Scene("plane-ugimp", 2, 0, "CartesianUGIMP"),
    Scene("plane-quadratic", 2, 0, "CartesianQuadratic"),
    Scene("plane-cubic", 2, 0, "CartesianCubic"),
    Scene("3d-ugimp", 3, 0, "CartesianUGIMP"),
    Scene("3d-quadratic", 3, 0, "CartesianQuadratic"),
    Scene("3d-cubic", 3, 0, "CartesianCubic"),
    Scene("3d-linear-musl", 3, 0, "ExplicitMUSL"),
    Scene("3d-linear-usf", 3, 0, "ExplicitUSF"),
    Scene("3d-linear-blend", 3, 0, transfer="properties = {flip = 0.99}"),
    Scene("3d-linear-apic", 3, 0, transfer="str-properties = {APIC}"),
    Scene("3d-linear-xpic-2", 3, 0, transfer="str-properties = {XPIC}"),
    Scene("3d-cpdi-apic", 3, 1, transfer="str-properties = {APIC}"),
    Scene("3d-cpdi-mls", 3, 1, transfer="str-properties = {MLS}"),
)


def write_scene(scene: Scene, folder: Path, points: int) -> int:
    """Write points file and config of a scene; return the number of points.

    The block fills 0.8 of each side of a unit box, with two points a cell and direction.
    """
    sim_type = SimulationType(scene.sim_type)
    dim = sim_type.dimension
    across = max(2, 2 * round(points ** (1.0 / dim) / 2))
    cells = max(2, round(across / 2 / 0.8))
    spacing = 0.5 / cells
    lower = [max(1, round(0.1 * cells)) / cells] * dim
    upper = [low + across * spacing for low in lower]
    velocity = [0.1, 0.2, 0.3][: sim_type.components]
    if sim_type == SimulationType(4):
        velocity = [0.0, 0.2, 0.0]
    block = fill(Block(lower, upper), sim_type, spacing=spacing, density=1000.0, velocity=velocity)
    write_points(folder / "block.points", block)
    # uGIMP: half of the width of a point.
    half_width = [repr(spacing / 2)] if scene.grid == "CartesianUGIMP" else []
    box = ", ".join(["1.0"] * dim + half_width)
    counts = ", ".join([str(cells)] * dim)
    # A Courant number of about 0.1 for a wave speed of 36.7 m/s.
    dt = 0.1 / cells / 36.7
    (folder / "bench.cfg").write_text(
        f"""job {{ t = 0  dt = {dt!r}  TYPE = {scene.sim_type} }}
serializer {{ class = MinimalVTK  properties = {{0}}  str-properties = {{frames, save, bench}} }}
driver {{ class = DefaultDriver  properties = {{1}} }}
solver {{ class = {scene.solver}  int-properties = {{{scene.cpdi}, 1}}  {scene.transfer} }}
grid {{ class = {scene.grid}  properties = {{{box}}}  int-properties = {{{counts}}} }}
body {{
  class = DefaultBody  name = block  point-file = block.points
  point-class = DefaultPoints  node-class = DefaultNodes
  material-class = IsotropicLinearElasticity  material-props = {{1e6, 0.3}}
  boundary-class = CartesianSmoothBox
}}
"""
    )
    (folder / "dt").write_text(repr(dt))
    return len(block.mass)


def run_steps(program: str, folder: Path, steps: int, threads: int) -> float:
    """Wall time in seconds of a run of so many steps."""
    dt = float((folder / "dt").read_text())
    command = [
        program,
        "-q",
        "-c",
        "bench.cfg",
        "--threads",
        str(threads),
        "--set",
        f"driver.properties={{{steps * dt!r}}}",
    ]
    start = time.perf_counter()
    subprocess.run(command, cwd=folder, check=True)
    return time.perf_counter() - start


def measure(
    program: str, scene: Scene, points: int, threads: list[int], repeat: int
) -> list[dict[str, object]]:
    """Measure one scene for each number of threads."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        n = write_scene(scene, folder, points)
        # About two seconds of work at 60 ns, and a short run to subtract.
        short = 5
        long = short + max(10, round(2.0 / (60e-9 * n)))
        for count in threads:
            samples = []
            for _ in range(repeat):
                low = run_steps(program, folder, short, count)
                high = run_steps(program, folder, long, count)
                samples.append(1e9 * (high - low) / ((long - short) * n))
            rows.append(
                {
                    "scene": scene.name,
                    "points": n,
                    "threads": count,
                    "steps": [short, long],
                    "ns_per_point_and_step": {
                        "median": statistics.median(samples),
                        "min": min(samples),
                        "max": max(samples),
                    },
                }
            )
    return rows


def main() -> int:
    """Command line."""
    names = [scene.name for scene in SCENES]
    parser = argparse.ArgumentParser(description=__doc__, prog="scripts/bench")
    parser.add_argument("--program", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--scene", action="append", choices=names, help="default: all; may repeat")
    parser.add_argument("--points", type=int, default=250_000, help="about so many points")
    parser.add_argument("--threads", type=int, action="append", help="default: 1; may repeat")
    parser.add_argument("--repeat", type=int, default=3, help="measurements of each row")
    parser.add_argument("--json", type=Path, help="also write the rows to this file")
    arguments = parser.parse_args()

    version = subprocess.run(
        [arguments.program, "--version"], check=True, capture_output=True, text=True
    ).stdout.strip()
    print(f"{version} on {platform.machine()}")
    print(f"{'scene':22}{'points':>9}{'threads':>9}   ns per point and step: median (min .. max)")
    rows = []
    for scene in SCENES:
        if arguments.scene and scene.name not in arguments.scene:
            continue
        for row in measure(
            arguments.program, scene, arguments.points, arguments.threads or [1], arguments.repeat
        ):
            cost = row["ns_per_point_and_step"]
            print(
                f"{row['scene']:22}{row['points']:>9}{row['threads']:>9}"
                f"   {cost['median']:.1f} ({cost['min']:.1f} .. {cost['max']:.1f})",
                flush=True,
            )
            rows.append(row)
    if arguments.json:
        arguments.json.write_text(json.dumps({"version": version, "rows": rows}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
