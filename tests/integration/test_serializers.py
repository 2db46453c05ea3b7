"""Frames of some of the points, and of every step within a window."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from frames import read_series
from scene import Run, Scene, drop_scene, run_scene

#: Frame folder, save folder and name of the runs.
NAMES = 'str-properties = {"frames", "save", "test"}'


def with_serializer(scene: Scene, name: str, reals: str, integers: str = "") -> str:
    """Return the config of a scene with another serializer."""
    config = scene.config()
    start, end = config.index("serializer"), config.index("driver")
    section = f'serializer\n{{\n    class = "{name}"\n    properties = {{{reals}}}\n'
    section += f"    int-properties = {{{integers}}}\n    {NAMES}\n}}\n"
    return config[:start] + section + config[end:]


def test_slice_of_a_falling_body(mpm3d: Run, tmp_path: Path) -> None:
    """Every fifth point is where MinimalVTK has it, and falls as things do."""
    scene = drop_scene(serializer="MinimalVTK", rate=200.0, t_stop=0.02)
    run_scene(mpm3d, scene, tmp_path / "all")
    scene.write(tmp_path / "slice")
    config = with_serializer(scene, "SlicePointsVTK", "200", "5, 17")
    (tmp_path / "slice/scene.cfg").write_text(config)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path / "slice")
    assert (result.returncode, result.stderr) == (0, "")
    every = read_series(tmp_path / "all/frames", "fpd", 0, "drop")
    some = read_series(tmp_path / "slice/frames", "fpd", 0, "drop")
    assert len(every) == len(some) == 5
    for whole, part in zip(every, some, strict=True):
        assert whole.time == part.time
        np.testing.assert_array_equal(part.positions, whole.positions[:15:5])
        assert part.fields.keys() == whole.fields.keys()
        for name, values in part.fields.items():
            np.testing.assert_array_equal(values, whole.fields[name][:15:5])
    assert len(some[0].positions) == 3
    np.testing.assert_allclose(some[-1].fields["velocity"][:, 1], -9.81 * some[-1].time, rtol=1e-12)
    nodes = [path.read_bytes() for path in sorted((tmp_path / "slice/frames").glob("fnd.*"))]
    assert nodes == [path.read_bytes() for path in sorted((tmp_path / "all/frames").glob("fnd.*"))]


def test_frames_of_a_window(mpm3d: Run, tmp_path: Path) -> None:
    """The window has a frame a step, the rest of the run keeps its rate, also after a restart."""
    dt, steps = 1e-3, 40
    scene = drop_scene(t_stop=steps * dt, dt=dt)
    scene.write(tmp_path)
    # Every tenth step, and steps 13 to 17.
    config = with_serializer(scene, "DebugVTK", "100, 0.0121, 0.0179, save_time = 0.0148", "12")
    (tmp_path / "scene.cfg").write_text(config)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    series = read_series(tmp_path / "frames", "fpd", 0, "drop")
    expected = [0, 10, 13, 14, 15, 16, 17, 20, 30, 40]
    assert [round(frame.time / dt) for frame in series] == expected
    # Heights are those of free fall, each in its frame.
    for frame in series:
        n = round(frame.time / dt)
        fall = frame.fields["displacement"][:, 1]
        np.testing.assert_allclose(fall, -9.81 * dt**2 * n * (n + 1) / 2, rtol=1e-10, atol=1e-15)
    whole = {path.name: path.read_bytes() for path in (tmp_path / "frames").iterdir()}
    saved = [path for path in (tmp_path / "save").iterdir() if path.name.endswith("15.h5")]
    assert len(saved) == 1
    for path in (tmp_path / "frames").glob("*.vtk"):
        if int(path.name.split(".")[-2]) > 4:
            path.unlink()
    result = mpm3d("-r", f"save/{saved[0].name}", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert {path.name: path.read_bytes() for path in (tmp_path / "frames").iterdir()} == whole
