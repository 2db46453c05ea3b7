"""The names that mpm_3d gives to classes on threads: the same bytes as the ordinary ones."""

from __future__ import annotations

from pathlib import Path

import pytest
from scene import Body, Run, Scene, block


def falling_block(sim_type: int) -> Scene:
    """Return a block with enough points for two threads that falls into the box."""
    rows = block(sim_type, [0.2, 0.02], [0.6, 0.42], [80, 80], velocity=[0.1, -1.0])
    return Scene(
        sim_type,
        lengths=[1.0, 1.0],
        cells=[20, 20],
        bodies=[Body("block", rows, more='boundary-class = "CartesianBox"')],
        t_stop=0.01,
        rate=200.0,
    )


def frames_of(
    run: Run, scene: Scene, folder: Path, told: str, *options: str, points: str = "DefaultPoints"
) -> dict[str, bytes]:
    """Run a scene, look for a text in what the program tells, and return its frames."""
    scene.write(folder)
    config = scene.config().replace("DefaultPoints", points)
    (folder / "scene.cfg").write_text(config)
    result = run("-c", "scene.cfg", *options, cwd=folder, environment={"OMP_NUM_THREADS": "4"})
    assert (result.returncode, result.stderr) == (0, "")
    assert told in result.stdout
    return {path.name: path.read_bytes() for path in sorted((folder / "frames").glob("*.vtk"))}


@pytest.mark.parametrize("sim_type", [2, 4])
def test_same_bytes(mpm3d: Run, tmp_path: Path, sim_type: int) -> None:
    """Threads come from the command line, the job, the solver, the environment, in this order."""
    scene = falling_block(sim_type)
    expected = frames_of(mpm3d, scene, tmp_path / "plain", "on 4 threads")
    assert len(expected) == 6
    scene.solver = 'solver { class = "ParallelExplicitUSL" int-properties = {1, 1, 3} }\n'
    assert frames_of(mpm3d, scene, tmp_path / "own", "on 3 threads") == expected
    told = "on 1 thread\n"
    assert frames_of(mpm3d, scene, tmp_path / "line", told, "--threads", "1") == expected
    scene.job = "threads = 2"
    assert frames_of(mpm3d, scene, tmp_path / "job", "on 2 threads") == expected
    scene.solver = 'solver { class = "ThreadPoolExplicitUSL" int-properties = {1, 1} }\n'
    found = frames_of(mpm3d, scene, tmp_path / "pool", "on 2 threads", points="ThreadPoolPoints")
    assert found == expected


def test_table_of_times(mpm3d: Run, tmp_path: Path) -> None:
    """The debug flag asks for the table that -v gives."""
    scene = falling_block(2)
    title = "phase       seconds   share   ns per point and step\n"
    scene.solver = 'solver { class = "ParallelExplicitUSL" int-properties = {1, 1, 2, 1} }\n'
    frames_of(mpm3d, scene, tmp_path / "a", title)
    scene.solver = 'solver { class = "ThreadPoolExplicitUSL" int-properties = {1, 1, 1} }\n'
    frames_of(mpm3d, scene, tmp_path / "b", title)
    scene.solver = 'solver { class = "ThreadPoolExplicitUSL" }\n'
    scene.write(tmp_path / "c")
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path / "c")
    assert result.returncode == 0
    assert title not in result.stdout
