"""Command line of the bench suite; see docs/performance.md."""

from __future__ import annotations

import argparse
import json
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

from bench import report
from bench.instructions import compare_counts, count_scenes, read_record, write_record
from bench.measure import BenchError, measure, reference
from bench.scenes import SCENE, SCENES, write_scene

#: Counts of instructions on record.
RECORD = Path(__file__).parent / "instructions.json"
#: The page with the tables.
PAGE = Path(__file__).parents[1] / "docs" / "performance.md"
#: Points of the sparse scene: a block of 64**3 in 1024**3 cells.
SPARSE = 262_144
#: Rows of the suite beside every scene on one thread: scene, points, threads.
MORE = (
    ("1d-linear", 250_000, 2),
    ("plane-linear", 250_000, 2),
    ("3d-linear", 250_000, 2),
    ("3d-cpdi", 250_000, 2),
    ("3d-quadratic", 250_000, 2),
    ("3d-cubic", 250_000, 2),
    ("3d-contact", 250_000, 2),
    ("3d-linear", 10_000, 1),
    ("3d-linear", 100_000, 1),
    ("3d-linear", 1_000_000, 1),
    ("3d-linear", 1_000_000, 2),
    ("3d-linear", 4_000_000, 1),
)
#: Rows of `--quick`.
QUICK = (
    ("1d-linear", 30_000, 1),
    ("plane-linear", 30_000, 1),
    ("3d-linear", 30_000, 1),
    ("3d-linear", 30_000, 2),
    ("3d-cpdi", 30_000, 1),
    ("3d-contact", 30_000, 1),
    ("3d-sparse", 30_000, 1),
)


def parse(arguments: list[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, prog="scripts/bench")
    parser.add_argument("--program", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--kernel-program", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--quick", action="store_true", help="few scenes, small and short")
    parser.add_argument("--scene", action="append", choices=list(SCENE), help="may repeat")
    parser.add_argument("--points", type=int, default=250_000, help="about so many points")
    parser.add_argument("--threads", type=int, action="append", help="default: 1; may repeat")
    parser.add_argument("--repeat", type=int, default=5, help="measurements of each row")
    parser.add_argument("--seconds", type=float, default=2.0, help="length of a run, about")
    parser.add_argument(
        "--clock",
        choices=("wall", "cpu"),
        default="wall",
        help="time on the wall, or of the processors, which suffers less on a busy machine",
    )
    parser.add_argument("--phases", action="store_true", help="share of each phase, below its row")
    parser.add_argument("--targets", action="store_true", help="only the scenes with a target")
    parser.add_argument("--kernel", action="store_true", help="only the bare kernel and the triad")
    parser.add_argument("--json", type=Path, help="also write everything to this file")
    parser.add_argument("--compare", type=Path, help="compare with a file that --json wrote")
    parser.add_argument("--document", action="store_true", help=f"put the tables into {PAGE.name}")
    counting = parser.add_argument_group("instructions per point and step, by valgrind")
    counting.add_argument("--instructions", action="store_true", help="count them")
    counting.add_argument("--check", action="store_true", help="fail if they grew by over 10 %%")
    counting.add_argument("--record", metavar="REASON", help="put them on record")
    return parser.parse_args(arguments)


def wanted(arguments: argparse.Namespace) -> list[tuple[str, int, int]]:
    """Return scene, points and threads of each row."""
    threads = arguments.threads or [1]
    if arguments.quick:
        return list(QUICK)
    if arguments.targets:
        return [(name, arguments.points, 1) for name in report.TARGETS]
    names = arguments.scene or [scene.name for scene in SCENES]
    rows = [
        (name, SPARSE if name == "3d-sparse" else arguments.points, count)
        for name in names
        for count in threads
    ]
    return rows if arguments.scene else [*rows, *MORE]


def time_scenes(arguments: argparse.Namespace) -> list[report.Row]:
    """Measure and print the rows."""
    classes = subprocess.run(
        [arguments.program, "--list"], check=True, capture_output=True, text=True
    ).stdout.split()
    rows = []
    print(report.HEADER)
    for name, points, threads in wanted(arguments):
        scene = SCENE[name]
        missing = [item for item in scene.classes if item not in classes]
        if missing:
            print(f"{name:20}this program has no {missing[0]}")
            continue
        with tempfile.TemporaryDirectory() as folder:
            case = write_scene(scene, Path(folder), points)
            repeat, seconds = (1, 0.3) if arguments.quick else (arguments.repeat, arguments.seconds)
            kernel = ""
            if report.belongs(name, case.points, threads):
                kernel = arguments.kernel_program
            row = measure(
                arguments.program, case, threads, repeat, seconds, arguments.clock, kernel
            )
        rows.append(row)
        print(report.line(row), flush=True)
        if arguments.phases:
            print(report.phase_line(row), flush=True)
    return rows


def count_instructions(arguments: argparse.Namespace, version: str) -> int:
    """Count instructions; compare them with those on record, or put them there."""
    counts = count_scenes(arguments.program)
    record = read_record(RECORD) if RECORD.exists() else {}
    print(f"{'scene':20}{'instructions per point and step':>32}{'on record':>12}")
    for name, value in counts.items():
        print(f"{name:20}{value:>32.1f}{record.get(name, 0.0):>12.1f}")
    if arguments.record:
        write_record(RECORD, counts, version, arguments.record)
    elif arguments.check:
        grown = compare_counts(counts, record)
        for text in grown:
            print(f"grown by more than 10 %: {text}")
        if grown:
            print("a change on purpose: scripts/bench --instructions --record REASON")
            return 1
    return 0


def main(arguments: argparse.Namespace) -> int:
    """Do what the command line asks for."""
    version = subprocess.run(
        [arguments.program, "--version"], check=True, capture_output=True, text=True
    ).stdout.strip()
    print(f"{version} on {platform.machine()}")
    if arguments.instructions:
        return count_instructions(arguments, version)
    result = {"version": version, "reference": reference(arguments.kernel_program)}
    if arguments.kernel:
        for name, value in result["reference"].items():
            print(f"{name:20}{value:10.2f}")
        return 0
    rows = time_scenes(arguments)
    record = read_record(RECORD) if RECORD.exists() else {}
    result |= {"instructions_per_point_and_step": record, "rows": rows}
    summary = [
        *report.speedups(rows),
        *report.materials(rows),
        *report.targets(rows, result["reference"]),
    ]
    print(*summary, sep="\n")
    if arguments.document:
        table = [version, "", report.HEADER, *map(report.line, rows), "", *summary]
        PAGE.write_text(report.document(PAGE.read_text(), table))
    if arguments.compare:
        earlier = json.loads(arguments.compare.read_text())["rows"]
        print(*report.comparison(rows, earlier), sep="\n")
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(parse()))
    except BenchError as error:
        sys.exit(f"scripts/bench: {error}")
