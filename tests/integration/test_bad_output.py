"""Frames that can't be written: exit code 4, and no half of a frame."""

from __future__ import annotations

from pathlib import Path

from bad_input import BAD_OUTPUT, CONFIG, expect_failure, write_scene
from scene import Run


def test_file_in_the_way_of_the_frame_folder(mpm3d: Run, tmp_path: Path) -> None:
    """A frame folder that can't be made is an output error."""
    write_scene(tmp_path)
    (tmp_path / "frames").write_text("in the way")
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_OUTPUT, "frames: ", "a file of that name is in the way")
    assert (tmp_path / "frames").read_text() == "in the way"


def test_file_in_the_way_of_a_folder_above(mpm3d: Run, tmp_path: Path) -> None:
    """So is one below a plain file."""
    write_scene(tmp_path, CONFIG.replace('"frames"', '"a/b/frames"'))
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "b").write_text("in the way")
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_OUTPUT, "a/b: ", "a file of that name is in the way")


def test_folder_in_the_way_of_a_frame(mpm3d: Run, tmp_path: Path) -> None:
    """The first frame can't be written; its other files do not stay either."""
    write_scene(tmp_path)
    (tmp_path / "frames" / "fnd.1.second.0000000000.vtk").mkdir(parents=True)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert result.returncode == BAD_OUTPUT
    assert "fnd.1.second.0000000000.vtk: error: " in result.stderr
    assert "a folder of that name is in the way" in result.stderr
    frames = [path.name for path in (tmp_path / "frames").glob("*.vtk")]
    assert frames == ["fnd.1.second.0000000000.vtk"]
