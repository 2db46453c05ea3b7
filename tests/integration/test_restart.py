"""A run that goes on from a checkpoint writes the same bytes as one that was not interrupted."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import h5py
import pytest
from checkpoints import DT, FRAME, SAVED, STEPS, Class, files_of, registered, write_scene
from scene import Result, Run

ROOT = Path(__file__).resolve().parents[2]

#: Choices that examples do not make, and that have a state of their own.
MORE = [
    Class(
        "driver",
        "QuasiStaticDriver-kinetic",
        'driver\n{\n    class = "QuasiStaticDriver"\n'
        "    properties = {1, 0, -9.81, t_ramp = 0.03, viscous = 3, cfl = 0.3}\n"
        "    int-properties = {kinetic = 1}\n}",
    ),
    *(
        Class(
            "solver",
            f"{solver}-{options[0]}",
            f'solver\n{{\n    class = "{solver}"\n{options[1]}\n}}',
        )
        for solver in ("ExplicitUSL", "ExplicitMUSL", "ExplicitUSF")
        for options in (
            ("PIC", '    str-properties = {transfer = "PIC"}'),
            ("APIC", '    str-properties = {transfer = "APIC"}'),
            ("MLS", '    str-properties = {transfer = "MLS"}'),
            ("XPIC", '    str-properties = {transfer = "XPIC"}'),
            ("staggered", "    int-properties = {staggered = 1}"),
        )
    ),
]


def case_name(case: Class) -> str:
    """Return the name of a test."""
    return f"{case.role}-{case.name}"


def classes() -> list[Class]:
    """Return all classes that the program lists; none when there is no program."""
    path = Path(os.environ.get("MPM3D_EXE", ROOT / "build/release/bin/mpm3d")).resolve()

    def run(*arguments: object, cwd: Path) -> Result:
        command = [str(path), *map(str, arguments)]
        return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=True)

    return registered(run, ROOT) if path.is_file() else []


CLASSES = classes()


def is_behind(name: str) -> bool:
    """Whether the number of a frame is behind the checkpoint."""
    number = re.search(r"\.(\d{10})\.vtk$", name)
    if number is None:
        assert name.endswith((".vtkhdf", ".history.csv", ".run.txt"))
        return True
    return int(number[1]) > SAVED // FRAME


def spoil(path: Path) -> None:
    """Spoil the frames of a file behind the checkpoint."""
    with h5py.File(path, "r+") as file:
        first = SAVED // FRAME + 1
        root = file["VTKHDF"]
        n = root["NumberOfPoints"][0]
        for values in root["PointData"].values():
            assert len(values) == n * root["Steps"].attrs["NSteps"]
            values[n * first :] = -1.0
        root["Steps/Values"][first:] = -1.0


def test_all_roles_are_there() -> None:
    """Every role has a class in the list."""
    roles = {case.role for case in CLASSES}
    assert roles == {
        *("serializer", "driver", "solver", "grid", "body", "points", "nodes", "material"),
        *("boundary", "contact", "probe"),
    }


@pytest.mark.parametrize("case", [*CLASSES, *MORE], ids=case_name)
def test_same_bytes(
    mpm3d: Run, case: Class, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """Frames and other files behind the checkpoint are the same, with one and with two threads."""
    write_scene(tmp_path, case.role, case.example, save_time=(SAVED - 0.5) * DT)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    (saved,) = re.findall(r"^saved (.*)$", result.stdout, re.MULTILINE)
    told = re.search(r"^frames: (\d+) in (.+) \(", result.stdout, re.MULTILINE)
    assert told
    assert int(told[1]) == STEPS // FRAME + 1
    frames = tmp_path / told[2]
    whole, others = files_of(frames), files_of(tmp_path)
    behind = {name: data for name, data in whole.items() if is_behind(name)}
    one_file = set(whole) == set(behind)
    assert one_file == (case.name == "VTKHDF")
    assert len(behind) > 0
    for name in [*tmp_path.glob("*.points"), *tmp_path.glob("*.parts")]:
        # The checkpoint has the points.
        others.pop(name.name)
        name.unlink()
    for threads in (1, 2):
        for path in frames.iterdir():
            if path.suffix == ".csv":
                path.write_text(path.read_text() + "9e9,0\n")
            elif one_file:
                spoil(path)
            else:
                path.unlink()
        result = mpm3d("-r", saved, "--threads", threads, cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        step = int(saved.split(".")[-2])
        assert f"going on from step {step}, t = " in result.stdout
        assert files_of(frames) == behind
        assert files_of(tmp_path) == others
    n_bytes = 2 * sum(map(len, behind.values()))
    request.node.user_properties.append(("bytes compared", n_bytes))
