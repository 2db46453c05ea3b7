"""Instructions per point and step of small scenes: a figure without noise.

They are counted by valgrind's callgrind with the portable build, whose code does not depend on the
machine that compiles it.
"""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path

from bench.measure import BenchError, command_of, run
from bench.scenes import SCENE, Case, write_scene

#: Scenes and their numbers of points.
COUNTED = {
    "3d-linear": 4000,
    "3d-cpdi": 4000,
    "plane-contact": 4000,
    "plane-triangles": 4000,
    "3d-tetrahedra-cpdi": 4000,
}
#: Lengths of the two runs whose difference counts.
STEPS = (2, 12)
#: Growth of a count that fails.
TOLERANCE = 0.10


def count(program: str, case: Case, steps: int) -> int:
    """Count the instructions of a whole run on one thread."""
    command = command_of(program, case, steps, 1, "-q")
    valgrind = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    text = run([*valgrind, *command], case.folder).text
    found = re.search(r"Collected : (\d+)", text)
    if not found:
        raise BenchError(f"valgrind tells no count:\n{text}")
    return int(found[1])


def count_scenes(program: str) -> dict[str, float]:
    """Instructions per point and step of each scene."""
    counts = {}
    for name, points in COUNTED.items():
        with tempfile.TemporaryDirectory() as folder:
            case = write_scene(SCENE[name], Path(folder), points)
            low, high = (count(program, case, steps) for steps in STEPS)
        counts[name] = round((high - low) / ((STEPS[1] - STEPS[0]) * case.points), 1)
    return counts


def compare_counts(counts: dict[str, float], record: dict[str, float]) -> list[str]:
    """Return a line for each scene whose count grew by more than the tolerance."""
    lines = []
    for name, value in counts.items():
        if name not in record:
            lines.append(f"{name}: no count on record")
        elif value > (1.0 + TOLERANCE) * record[name]:
            lines.append(f"{name}: {value:.1f} instructions, {record[name]:.1f} on record")
    return lines


def read_record(path: Path) -> dict[str, float]:
    """Read the counts on record."""
    return json.loads(path.read_text())["instructions_per_point_and_step"]


def write_record(path: Path, counts: dict[str, float], version: str, reason: str) -> None:
    """Put counts on record, with the reason for the change."""
    record = {"version": version, "reason": reason, "instructions_per_point_and_step": counts}
    path.write_text(json.dumps(record, indent=1) + "\n")
