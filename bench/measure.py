"""Runs of a program, timed from outside as whole processes."""

from __future__ import annotations

import os
import re
import shutil
import statistics
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from bench.scenes import Case

#: Steps of the run whose time is subtracted: it has the reading, the set-up and the first frame.
SHORT = 5
#: What one point and step costs, about; decides the number of steps. [s]
GUESS = 60e-9
#: Least length of a run for each point, in s: the time of the set-up, which grows with the points,
#: is never the same twice.
LEAST = 6e-6
#: Seconds between two looks at a process that runs.
POLL = 0.002
#: Frames per second of simulated time with which the share of the frames is stated. [1/s]
FRAME_RATE = 60.0
#: Frames from which their time is taken, at most, and points in all of them.
FRAMES, FRAME_POINTS = 10, 1_000_000


class BenchError(Exception):
    """A program that did not do what was asked."""


@dataclass(frozen=True)
class Cost:
    """What a process took: seconds on the wall and of processors, bytes of memory at most."""

    wall: float
    cpu: float
    memory: int
    text: str


def peak_memory(pid: int) -> int:
    """Bytes that a process has held at most so far; 0 when it is gone."""
    try:
        found = re.search(r"^VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text(), re.M)
    except OSError:
        return 0
    return 1024 * int(found[1]) if found else 0


def run(command: list[str], folder: Path) -> Cost:
    """Run a command to its end.

    The peak of the memory is asked for while it runs: what the system tells of a process that has
    ended has the memory of this one in it.
    """
    memory = 0
    with tempfile.TemporaryFile("w+") as output:
        start = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, stdout=output, stderr=subprocess.STDOUT)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            memory = max(memory, peak_memory(process.pid))
            time.sleep(POLL)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read()
    if process.returncode != 0:
        raise BenchError(f"{' '.join(command)} ended with {process.returncode}:\n{text}")
    return Cost(wall, usage.ru_utime + usage.ru_stime, memory, text)


def command_of(program: str, case: Case, steps: int, threads: int, *options: str) -> list[str]:
    """Return the command that runs a case for so many steps."""
    stop = f"driver.properties={{{steps * case.dt!r}}}"
    return [program, "-c", "bench.cfg", "--threads", str(threads), "--set", stop, *options]


def spread(samples: list[float]) -> dict[str, float]:
    """Median and range."""
    return {"median": statistics.median(samples), "min": min(samples), "max": max(samples)}


def phases(text: str) -> dict[str, float]:
    """Read the table that `mpm3d -v` prints: seconds of each phase."""
    rows = re.findall(r"^([\w-]+) +(\d+\.\d+)(?: +\d+\.\d %.*)?$", text, re.M)
    return {name: float(seconds) for name, seconds in rows}


def frames_of(text: str) -> int:
    """Frames that the program says it has written."""
    found = re.findall(r"^frames: +(\d+) in ", text, re.M)
    return int(found[-1]) if found else 1


def stated_memory(text: str) -> float:
    """Bytes of points and nodes that the program states."""
    found = re.search(r"^memory: +(\S+) MB for points and nodes", text, re.M)
    return 1e6 * float(found[1]) if found else 0.0


def measure(
    program: str,
    case: Case,
    threads: int,
    repeat: int,
    seconds: float,
    clock: str,
    kernel: str = "",
) -> dict[str, object]:
    """Measure one case; `clock` is `wall` or `cpu`.

    With a bare kernel it is run before each measurement: the speed of a shared machine changes from
    minute to minute.
    """
    per_step = GUESS * case.points
    seconds = max(seconds, LEAST * case.points)
    steps = SHORT + max(10, min(round(seconds / per_step), int(case.scene.duration / case.dt)))
    samples, kernels, set_up, memory = [], [], [], 0
    for _ in range(repeat):
        if kernel:
            kernels.append(reference(kernel)["kernel_ns"])
        low = run(command_of(program, case, SHORT, threads, "-q"), case.folder)
        high = run(command_of(program, case, steps, threads, "-q"), case.folder)
        check = run(command_of(program, case, SHORT, threads, "-q", "--check"), case.folder)
        spent = getattr(high, clock) - getattr(low, clock)
        samples.append(1e9 * spent / ((steps - SHORT) * case.points))
        set_up.append(check.wall)
        memory = max(memory, high.memory)
    ratios = [sample / beside for sample, beside in zip(samples, kernels, strict=False)]
    told = timed_frames(program, case, threads, steps, binary=False)
    binary = timed_frames(program, case, threads, steps, binary=True)
    loop = {name: s for name, s in phases(told).items() if name not in ("set-up", "output")}
    total = sum(loop.values())
    return {
        "scene": case.scene.name,
        "points": case.points,
        "threads": threads,
        "steps": [SHORT, steps],
        "clock": clock,
        "ns_per_point_and_step": spread(samples),
        **({"kernel_ns": spread(kernels), "kernels": spread(ratios)} if kernel else {}),
        "set_up_s": min(set_up),
        "bytes_per_point": memory / case.points,
        "stated_bytes_per_point": stated_memory(told) / case.points,
        "phases": {name: s / total for name, s in loop.items()} if total > 0.0 else {},
        "frames_share": frames_share(told, case, steps),
        "binary_share": frames_share(binary, case, steps),
    }


def timed_frames(program: str, case: Case, threads: int, steps: int, *, binary: bool) -> str:
    """Run with some frames, of text or binary; return what the program tells.

    There are none before: to replace a file costs more than to write a new one.
    """
    shutil.rmtree(case.folder / "frames", ignore_errors=True)
    wanted = min(FRAMES, max(1, FRAME_POINTS // case.points))
    nodes = 0 if case.scene.cells else 1
    settings = (
        f"serializer.properties={{{wanted / (steps * case.dt)!r}}}",
        f"serializer.int-properties={{binary = {int(binary)}, nodes = {nodes}}}",
    )
    options = [word for setting in settings for word in ("--set", setting)]
    return run(command_of(program, case, steps, threads, "-v", *options), case.folder).text


def frames_share(told: str, case: Case, steps: int) -> float:
    """Return the time of a frame over that of it and the steps until the next one."""
    table = phases(told)
    frame = table.get("output", 0.0) / frames_of(told)
    spent = sum(s for name, s in table.items() if name not in ("set-up", "output"))
    between = spent / steps / (FRAME_RATE * case.dt)
    return frame / (frame + between) if frame > 0.0 else 0.0


def reference(kernel: str) -> dict[str, float]:
    """Run the bare kernel: bandwidth, time and bytes of a point and step."""
    text = run([kernel], Path()).text
    return {name: float(value) for name, value in re.findall(r"^(\w+) +([\d.]+)$", text, re.M)}
