"""Binary frames, frames without nodes, and blocks in vast grids that need them."""

from __future__ import annotations

import re
import resource
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from frames import read_frame
from scene import EPSILON, TYPES, Run, drop_scene, run_scene
from test_frames import pair_scene

BOTH = ["DefaultVTK", "MinimalVTK"]


@pytest.mark.parametrize("serializer", BOTH)
@pytest.mark.parametrize("sim_type", TYPES)
def test_binary_frames_hold_what_text_holds(
    mpm3d: Run, tmp_path: Path, sim_type: int, serializer: str
) -> None:
    """The same names, cells and fields; numbers in text are those of binary, rounded."""
    digits = 17
    scene = pair_scene(sim_type, serializer=serializer, t_stop=0.01)
    folders = []
    for binary in (0, 1):
        folder = tmp_path / str(binary)
        folder.mkdir()
        options = f"serializer.int-properties={{digits = {digits}, binary = {binary}}}"
        run_scene(mpm3d, scene, folder, "--set", options)
        folders.append(folder / "frames")
    text, binary = folders
    names = sorted(path.name for path in text.glob("*.vtk"))
    assert names == sorted(path.name for path in binary.glob("*.vtk"))
    for name in names:
        assert (binary / name).read_bytes().split(b"\n")[2] == b"BINARY"
        read, other = read_frame(text / name), read_frame(binary / name)
        assert (read.number, read.time) == (other.number, other.time)
        assert (read.cells, read.cell_types) == (other.cells, other.cell_types)
        # 17 digits tell every number from its neighbours, but readers round once more.
        np.testing.assert_allclose(read.positions, other.positions, rtol=2 * EPSILON)
        assert list(read.fields) == list(other.fields)
        for field, values in read.fields.items():
            np.testing.assert_allclose(values, other.fields[field], rtol=2 * EPSILON, atol=0.0)


@pytest.mark.parametrize("serializer", BOTH)
def test_frames_without_nodes(mpm3d: Run, tmp_path: Path, serializer: str) -> None:
    """Only the files of the points are left, and they are the same."""
    scene = drop_scene(serializer=serializer)
    for nodes in (0, 1):
        (tmp_path / str(nodes)).mkdir()
        options = f"serializer.int-properties={{nodes = {nodes}}}"
        run_scene(mpm3d, scene, tmp_path / str(nodes), "--set", options)
    some, everything = (tmp_path / str(nodes) / "frames" for nodes in (0, 1))
    points = sorted(path.name for path in everything.glob("fpd.*"))
    assert sorted(path.name for path in some.glob("*.vtk")) == points
    assert len(list(everything.glob("*.vtk"))) == 2 * len(points)
    for name in points:
        assert (some / name).read_bytes() == (everything / name).read_bytes()


def write_vast_scene(folder: Path, points: int) -> None:
    """Write a block of so many points a side in the middle of 1024**3 cells."""
    cells = 1024
    side = np.arange(points) * (0.5 / cells) + 0.25 / cells + 500 / cells
    x = np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1).reshape(-1, 3)
    volume = (0.5 / cells) ** 3
    rows = [
        f"{1000.0 * volume!r} {volume!r} {a!r} {b!r} {c!r} 0.1 0.2 0.3 1" for a, b, c in x.tolist()
    ]
    (folder / "block.points").write_text("\n".join([str(len(x)), *rows]) + "\n")
    (folder / "scene.cfg").write_text(
        f"""job {{ t = 0  dt = 2e-6  TYPE = 3 }}
serializer {{
  class = MinimalVTK  properties = {{0}}  int-properties = {{nodes = 0}}
  str-properties = {{frames, save, test}}
}}
driver {{ class = DefaultDriver  properties = {{2e-5}} }}
solver {{ class = ExplicitUSL  int-properties = {{0, 1}} }}
grid {{
  class = CartesianLinear  properties = {{1, 1, 1}}  int-properties = {{{cells}, {cells}, {cells}}}
}}
body {{
  class = DefaultBody  name = block  point-file = block.points
  point-class = DefaultPoints  node-class = DefaultNodes
  material-class = IsotropicLinearElasticity  material-props = {{1e6, 0.3}}
  boundary-class = CartesianBoxCustom  boundary-int-props = {{1, 1, 1, 1, 1, 1}}
}}
"""
    )


@pytest.mark.slow
def test_memory_follows_the_material(executable: Path, tmp_path: Path) -> None:
    """A block of 64**3 points in a grid of 1024**3 cells runs within 1 GiB."""
    write_vast_scene(tmp_path, 64)
    limit = 2**30

    def bound() -> None:
        resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))

    command = [str(executable), "-c", "scene.cfg", "--threads", "2"]
    result = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=120, preexec_fn=bound
    )
    assert (result.returncode, result.stderr) == (0, "")
    frame = read_frame(tmp_path / "frames" / f"fpd.0.block.{0:010d}.vtk")
    assert len(frame.positions) == 64**3


def peak_memory(executable: Path, folder: Path) -> int:
    """Run a scene up to its second frame; return the most memory that was held, in bytes."""
    steps = 10
    settings = (f"serializer.properties={{{1 / (2e-6 * steps)!r}}}", "driver.properties={1e3}")
    command = [str(executable), "-c", "scene.cfg", "-q", "--threads", "1"]
    command += [word for setting in settings for word in ("--set", setting)]
    frame = folder / "frames" / f"fpd.0.block.{1:010d}.vtk"
    # The run goes on while it is looked at: what wait4 tells of one that has ended has the
    # memory of the process that started it, too.
    with subprocess.Popen(command, cwd=folder) as process:
        try:
            deadline = time.monotonic() + 60.0
            while not frame.exists():
                assert process.poll() is None
                assert time.monotonic() < deadline
                time.sleep(0.005)
            status = Path(f"/proc/{process.pid}/status").read_text()
        finally:
            process.kill()
    found = re.search(r"^VmHWM:\s+(\d+) kB$", status, re.M)
    assert found, status
    return 1024 * int(found[1])


@pytest.mark.slow
def test_memory_of_a_point(executable: Path, tmp_path: Path) -> None:
    """Reading, sorting, stepping and a frame: at most 220 bytes a point besides the program."""
    points = 70
    peaks = []
    for side in (2, points):
        folder = tmp_path / str(side)
        folder.mkdir()
        write_vast_scene(folder, side)
        peaks.append(peak_memory(executable, folder))
    few, many = peaks
    assert (many - few) / (points**3 - 2**3) < 220


def test_node_frames_of_a_vast_grid_are_refused(mpm3d: Run, tmp_path: Path) -> None:
    """The message names the way out."""
    write_vast_scene(tmp_path, 2)
    result = mpm3d(
        "-c", "scene.cfg", "--set", "serializer.int-properties={nodes = 1}", cwd=tmp_path
    )
    assert result.returncode == 2
    assert "1076890625 nodes" in result.stderr
    assert "nodes = 0" in result.stderr
