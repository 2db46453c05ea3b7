"""Text files that tell which run a folder of frames comes from."""

from __future__ import annotations

from pathlib import Path

import pytest
from checkpoints import DT, STEPS, checkpoint, files_of, frames_of, write_scene
from scene import Run

RUN_FILE = "output/test.run.txt"
LONGER = f"driver.properties={{{-0.02 + (STEPS + 20) * DT!r}}}"


def described(mpm3d: Run, folder: Path, path: str | Path) -> list[str]:
    """Return the lines that a file of a run is described by."""
    result = mpm3d("--describe-run", path, cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    return result.stdout.splitlines()


def keys(lines: list[str]) -> list[str]:
    """Return what the lines are about."""
    return [line.partition(":")[0] for line in lines]


@pytest.mark.parametrize("serializer", ["DefaultVTK", "MinimalVTK", "DebugVTK", "SlicePointsVTK"])
@pytest.mark.parametrize("binary", [0, 1])
def test_frames_and_checkpoints_say_the_same(
    mpm3d: Run, tmp_path: Path, serializer: str, binary: int
) -> None:
    """Frames of points and nodes, the history, the run file and a checkpoint."""
    write_scene(tmp_path)
    first = {"DebugVTK": "100, 0, 0.005", "SlicePointsVTK": "100"}.get(serializer, "100")
    integers = "2, " if serializer == "SlicePointsVTK" else ""
    options = [
        *("--set", f"serializer.class={serializer}"),
        *("--set", f"serializer.properties={{{first}, save_time = 0.02, history_rate = 100}}"),
        *("--set", f"serializer.int-properties={{{integers}binary = {binary}}}"),
    ]
    result = mpm3d("-c", "scene.cfg", "-q", *options, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    lines = described(mpm3d, tmp_path, checkpoint(40))
    parts = ["program", "revision", "compiler", "build", "config", *3 * ["set"], *3 * ["points"]]
    assert keys(lines) == parts
    assert [line.split(maxsplit=1)[1] for line in lines if line.startswith("set:")] == options[1::2]
    assert (tmp_path / RUN_FILE).read_text().splitlines() == lines
    frames = sorted(path.name for path in (tmp_path / "output").glob("f[np]d.*.vtk"))
    for name in [frames[0], frames[-1], "test.history.csv", "test.run.txt"]:
        assert described(mpm3d, tmp_path, f"output/{name}") == lines
        # From within the folder, too.
        assert described(mpm3d, tmp_path / "output", name) == lines


def test_titles_are_those_of_the_state(mpm3d: Run, tmp_path: Path) -> None:
    """Frames are the same bytes whatever the config says of threads; their origin is not."""
    texts = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        write_scene(tmp_path / name)
        threads = ["--set", "job.threads=2"] if name == "b" else []
        assert mpm3d("-c", "scene.cfg", "-q", *threads, cwd=tmp_path / name).returncode == 0
        texts.append(described(mpm3d, tmp_path / name, "output/fpd.0.block_0.0000000001.vtk"))
    assert frames_of(tmp_path / "a" / "output") == frames_of(tmp_path / "b" / "output")
    assert keys(texts[0]) == [key for key in keys(texts[1]) if key != "set"]
    differ = [line for line in texts[1] if line not in texts[0]]
    assert keys(differ) == ["config", "set"]


def test_restart_with_other_options(mpm3d: Run, tmp_path: Path) -> None:
    """A restart that changes something says so of its own frames; one that does not, nothing."""
    write_scene(tmp_path, save_time=20 * DT)
    assert mpm3d("-c", "scene.cfg", "-q", cwd=tmp_path).returncode == 0
    saved = (tmp_path / checkpoint(40)).read_bytes()
    first = described(mpm3d, tmp_path, RUN_FILE)
    whole = files_of(tmp_path / "output")

    def go_on(*options: str) -> None:
        (tmp_path / checkpoint(40)).write_bytes(saved)
        result = mpm3d("-r", checkpoint(40), "-q", *options, cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, "")

    go_on()
    assert files_of(tmp_path / "output") == whole
    # The same change twice is told once, and is forgotten when the frames are written anew.
    for _ in range(2):
        go_on("--set", LONGER)
        frame = "output/fnd.1.block_1.{:010d}.vtk"
        assert described(mpm3d, tmp_path, frame.format(0)) == first
        assert described(mpm3d, tmp_path, frame.format(4)) == first
        second = described(mpm3d, tmp_path, frame.format(5))
        assert second == described(mpm3d, tmp_path, frame.format(8))
        assert keys([line for line in second if line not in first]) == ["config", "set"]
        everything = [*first, "", "from:     frame 5", *second]
        assert described(mpm3d, tmp_path, RUN_FILE) == everything
    go_on()
    assert described(mpm3d, tmp_path, RUN_FILE) == first
    # A run file that is gone comes again.
    (tmp_path / RUN_FILE).unlink()
    go_on()
    assert described(mpm3d, tmp_path, RUN_FILE) == first


def test_series_tell_by_themselves(mpm3d: Run, tmp_path: Path) -> None:
    """VTKHDF files need no run file, but their history does."""
    write_scene(tmp_path)
    for rate, files in ((0, 0), (100, 1)):
        options = [
            *("--set", "serializer.class=VTKHDF"),
            *("--set", f"serializer.properties={{100, history_rate = {rate}}}"),
        ]
        assert mpm3d("-c", "scene.cfg", "-q", *options, cwd=tmp_path).returncode == 0
        assert len(list((tmp_path / "output").glob("*.run.txt"))) == files
    series = described(mpm3d, tmp_path, "output/points.0.block_0.vtkhdf")
    assert described(mpm3d, tmp_path, "output/test.history.csv") == series


def test_files_that_do_not_tell(mpm3d: Run, tmp_path: Path) -> None:
    """Frames without their run file, of other programs, and texts that are none."""
    title = "# vtk DataFile Version 3.0\n{}\nASCII\n"
    (tmp_path / "alone.vtk").write_text(title.format("mpm3d a/b: Frame 3, Time 0"))
    (tmp_path / "other.vtk").write_text(title.format("a drawing"))
    (tmp_path / "cut.vtk").write_text("# vtk DataFile Version 3.0")
    (tmp_path / "empty.run.txt").write_text("")
    (tmp_path / "foreign.run.txt").write_text("some text\n")
    (tmp_path / "folder.run.txt").mkdir()
    for name, message in {
        "alone.vtk": "does not say which run it comes from\n  there is no a_b.run.txt",
        "other.vtk": "the file is no frame of mpm3d",
        "cut.vtk": "the file is no frame of mpm3d",
        "missing.vtk": "there is no such file",
        "missing.run.txt": "there is no such file",
        "empty.run.txt": "does not say which run it comes from",
        "foreign.run.txt": "does not say which run it comes from",
        "folder.run.txt": "this is a folder",
    }.items():
        result = mpm3d("--describe-run", name, cwd=tmp_path)
        assert (result.returncode, result.stdout) == (2, "")
        assert result.stderr.startswith(f"{name}: error: ")
        assert message in result.stderr
