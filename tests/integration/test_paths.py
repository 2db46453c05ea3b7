"""Where files are looked for, and where frames go."""

from __future__ import annotations

from pathlib import Path

from frames import frame_path, read_frame
from scene import Result, Run, block, drop_scene, write_points


def run_from(run: Run, folder: Path, config: Path, *options: str) -> Result:
    """Run a config from a folder."""
    result = run("-c", config, *options, cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    return result


def test_points_beside_the_config(mpm3d: Run, tmp_path: Path) -> None:
    """A points file that is not in the working directory is found beside the config."""
    drop_scene().write(tmp_path / "scenes" / "drop")
    run_from(mpm3d, tmp_path, Path("scenes/drop/scene.cfg"))
    # Frames are relative to the working directory.
    assert frame_path(tmp_path / "frames", "fpd", 0, "drop", 0).is_file()
    assert not (tmp_path / "scenes" / "drop" / "frames").exists()


def test_points_beside_a_config_with_an_absolute_path(mpm3d: Run, tmp_path: Path) -> None:
    """The same when the config is given by its absolute path."""
    config = drop_scene().write(tmp_path / "scenes")
    (tmp_path / "elsewhere").mkdir()
    run_from(mpm3d, tmp_path / "elsewhere", config)
    assert frame_path(tmp_path / "elsewhere" / "frames", "fpd", 0, "drop", 0).is_file()


def test_points_of_the_working_directory_come_first(mpm3d: Run, tmp_path: Path) -> None:
    """As in mpm_3d, the working directory has precedence."""
    config = drop_scene().write(tmp_path / "scene")
    write_points(tmp_path / "drop.points", block(2, [0.4, 0.4], [0.6, 0.6], [2, 1]))
    run_from(mpm3d, tmp_path, config)
    frame = read_frame(frame_path(tmp_path / "frames", "fpd", 0, "drop", 0))
    assert len(frame.positions) == 2


def test_points_with_an_absolute_path(mpm3d: Run, tmp_path: Path) -> None:
    """An absolute path is taken as it is."""
    config = drop_scene().write(tmp_path / "scene")
    write_points(tmp_path / "other.points", block(2, [0.4, 0.4], [0.6, 0.6], [3, 1]))
    run_from(mpm3d, tmp_path, config, "--set", f'body.0.point-file="{tmp_path}/other.points"')
    frame = read_frame(frame_path(tmp_path / "frames", "fpd", 0, "drop", 0))
    assert len(frame.positions) == 3


def test_points_with_a_relative_folder(mpm3d: Run, tmp_path: Path) -> None:
    """A relative path may have folders, also when it is beside the config."""
    config = drop_scene().write(tmp_path / "scene")
    (tmp_path / "scene" / "points").mkdir()
    (tmp_path / "scene" / "drop.points").rename(tmp_path / "scene" / "points" / "drop.points")
    run_from(mpm3d, tmp_path, config, "--set", "body.0.point-file=points/drop.points")


def test_missing_points_name_both_places(mpm3d: Run, tmp_path: Path) -> None:
    """The message says where the file was looked for."""
    config = drop_scene().write(tmp_path / "scene")
    (tmp_path / "scene" / "drop.points").unlink()
    result = mpm3d("-c", config, cwd=tmp_path)
    assert result.returncode == 2
    assert 'there is no file "drop.points"' in result.stderr
    assert f"{tmp_path}/scene/drop.points" in result.stderr


def test_frame_folders_are_made(mpm3d: Run, tmp_path: Path) -> None:
    """Folders above the frames are made as well; the save folder is not."""
    drop_scene().write(tmp_path)
    strings = 'serializer.str-properties={"a/b/c/", "save", "test"}'
    result = mpm3d("-c", "scene.cfg", "--set", strings, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert frame_path(tmp_path / "a" / "b" / "c", "fpd", 0, "drop", 0).is_file()
    assert not (tmp_path / "save").exists()


def test_frames_of_an_earlier_run_are_replaced(mpm3d: Run, tmp_path: Path) -> None:
    """A second run into the same folder writes its frames over those of the first."""
    config = drop_scene().write(tmp_path)
    run_from(mpm3d, tmp_path, config)
    path = frame_path(tmp_path / "frames", "fpd", 0, "drop", 0)
    content = path.read_bytes()
    path.write_bytes(b"old")
    run_from(mpm3d, tmp_path, config)
    assert path.read_bytes() == content
