"""Runs of the program: one after the other or in parallel, recorded as JSON lines."""

from __future__ import annotations

import json
import os
import platform
import re
import resource
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .case import CASES, Case, Output, Parameters, load_case
from .matrix import digest, run_key
from .scene import DIM

#: A run that takes longer is stopped and fails. [s]
TIME_LIMIT = 1800
#: Loops are timed at least so often and so long, but a long one once. [-], [s]
TIMING_RUNS, TIMING_SECONDS = 3, 0.2
LOOP = re.compile(r"^done: .* in (.*), (\S+) ns per point and step", re.MULTILINE)
MEMORY = re.compile(r"^memory: +(\S+) MB", re.MULTILINE)
#: What cases share, in their imports.
SHARED = re.compile(r"^(?:from|import) (_\w+)", re.MULTILINE)
HARNESS = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Program:
    """The program under test."""

    path: Path
    #: Version, git revision, compiler and flags, as the program tells them.
    version: str
    digest: str

    @classmethod
    def find(cls, path: Path) -> Program:
        """Ask a program what it is."""
        command = [str(path), "--version"]
        version = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        return cls(path.resolve(), version.strip(), digest(path.read_bytes().hex()))


def sources_digest(case: str) -> str:
    """Return a digest of the files that decide what a run is and how it is measured."""
    names = ("scene", "scheme", "steps", "frames", "norms", "theory")
    paths = [HARNESS / f"{name}.py" for name in names]
    waiting, known = [CASES / f"{case}.py"], set()
    while waiting:
        path = waiting.pop()
        if path in known or not path.exists():
            continue
        known.add(path)
        waiting += [CASES / f"{name}.py" for name in SHARED.findall(path.read_text())]
    return digest(*[path.read_text() for path in [*paths, *sorted(known)]])


def machine() -> str:
    """Name the processor."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor() or platform.machine()
    names = re.findall(r"^model name\s*:\s*(.*)$", text, re.MULTILINE)
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores"


def run_program(program: Path, folder: Path, *options: str) -> tuple[int, str, str, float]:
    """Run the scene of a folder; return status, output, errors and seconds."""
    command = [str(program), "-c", "scene.cfg", "--threads", "1", *options]
    with (folder / "output.txt").open("w") as out, (folder / "errors.txt").open("w") as err:
        begin = time.perf_counter()
        process = subprocess.Popen(
            command, cwd=folder, stdout=out, stderr=err, preexec_fn=limit_processor_time
        )
        process.wait()
        seconds = time.perf_counter() - begin
    texts = ((folder / name).read_text() for name in ("output.txt", "errors.txt"))
    return process.returncode, *texts, seconds


def memory_of(text: str) -> float | None:
    """Return the memory of points and nodes that the program tells, in MB."""
    match = MEMORY.search(text)
    return float(match[1]) if match else None


def limit_processor_time() -> None:
    """Stop this process after TIME_LIMIT seconds of processor time."""
    resource.setrlimit(resource.RLIMIT_CPU, (TIME_LIMIT, TIME_LIMIT))


def execute(program: Path, case: str, parameters: Parameters, timed: bool) -> dict[str, Any]:
    """Run and measure one run in a folder of its own; never raises."""
    record: dict[str, Any] = {**parameters.record(), "problem": "", "measures": {}}
    folder = Path(tempfile.mkdtemp(prefix="mpm3d-verify-"))
    try:
        module: Case = load_case(CASES / f"{case}.py")
        scene = module.make_scene(parameters)
        scene.write(folder)
        status, text, errors, seconds = run_program(program, folder)
        record |= {
            "status": status,
            "seconds": seconds,
            "memory_mb": memory_of(text),
            "points": sum(len(body.points) for body in scene.bodies),
            "steps": scene.steps,
            "warnings": errors.strip(),
        }
        if status != 0 and not (module.may_fail and status == 3):
            record["problem"] = f"exit status {status}: {errors.strip()}"
        else:
            output = Output(folder, scene, status, text, errors)
            record["measures"] = {
                key: float(value) for key, value in module.measure(parameters, output).items()
            }
        if timed and status == 0:
            record |= time_loop(program, folder, scene.point_steps)
    except Exception as problem:
        record["problem"] = f"{type(problem).__name__}: {problem}"
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return record


def time_loop(program: Path, folder: Path, point_steps: float) -> dict[str, float]:
    """Run a scene without frames; return the least of the program's own times of its steps.

    A short loop is repeated, for other processes disturb it, and the time is that of the processor:
    the program's own times the share that it had of one.
    """
    shutil.rmtree(folder / "frames", ignore_errors=True)
    costs: list[float] = []
    while len(costs) < TIMING_RUNS or (
        sum(costs) * 1e-9 * point_steps < TIMING_SECONDS and len(costs) < 4 * TIMING_RUNS
    ):
        before = time_of_children()
        _, text, _, seconds = run_program(program, folder, "--set", "serializer.properties=0")
        share = min(1.0, (time_of_children() - before) / seconds)
        match = LOOP.search(text)
        if match is None:
            return {}
        costs.append(share * float(match[2]))
        if costs[-1] * 1e-9 * point_steps > 5.0 * TIMING_SECONDS:
            break
    cost = min(costs)
    return {"loop_seconds": cost * 1e-9 * point_steps, "ns_per_point_step": cost}


def time_of_children() -> float:
    """Return the processor time of all programs that this process has run, in seconds."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Records:
    """The JSON lines of all runs, found again by their keys."""

    def __init__(self, path: Path, *, fresh: bool) -> None:
        self.path = path
        self.known: dict[str, dict[str, Any]] = {}
        path.parent.mkdir(parents=True, exist_ok=True)
        if fresh:
            path.unlink(missing_ok=True)
        self.ends_well = True
        if path.exists():
            text = path.read_text()
            self.ends_well = not text or text.endswith("\n")
            for line in text.splitlines():
                try:
                    record = json.loads(line)
                except json.JSONDecodeError:  # a line that was being written when a run was killed
                    continue
                self.known[record["key"]] = record

    def add(self, record: dict[str, Any]) -> None:
        """Append a record."""
        self.known[record["key"]] = record
        with self.path.open("a") as file:
            # A run that was killed may have left half a line.
            separator = "" if self.ends_well else "\n"
            file.write(separator + json.dumps(record) + "\n")
        self.ends_well = True


def estimate(parameters: Parameters) -> float:
    """Return a number that grows like the points times steps of a run."""
    dim = DIM[parameters.sim_type]
    return float(parameters.cells) ** (dim + 1) * float(parameters.ppc) ** dim


def run_all(
    program: Program,
    wanted: Iterable[Parameters],
    records: Records,
    *,
    jobs: int,
    timed: bool,
    cheapest_first: bool,
    done: Callable[[Parameters, dict[str, Any]], bool],
) -> None:
    """Run what has no record yet; the dearest first leaves no core waiting at the end.

    Parameters
    ----------
    program : Program
        The program.
    wanted : Iterable[Parameters]
        The runs.
    records : Records
        Records of former runs; a run without problem is not repeated.
    jobs : int
        Runs at the same time.
    timed : bool
        Measure the loop without frames too.
    cheapest_first : bool
        Begin with the cheapest, for answers that come early.
    done : callable
        Told of every finished run, also of former ones; returns whether to go on.
    """
    about = {
        "program": program.version,
        "machine": machine(),
        "python": platform.python_version(),
    }
    waiting = []
    for parameters in wanted:
        key = run_key(parameters, program.digest + sources_digest(parameters.case), timed)
        former = records.known.get(key)
        if former is not None and not former["problem"]:
            if not done(parameters, former):
                return
        else:
            waiting.append((key, parameters))
    waiting.sort(key=lambda item: estimate(item[1]), reverse=not cheapest_first)
    with ProcessPoolExecutor(max_workers=jobs) as pool:
        futures = {
            pool.submit(execute, program.path, parameters.case, parameters, timed): (
                key,
                parameters,
            )
            for key, parameters in waiting
        }
        for future in as_completed(futures):
            key, parameters = futures[future]
            record = {"key": key, "date": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())}
            record |= future.result() | about
            records.add(record)
            if not done(parameters, record):
                pool.shutdown(wait=True, cancel_futures=True)
                return
