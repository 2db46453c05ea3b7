"""Checkpoints: when they are written, what a restart refuses, and what it may change."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from checkpoints import DT, FRAME, STEPS, checkpoint, files_of, frames_of, write_scene
from frames import read_frame, read_series
from scene import Run

#: Interval of simulated time that gives checkpoints after 20, 40 and 60 steps.
INTERVAL = 20 * DT
HEADER = 512


def saved_scene(mpm3d: Run, folder: Path) -> Path:
    """Run a scene with checkpoints after 40 and 60 steps; return the first."""
    write_scene(folder, save_time=INTERVAL)
    result = mpm3d("-c", "scene.cfg", "-q", cwd=folder)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    return folder / checkpoint(40)


def tree(folder: Path) -> dict[str, bytes]:
    """Return all files below a folder."""
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_last_two_are_kept(mpm3d: Run, tmp_path: Path) -> None:
    """Of the run of that name; other files stay."""
    (tmp_path / "save").mkdir()
    others = ["test.00000000001x.h5", "run.000000000001.h5", "test.000000000001.h5.bak"]
    for name in others:
        (tmp_path / "save" / name).write_text("")
    saved_scene(mpm3d, tmp_path)
    expected = {*others, Path(checkpoint(40)).name, Path(checkpoint(60)).name}
    assert {path.name for path in (tmp_path / "save").iterdir()} == expected


def test_checkpoints_change_no_frame(mpm3d: Run, tmp_path: Path) -> None:
    """A run with checkpoints has the same frames as one without."""
    saved_scene(mpm3d, tmp_path)
    with_them = frames_of(tmp_path / "output")
    write_scene(tmp_path)
    assert mpm3d("-c", "scene.cfg", "-q", cwd=tmp_path).returncode == 0
    assert frames_of(tmp_path / "output") == with_them
    assert len(with_them) == 6 * (STEPS // FRAME + 1)


def test_save_at_the_end_and_by_wall_time(mpm3d: Run, tmp_path: Path) -> None:
    """A wall time that every step exceeds saves each step; at the end it is not done twice."""
    write_scene(tmp_path)
    serializer = "serializer.int-properties={10, save_at_end = 1}"
    result = mpm3d("-c", "scene.cfg", "--set", serializer, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout.count("saved ") == 1
    assert f"saved {checkpoint(STEPS)}" in result.stdout
    wall = "serializer.properties={0, save_wall = 1e-9}"
    result = mpm3d("-c", "scene.cfg", "--set", wall, "--set", serializer, cwd=tmp_path)
    assert result.stdout.count("saved ") == STEPS


def test_empty_folder_name_saves_nothing(mpm3d: Run, tmp_path: Path) -> None:
    """Without a folder there are no checkpoints."""
    write_scene(tmp_path, save_time=INTERVAL)
    names = 'serializer.str-properties={"output", "", "run"}'
    result = mpm3d("-c", "scene.cfg", "--set", names, cwd=tmp_path)
    assert result.returncode == 0
    assert "saved" not in result.stdout
    assert not (tmp_path / "save").exists()


@pytest.mark.parametrize("how", ["cut", "header", "data", "end", "longer", "foreign", "newer"])
def test_bad_checkpoints_are_refused(mpm3d: Run, tmp_path: Path, how: str) -> None:
    """The message names the file and what is wrong; nothing is written or changed."""
    path = saved_scene(mpm3d, tmp_path)
    data = bytearray(path.read_bytes())
    assert data.startswith(b"mpm3d checkpoint format 1\n")
    expected = "the checkpoint is damaged: "
    if how == "cut":
        data = data[: len(data) // 2]
    elif how == "header":
        data = data[:HEADER]
    elif how == "data":
        data[HEADER + (len(data) - HEADER) // 2] ^= 0x10
    elif how == "end":
        data[-1] ^= 0x01
    elif how == "longer":
        data += b"x"
    elif how == "foreign":
        data = data[HEADER:]
        expected = "this is no checkpoint of mpm3d"
    else:
        data[:27] = b"mpm3d checkpoint format 2\n"[:27].ljust(26)
        expected = "the checkpoint is of format 2, this program reads 1"
    path.write_bytes(data)
    before = tree(tmp_path)
    result = mpm3d("-r", checkpoint(40), cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr.startswith(f"{checkpoint(40)}: error: {expected}")
    assert result.stdout == ""
    assert tree(tmp_path) == before


def test_every_cut_is_noticed(mpm3d: Run, tmp_path: Path) -> None:
    """Whatever is missing at the end of a checkpoint."""
    path = saved_scene(mpm3d, tmp_path)
    data = path.read_bytes()
    for length in [0, 1, 26, 100, HEADER, HEADER + 1, len(data) - 4096, len(data) - 1]:
        path.write_bytes(data[:length])
        result = mpm3d("-r", checkpoint(40), cwd=tmp_path)
        assert result.returncode == 2, length
        assert result.stderr.startswith(f"{checkpoint(40)}: error: ")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--set", "job.TYPE=5"], "TYPE is 5, but 2 was saved"),
        (["--set", "job.t=0"], "the start time is 0 s, but -0.02 s was saved"),
        (["--set", "solver.class=ExplicitMUSL"], 'solver is "ExplicitMUSL", but "ExplicitUSL"'),
        (["--set", "body.block_0.name=block"], ""),
        (["--set", "body.block_1.point-file=projectile.points"], "those of the checkpoint"),
    ],
)
def test_another_run_is_refused(
    mpm3d: Run, tmp_path: Path, options: list[str], message: str
) -> None:
    """A restart goes on with the objects of the run, and says what is not among them."""
    saved_scene(mpm3d, tmp_path)
    before = tree(tmp_path)
    result = mpm3d("-r", checkpoint(40), *options, cwd=tmp_path)
    assert result.returncode == 2
    assert "error: " in result.stderr
    assert message in result.stderr
    assert tree(tmp_path) == before


def test_points_files_are_not_needed(mpm3d: Run, tmp_path: Path) -> None:
    """A run goes on with the points that it has, whatever became of their files."""
    saved_scene(mpm3d, tmp_path)
    whole = files_of(tmp_path / "output")
    path = tmp_path / "block_1.points"
    lines = path.read_text().splitlines()
    number, rest = lines[1].split(maxsplit=1)
    path.write_text("\n".join([lines[0], f"{float(number) * 1.5} {rest}", *lines[2:]]) + "\n")
    (tmp_path / "block_0.points").unlink()
    result = mpm3d("-r", checkpoint(40), cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert files_of(tmp_path / "output") == whole


def test_describe_run(mpm3d: Run, tmp_path: Path) -> None:
    """Checkpoints and series say what they come from; digests follow what was read."""
    described = []
    for k, name in enumerate(("a", "b")):
        folder = tmp_path / name
        folder.mkdir()
        write_scene(folder, save_time=INTERVAL)
        if k == 1:
            with (folder / "scene.cfg").open("a") as file:
                file.write("# a remark\n")
        options = ["--set", "serializer.class=VTKHDF", "--set", "driver.properties=0.005"]
        result = mpm3d("-c", "scene.cfg", "-q", *options, cwd=folder)
        assert (result.returncode, result.stderr) == (0, "")
        saved = mpm3d("--describe-run", checkpoint(20), cwd=folder)
        series = mpm3d("--describe-run", "output/points.0.block_0.vtkhdf", cwd=folder)
        assert (saved.returncode, saved.stderr) == (0, "")
        assert saved.stdout == series.stdout
        described.append(saved.stdout.splitlines())
    version = mpm3d("--version", cwd=tmp_path).stdout
    keys = ["program", "revision", "compiler", "build", "config", "set", "set", *(3 * ["points"])]
    assert [line.partition(":")[0] for line in described[0]] == keys
    for line in described[0][:3]:
        assert line.partition(":")[2].strip().removeprefix("mpm3d ") in version
    differ = [a.partition(":")[0] for a, b in zip(*described, strict=True) if a != b]
    assert differ == ["config"]
    result = mpm3d("--describe-run", "a/scene.cfg", cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr.startswith("a/scene.cfg: error: the file is not an HDF5 file")


def test_later_stop_time(mpm3d: Run, tmp_path: Path) -> None:
    """A run that is prolonged at its end goes on as one that was planned so, up to rounding.

    Its last step ended at the stop time itself, which is t_start + n dt up to rounding only.
    """
    write_scene(tmp_path)
    longer = ("--set", f"driver.properties={{{-0.02 + 80 * DT!r}}}")
    result = mpm3d("-c", "scene.cfg", *longer, "-q", cwd=tmp_path)
    assert result.returncode == 0
    expected = frames_of(tmp_path / "output")
    for path in (tmp_path / "output").iterdir():
        path.unlink()
    end = ("--set", "serializer.int-properties={10, save_at_end = 1}")
    assert mpm3d("-c", "scene.cfg", *end, "-q", cwd=tmp_path).returncode == 0
    result = mpm3d("-r", checkpoint(STEPS), *longer, "-q", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    found = frames_of(tmp_path / "output")
    assert found.keys() == expected.keys()
    assert len(found) == 6 * 9
    for name, data in found.items():
        if int(name.split(".")[3]) < STEPS // FRAME:
            assert data == expected[name]
    last = read_frame(tmp_path / "output" / "fpd.0.block_0.0000000008.vtk")
    assert abs(last.time - (-0.02 + 80 * DT)) < 1e-15
    (tmp_path / "expected.vtk").write_bytes(expected["fpd.0.block_0.0000000008.vtk"])
    other = read_frame(tmp_path / "expected.vtk")
    # Twenty steps with forces that differ by rounding errors.
    assert np.abs(last.positions - other.positions).max() < 1e-10


def test_another_rate_and_step(mpm3d: Run, tmp_path: Path) -> None:
    """Frames go on at multiples of the new interval, with the next number; steps are new, too."""
    saved_scene(mpm3d, tmp_path)
    result = mpm3d(
        *("-r", checkpoint(40)),
        *("--set", f"serializer.properties={{{1 / (4 * DT)!r}}}"),
        *("--set", f"job.dt={DT / 2!r}"),
        cwd=tmp_path,
    )
    assert (result.returncode, result.stderr) == (0, "")
    assert "done: 80 steps" in result.stdout
    series = read_series(tmp_path / "output", "fpd", 0, "block_0")
    steps = [round((frame.time + 0.02) / DT) for frame in series]
    assert steps == [0, 10, 20, 30, 40, 44, 48, 52, 56, 60]


def test_options_of_the_run_are_kept(mpm3d: Run, tmp_path: Path) -> None:
    """What --set said goes on to hold; what it says now comes on top."""
    write_scene(tmp_path, save_time=INTERVAL)
    names = 'serializer.str-properties={"first", "save", "test"}'
    assert mpm3d("-c", "scene.cfg", "-q", "--set", names, cwd=tmp_path).returncode == 0
    frames = files_of(tmp_path / "first")
    (tmp_path / "scene.cfg").unlink()
    result = mpm3d("-r", checkpoint(40), "-q", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert files_of(tmp_path / "first") == frames
    names = 'serializer.str-properties={"second", "save", "test"}'
    result = mpm3d("-r", checkpoint(40), "-q", "--set", names, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    second = frames_of(tmp_path / "second")
    assert len(second) == 2 * 6
    assert all(frames[name] == data for name, data in second.items() if name in frames)


def test_check_of_a_checkpoint(mpm3d: Run, tmp_path: Path) -> None:
    """-r with --check reports and writes nothing."""
    saved_scene(mpm3d, tmp_path)
    before = tree(tmp_path)
    result = mpm3d("-r", checkpoint(40), "--check", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "restart: save/test" in result.stdout
    assert tree(tmp_path) == before


def start_long_run(executable: Path, folder: Path, *options: str) -> subprocess.Popen[str]:
    """Start a run without end and wait for its second frame."""
    write_scene(folder)
    process = subprocess.Popen(
        [executable, "-c", "scene.cfg", "--set", "driver.properties={1e5}", *options],
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 60.0
    while not (folder / "output" / "fnd.2.projectile.0000000001.vtk").exists():
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.005)
    return process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_saves_and_stops(
    executable: Path, mpm3d: Run, tmp_path: Path, number: signal.Signals
) -> None:
    """The step ends, a checkpoint is written, the exit status tells the signal."""
    process = start_long_run(executable, tmp_path)
    process.send_signal(number)
    _, stderr = process.communicate(timeout=20)
    assert process.returncode == 128 + number
    (path,) = (tmp_path / "save").iterdir()
    step = int(path.name.split(".")[1])
    assert f"error: stopped by {number.name} at t = " in stderr
    assert f"mpm3d -r save/{path.name} goes on" in stderr
    # Behind the signal a run goes on as an uninterrupted one.
    stop = ("--set", f"driver.properties={{{-0.02 + (step + 20) * DT!r}}}")
    result = mpm3d("-r", f"save/{path.name}", *stop, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    interrupted = frames_of(tmp_path / "output")
    assert mpm3d("-c", "scene.cfg", *stop, cwd=tmp_path).returncode == 0
    assert frames_of(tmp_path / "output") == interrupted


def test_signal_without_saving(executable: Path, tmp_path: Path) -> None:
    """save_on_signal = 0 stops all the same."""
    option = ("--set", "serializer.int-properties={10, save_on_signal = 0}")
    process = start_long_run(executable, tmp_path, *option)
    process.send_signal(signal.SIGTERM)
    _, stderr = process.communicate(timeout=20)
    assert process.returncode == 143
    assert "nothing was saved" in stderr
    assert not (tmp_path / "save").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_close_together_are_one(
    executable: Path, tmp_path: Path, number: signal.Signals
) -> None:
    """What `timeout` does: the same signal twice, to the program and to its group."""
    process = start_long_run(executable, tmp_path)
    for _ in range(3):
        process.send_signal(number)
        time.sleep(0.001)
    process.communicate(timeout=20)
    assert process.returncode == 128 + number
    assert len(list((tmp_path / "save").iterdir())) == 1


def test_run_under_timeout_saves(executable: Path, tmp_path: Path) -> None:
    """A run that `timeout` ends is saved, as one that a batch system ends."""
    write_scene(tmp_path)
    stop = "driver.properties={1e5}"
    command = ["timeout", "3", str(executable), "-c", "scene.cfg", "--set", stop]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 124
    assert "error: stopped by SIGTERM at t = " in ended.stderr
    assert len(list((tmp_path / "save").iterdir())) == 1


def test_second_signal_stops_at_once(executable: Path, tmp_path: Path) -> None:
    """Even when the program hangs in its step: here since it is stopped."""
    # Stopped too early it has not seen the first signal, too late it has ended.
    for attempt in range(30):
        folder = tmp_path / str(attempt)
        folder.mkdir()
        process = start_long_run(executable, folder)
        process.send_signal(signal.SIGINT)
        time.sleep(2e-4 * 2 ** (attempt % 8))
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGCONT)
        process.communicate(timeout=20)
        if process.returncode == -signal.SIGINT:
            return
        assert process.returncode == 130
    pytest.fail("a second signal never stopped the program at once")


def test_sigusr1_saves_and_goes_on(executable: Path, tmp_path: Path) -> None:
    """A checkpoint for each time that one is asked for."""
    process = start_long_run(executable, tmp_path)
    deadline = time.monotonic() + 20.0
    for count in (1, 2):
        process.send_signal(signal.SIGUSR1)
        while len(list(tmp_path.glob("save/test.*.h5"))) < count:
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.005)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=20)
    assert process.returncode == 143
    assert len(list((tmp_path / "save").iterdir())) == 2
