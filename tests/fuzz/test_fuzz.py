"""The fuzzer itself: what it makes does not depend on chance, and it finds what it should."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import fuzz
import pytest
from mutate import KINDS, MOST, make_input
from seeds import collect

#: A reader that fails in a way that a word of its input chooses.
READER = """#!{python}
import os, sys, time
for line in sys.stdin:
    path = line.strip()
    text = open(path, errors="replace").read()
    if "zzoverflow" in text:
        sys.exit("x.f90:12:3: runtime error: signed integer overflow: 1 + 2147483647")
    if "zzsignal" in text:
        os.kill(os.getpid(), 11)
    code, seconds = 2, 0.01
    if "zzslow" in text:
        seconds = 1.5
    if "zzlost" in text:
        code = 4
    print(code, f"{{seconds:.6f}}", path, flush=True)
"""


@pytest.fixture
def reader(tmp_path: Path) -> Path:
    """Return a program that takes the place of the reader."""
    path = tmp_path / "reader"
    path.write_text(READER.format(python=sys.executable))
    path.chmod(0o755)
    return path


def test_inputs_follow_from_the_seed() -> None:
    """The same seed and number give the same input; all kinds are made."""
    seeds = collect()
    made = [make_input(seeds, 7, i) for i in range(300)]
    assert made == [make_input(seeds, 7, i) for i in range(300)]
    assert made != [make_input(seeds, 8, i) for i in range(300)]
    assert {ending.rpartition(".")[2] for ending, _ in made} == set(KINDS)
    assert all(len(data) <= MOST for _, data in made)


@pytest.mark.parametrize(
    ("word", "cause"),
    [
        ("zzoverflow", "runtime error: signed integer overflow: N + N at x.f90:12"),
        ("zzsignal", "exit -11"),
        ("zzslow", "slow"),
        ("zzlost", "exit code 4"),
    ],
)
def test_failures_are_found_and_made_small(
    reader: Path, tmp_path: Path, word: str, cause: str
) -> None:
    """Each way to fail is noticed, and the inputs around it are read."""
    tally = fuzz.Tally()
    process = fuzz.Reader(reader)
    bad = f"a\nb\n c = {word} , 1\nd\n".encode()
    process.read([("cfg", b"good"), ("cfg", bad), ("cfg", b"good")], tally)
    process.close()
    assert tally.codes[2] == (3 if word == "zzslow" else 2)
    assert [f.cause for f in tally.failures] == [cause]
    kept = fuzz.keep(reader, tally.failures, tmp_path / "out")
    assert [f.data for f in kept] == [word.encode()]
    assert {p.read_bytes() for p in (tmp_path / "out").glob("*.cfg")} == {bad, word.encode()}


def test_exit_status(reader: Path, tmp_path: Path) -> None:
    """The command line tool counts inputs; a failure is its exit status."""
    command = [sys.executable, fuzz.__file__, "--reader", str(reader), "--out", str(tmp_path)]
    result = subprocess.run(
        [*command, "--inputs", "40", "--workers", "2"], capture_output=True, text=True
    )
    assert result.returncode == 0, result.stdout + result.stderr
    assert "40 inputs: 0 read to the end, 40 refused, 0 failures" in result.stdout
    (tmp_path / "a.cfg").write_text("zzsignal")
    result = subprocess.run([*command, str(tmp_path / "a.cfg")], capture_output=True, text=True)
    assert result.returncode == 1
    assert "exit -11" in result.stdout
