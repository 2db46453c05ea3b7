"""Runs that are killed at any instant, full disks, folders that vanish: nothing is lost."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from checkpoints import DT, T_START, files_of
from checkpoints import write_scene as write_any_scene
from scene import Run
from test_vtkhdf import Series

SEED = 20240607
#: Steps of the run, most of whose time goes into frames and checkpoints.
STEPS = 120
FRAME = 2
SERIALIZERS = {
    "DefaultVTK": "",
    "VTKHDF": """serializer
{
    class = "VTKHDF"
    properties = {60}
    int-properties = {deflate = 1, nodes = 1}
    str-properties = {"output", "save", "test"}
}""",
}


def write_scene(folder: Path, serializer: str = "DefaultVTK") -> list[str]:
    """Write a scene with many frames and checkpoints; return the options that run it."""
    example = SERIALIZERS[serializer]
    write_any_scene(folder, "serializer" if example else "", example)
    saving = f"serializer.properties={{{1 / (FRAME * DT)!r}, save_time = {5 * DT!r}}}"
    stop = f"driver.properties={{{T_START + STEPS * DT!r}}}"
    # Few points: a step takes no time.
    points = "body.block_0.point-file=block_1.points"
    other = "body.block_1.point-file=projectile.points"
    return ["-q", "--set", saving, "--set", stop, "--set", points, "--set", other]


def killed(command: list[str], folder: Path, delay: float) -> bool:
    """Run a program and kill it; return whether it was still there."""
    with subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    ) as process:
        try:
            process.wait(delay)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return True
        assert process.stderr
        assert (process.returncode, process.stderr.read()) == (0, b"")
        return False


def check_legacy(folder: Path, expected: dict[str, bytes], least: set[str]) -> set[str]:
    """See that all frames are whole, and that none is lost; return their names."""
    found = {name: data for name, data in files_of(folder).items() if ".tmp" not in name}
    assert least <= set(found)
    for name, data in found.items():
        assert data == expected[name], name
    return set(found)


def check_hdf(folder: Path, expected: dict[str, bytes], least: set[str]) -> set[str]:
    """See that every file can be read up to its last frame; return files and their frames."""
    whole: set[str] = set()
    for path in folder.glob("*.vtkhdf"):
        series = Series(path)
        whole |= {f"{path.name}:{step}" for step in range(series.n)}
        for step in {0, series.n // 2, series.n - 1} & set(range(series.n)):
            series.frame(step)
        with h5py.File(path) as file:
            # What is behind the last whole frame need not be readable.
            entries = series.n * file["VTKHDF/NumberOfPoints"][0]
            for values in file["VTKHDF/PointData"].values():
                assert len(values) >= entries
                assert np.all(np.isfinite(values[:entries]))
    assert least <= whole
    assert expected
    return whole


@pytest.mark.parametrize(
    ("serializer", "kills"),
    [
        ("DefaultVTK", 6),
        ("VTKHDF", 6),
        pytest.param("DefaultVTK", 50, marks=pytest.mark.slow),
        pytest.param("VTKHDF", 50, marks=pytest.mark.slow),
    ],
)
def test_killed_at_any_instant(
    executable: Path,
    mpm3d: Run,
    tmp_path: Path,
    serializer: str,
    kills: int,
    request: pytest.FixtureRequest,
) -> None:
    """A run that goes on after each kill has the same frames as one that was not interrupted."""
    options = write_scene(tmp_path, serializer)
    begin = time.monotonic()
    result = mpm3d("-c", "scene.cfg", *options, cwd=tmp_path)
    longest = 0.4 * (time.monotonic() - begin)
    assert (result.returncode, result.stderr) == (0, "")
    output, save = tmp_path / "output", tmp_path / "save"
    expected = files_of(output)
    check: Callable[[Path, dict[str, bytes], set[str]], set[str]] = check_legacy
    if serializer == "VTKHDF":
        check = check_hdf

    chance = random.Random(SEED)
    done, restarts, n_bytes = 0, 0, 0
    while done < kills:
        shutil.rmtree(output, ignore_errors=True)
        shutil.rmtree(save, ignore_errors=True)
        running, whole = True, set[str]()
        while running:
            saved = sorted(save.glob("test.*.h5")) if save.exists() else []
            assert len(saved) <= 3
            command = [str(executable), "-c", "scene.cfg", *options]
            if saved:
                command = [str(executable), "-r", str(saved[-1].relative_to(tmp_path)), "-q"]
                restarts += 1
                if serializer == "VTKHDF":
                    # Frames behind the checkpoint are written again.
                    step = int(saved[-1].name.split(".")[1])
                    whole = {name for name in whole if int(name.split(":")[1]) <= step // FRAME}
            else:
                whole = set()
            delay = chance.uniform(0.0, longest) if done < kills else 100.0
            running = killed(command, tmp_path, delay)
            done += running
            if running and not list(save.glob("test.*.h5")):
                # The first run may have been faster than these: time for a checkpoint.
                longest *= 1.2
            if output.exists():
                whole = check(output, expected, whole)
            for path in save.glob("test.*.h5") if save.exists() else []:
                result = mpm3d("-r", path, "--check", cwd=tmp_path)
                assert (result.returncode, result.stderr) == (0, "")
        assert files_of(output) == expected
        n_bytes += sum(map(len, expected.values()))
        assert not list(save.glob("*.tmp*"))
    assert restarts > kills // 4
    request.node.user_properties += [("kills survived", done), ("bytes compared", n_bytes)]


def limit_files(n_bytes: int) -> Callable[[], None]:
    """Return what sets a limit to the size of files, as a full disk would."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, n_bytes))

    return limit


def run_limited(executable: Path, folder: Path, n_bytes: int, *arguments: str) -> tuple[int, str]:
    """Run the program with files of at most so many bytes; return exit code and standard error."""
    result = subprocess.run(
        [executable, *arguments],
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=120,
        preexec_fn=limit_files(n_bytes),
    )
    return result.returncode, result.stderr


def test_full_disk_in_a_frame(executable: Path, mpm3d: Run, tmp_path: Path) -> None:
    """Files that fit are whole; the one that does not leaves nothing."""
    options = write_scene(tmp_path)
    assert mpm3d("-c", "scene.cfg", *options, cwd=tmp_path).returncode == 0
    expected = files_of(tmp_path / "output")
    sizes = {name: len(data) for name, data in expected.items()}
    shutil.rmtree(tmp_path / "output")
    shutil.rmtree(tmp_path / "save")
    # A limit that the first frames keep.
    start = max(size for name, size in sizes.items() if ".0000000000." in name)
    assert max(sizes.values()) > start
    code, stderr = run_limited(executable, tmp_path, start, "-c", "scene.cfg", *options)
    assert code == 4
    assert stderr.startswith(("output/f", "save/test."))
    assert "writing failed: " in stderr
    found = files_of(tmp_path / "output")
    assert found
    assert all(data == expected[name] for name, data in found.items())


def test_full_disk_in_a_checkpoint(executable: Path, mpm3d: Run, tmp_path: Path) -> None:
    """Exit code 4 names the checkpoint; no part of it stays, and frames are whole."""
    options = write_scene(tmp_path)
    assert mpm3d("-c", "scene.cfg", *options, cwd=tmp_path).returncode == 0
    expected = files_of(tmp_path / "output")
    size = min(path.stat().st_size for path in (tmp_path / "save").iterdir())
    largest = max(map(len, expected.values()))
    shutil.rmtree(tmp_path / "save")
    for n_bytes in range(largest + 1, size, (size - largest) // 5):
        shutil.rmtree(tmp_path / "output")
        code, stderr = run_limited(executable, tmp_path, n_bytes, "-c", "scene.cfg", *options)
        assert (code, stderr.count("\n")) == (4, 1), stderr
        assert stderr.startswith("save/test.000000000005.h5: error: writing failed: ")
        assert list((tmp_path / "save").iterdir()) == []
        found = files_of(tmp_path / "output")
        assert found
        assert all(data == expected[name] for name, data in found.items())


def test_full_disk_in_a_series(executable: Path, mpm3d: Run, tmp_path: Path) -> None:
    """The frames of a VTKHDF file that were there before the disk was full can be read."""
    options = write_scene(tmp_path, "VTKHDF")
    assert mpm3d("-c", "scene.cfg", *options, cwd=tmp_path).returncode == 0
    path = tmp_path / "output" / "points.0.block_0.vtkhdf"
    expected = Series(path)
    positions = [expected.frame(step)[1] for step in range(expected.n)]
    sizes = [item.stat().st_size for item in (tmp_path / "output").iterdir()]
    saved = max(item.stat().st_size for item in (tmp_path / "save").iterdir())
    shutil.rmtree(tmp_path / "save")
    del expected
    # Room that is asked for before a frame is written is more than it takes.
    least = max(saved, 400_000)
    assert max(sizes) > 1.5 * least
    for part in (0.0, 0.1, 0.2, 0.4, 0.6, 0.8):
        shutil.rmtree(tmp_path / "output")
        n_bytes = int(least + part * (max(sizes) - least))
        code, stderr = run_limited(executable, tmp_path, n_bytes, "-c", "scene.cfg", *options)
        assert code == 4, stderr
        assert ".vtkhdf: error: writing failed: " in stderr
        found = Series(path)
        assert found.n > 0
        for step in range(found.n):
            np.testing.assert_array_equal(found.frame(step)[1], positions[step])


def wait_for(folder: Path, pattern: str, process: subprocess.Popen[str]) -> None:
    """Wait until a folder has a file."""
    deadline = time.monotonic() + 60.0
    while not list(folder.glob(pattern)):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.002)


@pytest.mark.parametrize("what", ["output", "save"])
def test_folder_that_vanishes(executable: Path, tmp_path: Path, what: str) -> None:
    """A folder of frames that is gone ends the run; one of checkpoints is made again."""
    options = write_scene(tmp_path)
    # Checkpoints when they are asked for only: none is being written when its folder goes.
    settings = (f"serializer.properties={{{1 / (FRAME * DT)!r}}}", "driver.properties={1e3}")
    options += [word for setting in settings for word in ("--set", setting)]
    output, save, moved = tmp_path / "output", tmp_path / "save", tmp_path / "moved"
    with subprocess.Popen(
        [executable, "-c", "scene.cfg", *options],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        wait_for(output, "*.0000000001.vtk", process)
        if what == "save":
            process.send_signal(signal.SIGUSR1)
            wait_for(save, "test.*.h5", process)
            save.rename(moved)
            process.send_signal(signal.SIGUSR1)
            wait_for(save, "test.*.h5", process)
            process.terminate()
            _, stderr = process.communicate(timeout=30)
            assert process.returncode == 143
            assert len(list(moved.iterdir())) == 1
        else:
            output.rename(moved)
            _, stderr = process.communicate(timeout=30)
            assert process.returncode == 4
            assert 'there is no folder "output"' in stderr


@pytest.mark.parametrize("serializer", list(SERIALIZERS))
@pytest.mark.parametrize("what", ["output", "save"])
def test_folder_without_permission(executable: Path, serializer: str, what: str) -> None:
    """Exit code 4 with the path and the reason."""
    # Other users may not enter the folders of pytest.
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        check_permission(executable, Path(name) / "work", serializer, what)


def check_permission(executable: Path, folder: Path, serializer: str, what: str) -> None:
    """Run a scene in a folder that has a read-only one, as a user whom that stops."""
    command = [str(executable)]
    if os.geteuid() == 0:
        # Permissions do not stop root.
        if shutil.which("setpriv") is None:
            pytest.skip("as root this needs setpriv")
        command = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", *command]
    folder.mkdir()
    options = write_scene(folder, serializer)
    for path in (folder / "output", folder / "save"):
        path.mkdir()
        path.chmod(0o777)
    (folder / what).chmod(0o555)
    folder.chmod(0o755)
    local = folder / "program"
    shutil.copy(executable, local)
    if os.geteuid() == 0 and not reachable(local):
        pytest.skip("other users can't enter the folder of the tests")
    command[-1] = str(local)
    result = subprocess.run(
        [*command, "-c", "scene.cfg", *options], cwd=folder, capture_output=True, text=True
    )
    assert result.returncode == 4, result.stderr
    assert f'no permission to write in "{what}"' in result.stderr
    assert result.stderr.startswith(f"{what}/")
    assert list((folder / what).iterdir()) == []


def reachable(path: Path) -> bool:
    """Whether other users can enter all folders on the way."""
    return all(parent.stat().st_mode & 0o001 for parent in path.parents)


def test_file_in_the_way_of_checkpoints(mpm3d: Run, tmp_path: Path) -> None:
    """A plain file of the name of the folder."""
    options = write_scene(tmp_path)
    (tmp_path / "save").write_text("in the way")
    result = mpm3d("-c", "scene.cfg", *options, cwd=tmp_path)
    assert result.returncode == 4
    assert result.stderr.startswith("save: error: ")
    assert "a file of that name is in the way" in result.stderr


def test_leftovers_of_killed_runs_are_deleted(mpm3d: Run, tmp_path: Path) -> None:
    """Those of processes that are gone, not those of other runs or other files."""
    options = write_scene(tmp_path)
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    for folder in ("output", "save"):
        (tmp_path / folder).mkdir()
    dead = [
        f"output/fpd.0.a.0000000001.vtk.tmp{gone.pid}",
        f"output/fnd.0.a.0000000001.vtk.tmp{gone.pid}",
        f"save/test.000000000001.h5.tmp{gone.pid}",
    ]
    alive = [
        f"output/fpd.0.a.0000000001.vtk.tmp{os.getpid()}",
        f"output/notes.tmp{gone.pid}",
        f"save/other.000000000001.h5.tmp{gone.pid}",
        f"save/test.000000000001.h5.tmp{os.getpid()}",
    ]
    for name in (*dead, *alive):
        (tmp_path / name).write_text("")
    assert mpm3d("-c", "scene.cfg", *options, cwd=tmp_path).returncode == 0
    assert not any((tmp_path / name).exists() for name in dead)
    assert all((tmp_path / name).exists() for name in alive)


@pytest.mark.parametrize("arguments", [["--list"], ["--version"], ["-c", "scene.cfg"]])
def test_standard_output_that_is_full(
    executable: Path, tmp_path: Path, arguments: list[str]
) -> None:
    """What can't be told is noticed; frames are written all the same."""
    write_scene(tmp_path)
    with Path("/dev/full").open("w") as full:
        result = subprocess.run(
            [executable, *arguments], cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert result.returncode == 4
    assert result.stderr == ("error: the standard output cannot be written: the disk may be full\n")
    assert (tmp_path / "output").exists() == ("-c" in arguments)
