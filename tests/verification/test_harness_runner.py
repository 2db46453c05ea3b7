"""Runs with a program that pretends, records, and their resumption."""

from __future__ import annotations

import json
import stat
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from harness import runner
from harness.case import Parameters
from harness.runner import Program, Records, execute, run_all

# Reads dt from the config, writes a frame, says how long the loop took. Files beside it: `calls`
# and `steps` list its runs and their dt; `fail` makes it fail.
SCRIPT = """#!{python}
import pathlib
import re
import sys

here = pathlib.Path(__file__).parent
if "--version" in sys.argv:
    print("pretender 1.0 (0123, GNU 12.2.0, Release)")
    sys.exit(0)
with (here / "calls").open("a") as file:
    file.write(" ".join(sys.argv[1:]) + "\\n")
text = pathlib.Path(sys.argv[sys.argv.index("-c") + 1]).read_text()
with (here / "steps").open("a") as file:
    file.write(re.search(r"dt = (\\S+)", text)[1] + "\\n")
if (here / "fail").exists():
    print("error: the simulation went bad", file=sys.stderr)
    sys.exit(int((here / "fail").read_text()))
if "serializer.properties=0" not in sys.argv:
    pathlib.Path("frames").mkdir()
    value = float(re.search(r"dt = (\\S+)", text)[1])
    pathlib.Path("frames/fpd.0.bar.0000000000.vtk").write_text(
        "# vtk DataFile Version 2.0\\nx: Frame 0, Time 0.0\\nASCII\\nPOINTS 1 double\\n"
        + str(value) + " 0 0\\n"
    )
print("memory:  0.0279 MB for points and nodes")
print("done: 10 steps in 0.01 s, 12.5 ns per point and step")
"""

CASE = '''"""A case of a point."""
from harness.case import Case
from harness.scene import Body, Scene, lattice


def scene(p):
    points = lattice(1, [0.0], [1.0], [p.cells * p.ppc], 1.0)
    return Scene(1, [1.0], [p.cells], [Body("bar", points, 1.0)], 1.0, 1.0 / p.cells)


def measure(p, out):
    if p.text("bad", ""):
        raise RuntimeError("no such frame")
    if out.status != 0:
        return {"status": out.status}
    return {"x": out.points()[-1].x[0, 0], "frames": len(out.points())}


CASE = Case("Axial bar", "t", "s", "s", scene, measure, lambda results: [], may_fail=MAY_FAIL)
'''


@pytest.fixture
def program(tmp_path: Path) -> Program:
    """Return a program that pretends."""
    path = tmp_path / "bin" / "pretender"
    path.parent.mkdir()
    path.write_text(SCRIPT.format(python=sys.executable))
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return Program.find(path)


@pytest.fixture(autouse=True)
def cases(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Put cases of the test in the place of the real ones; threads see them, processes need not."""
    folder = tmp_path / "cases"
    folder.mkdir()
    (folder / "point.py").write_text(CASE.replace("MAY_FAIL", "False"))
    (folder / "failing.py").write_text(CASE.replace("MAY_FAIL", "True"))
    monkeypatch.setattr(runner, "CASES", folder)
    monkeypatch.setattr(runner, "ProcessPoolExecutor", ThreadPoolExecutor)
    return folder


def make(cells: int, case: str = "point", **options: str) -> Parameters:
    """Return parameters of a run."""
    return Parameters(case, 1, "linear", "-", 2, cells, options)


def calls(program: Program) -> list[str]:
    """Return the arguments of the runs so far."""
    path = program.path.parent / "calls"
    return path.read_text().splitlines() if path.exists() else []


def run(
    program: Program, path: Path, wanted: list[Parameters], *, stop: int = 99, **changes: Any
) -> list[dict[str, Any]]:
    """Run what is wanted; return the records in the order in which they came."""
    found: list[dict[str, Any]] = []

    def done(parameters: Parameters, record: dict[str, Any]) -> bool:
        assert parameters.cells == record["cells"]
        found.append(record)
        return len(found) < stop

    values = {"jobs": 1, "timed": False, "cheapest_first": False} | changes
    run_all(program, wanted, Records(path, fresh=False), done=done, **values)
    return found


def test_program_tells_its_version(program: Program) -> None:
    """Version and a digest of the file."""
    assert program.version == "pretender 1.0 (0123, GNU 12.2.0, Release)"
    before = program.digest
    program.path.write_text(program.path.read_text() + "# changed\n")
    assert Program.find(program.path).digest != before


def test_record_has_parameters_measures_and_cost(program: Program) -> None:
    """Points and steps are those of the scene."""
    record = execute(program.path, "point", make(8, nu="0.3"), timed=False)
    assert record["problem"] == ""
    assert record["measures"] == {"x": 0.125, "frames": 1.0}
    assert (record["points"], record["steps"], record["status"]) == (16, 8, 0)
    assert record["options"] == {"nu": "0.3"}
    assert record["seconds"] > 0.0 and record["memory_mb"] == 0.0279
    assert "loop_seconds" not in record
    assert calls(program) == ["-c scene.cfg --threads 1"]


def test_timed_run_is_repeated_without_frames(program: Program) -> None:
    """Seconds are ns a point and step times points times steps, by the share of a processor."""
    record = execute(program.path, "point", make(8), timed=True)
    cost = record["ns_per_point_step"]
    assert 0.0 < cost <= 12.5
    assert record["loop_seconds"] == pytest.approx(1e-9 * cost * 16 * 8, rel=1e-14)
    assert record["measures"]["frames"] == 1.0
    assert len(calls(program)) > 1
    assert all(call.endswith("--set serializer.properties=0") for call in calls(program)[1:])


def test_failed_run_is_a_problem(program: Program) -> None:
    """The message has the status and what the program said."""
    (program.path.parent / "fail").write_text("2")
    record = execute(program.path, "point", make(8), timed=True)
    assert record["problem"] == "exit status 2: error: the simulation went bad"
    assert record["measures"] == {}


@pytest.mark.parametrize(("status", "is_problem"), [(3, False), (2, True), (1, True)])
def test_case_that_may_fail_does_so_with_status_3_only(
    program: Program, status: int, is_problem: bool
) -> None:
    """Other failures stay problems."""
    (program.path.parent / "fail").write_text(str(status))
    record = execute(program.path, "failing", make(8, "failing"), timed=False)
    assert bool(record["problem"]) is is_problem
    assert record["measures"] == ({} if is_problem else {"status": 3.0})


def test_exception_of_a_case_is_a_problem(program: Program) -> None:
    """It stops no other run."""
    record = execute(program.path, "point", make(8, bad="1"), timed=False)
    assert record["problem"] == "RuntimeError: no such frame"


def test_run_leaves_no_folder(
    program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Folders of runs are removed, also when something fails."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(runner.tempfile, "tempdir", str(folder))
    for parameters in (make(8), make(8, bad="1")):
        execute(program.path, "point", parameters, timed=True)
    assert list(folder.iterdir()) == []


def test_second_session_repeats_nothing(program: Program, tmp_path: Path) -> None:
    """Records are found again; only new runs are made."""
    path = tmp_path / "records" / "quick.jsonl"
    first = run(program, path, [make(8), make(4)])
    assert [record["cells"] for record in first] == [8, 4]
    assert all(record["program"] == program.version for record in first)
    again = run(program, path, [make(4), make(8), make(16)])
    assert len(calls(program)) == 3
    kept = {record["cells"]: record for record in again}
    assert {record["cells"]: record for record in first} == {n: kept[n] for n in (4, 8)}
    assert len(path.read_text().splitlines()) == 3


def test_changes_repeat_runs(program: Program, tmp_path: Path, cases: Path) -> None:
    """Of the program, the case, what cases share, and timing; not of other cases."""
    path = tmp_path / "quick.jsonl"
    run(program, path, [make(8)])
    (cases / "failing.py").write_text("# changed\n")
    run(program, path, [make(8)])
    assert len(calls(program)) == 1
    (cases / "_shared.py").write_text("# of others\n")
    run(program, path, [make(8)])
    assert len(calls(program)) == 1
    (cases / "point.py").write_text((cases / "point.py").read_text() + "import _shared\n")
    run(program, path, [make(8)])
    assert len(calls(program)) == 2
    (cases / "_shared.py").write_text("# new\n")
    run(program, path, [make(8)])
    assert len(calls(program)) == 3
    other = Program(program.path, program.version, "another digest")
    run(other, path, [make(8)])
    assert len(calls(program)) == 4
    run(program, path, [make(8)], timed=True)
    assert len(calls(program)) > 5


def test_problem_is_tried_again(program: Program, tmp_path: Path) -> None:
    """A run that failed has no record that counts."""
    path = tmp_path / "quick.jsonl"
    (program.path.parent / "fail").write_text("1")
    (record,) = run(program, path, [make(8)])
    assert record["problem"]
    (program.path.parent / "fail").unlink()
    (record,) = run(program, path, [make(8)])
    assert record["problem"] == ""
    run(program, path, [make(8)])
    assert len(calls(program)) == 2


def test_half_a_line_is_skipped(program: Program, tmp_path: Path) -> None:
    """A killed session may leave one at the end."""
    path = tmp_path / "quick.jsonl"
    run(program, path, [make(8), make(4)])
    lines = path.read_text().splitlines()
    path.write_text(lines[0] + "\n" + lines[1][:40])
    assert list(Records(path, fresh=False).known) == [json.loads(lines[0])["key"]]
    run(program, path, [make(8), make(4)])
    assert len(calls(program)) == 3


def test_fresh_forgets(program: Program, tmp_path: Path) -> None:
    """The file goes too."""
    path = tmp_path / "quick.jsonl"
    run(program, path, [make(8)])
    assert Records(path, fresh=True).known == {}
    assert not path.exists()


def test_order_of_the_runs(program: Program, tmp_path: Path) -> None:
    """The dearest first, or the cheapest when an answer is wanted soon."""
    wanted = [make(4), make(16), make(8)]
    first = run(program, tmp_path / "a.jsonl", wanted)
    assert sorted(record["cells"] for record in first) == [4, 8, 16]
    run(program, tmp_path / "b.jsonl", wanted, cheapest_first=True)
    steps = (program.path.parent / "steps").read_text().split()
    assert [round(1.0 / float(dt)) for dt in steps] == [16, 8, 4, 4, 8, 16]


def test_session_can_stop(program: Program, tmp_path: Path) -> None:
    """No more is told after the answer was no; known records count too."""
    path = tmp_path / "quick.jsonl"
    many = [make(cells) for cells in range(4, 34)]
    assert len(run(program, path, many, stop=1)) == 1
    assert len(calls(program)) < len(many)
    assert len(run(program, path, many, stop=1)) == 1
