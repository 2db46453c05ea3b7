"""The tutorials of the manual: their files are written and their commands run in order."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from frames import read_series

ROOT = Path(__file__).resolve().parents[2]
TUTORIALS = ROOT / "docs" / "tutorials"
BLOCK = re.compile(r"^```(\w+)(.*?)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
#: A block of commands starts where the one before it ended, with the same variables.
SHELL = """set -euo pipefail
if [ -f "$TUTORIAL_STATE" ]; then . "$TUTORIAL_STATE"; fi
{commands}
{{ export -p; printf 'cd %q\\n' "$PWD"; }} >"$TUTORIAL_STATE"
"""


class Reader:
    """Somebody who does what a page says, in a home folder of their own."""

    def __init__(self, page: Path, executable: Path, home: Path) -> None:
        self.page = page
        #: What looks like the root of the project.
        self.project = home / "project"
        self.state = home / "state"
        self.folder = self.project
        (self.project / "build").mkdir(parents=True)
        (self.project / "build" / "release").symlink_to(executable.parents[1])
        (self.project / "mpm_pygen").symlink_to(ROOT / "mpm_pygen")
        tools = home / "tools"
        tools.mkdir()
        python = tools / "python3"
        python.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} "$@"\n', "utf-8")
        python.chmod(0o755)
        self.environment = {
            **os.environ,
            "HOME": str(home),
            "PATH": f"{tools}:{os.environ['PATH']}",
            "OMP_NUM_THREADS": "1",
            "PYTHONDONTWRITEBYTECODE": "1",
            "TUTORIAL_STATE": str(self.state),
        }

    def follow(self) -> None:
        """Write every file, run every block of commands, compare with what the page shows."""
        printed, ran = "", 0
        for language, words, text in BLOCK.findall(self.page.read_text("utf-8")):
            if words.split()[:1] == ["file"]:
                (self.folder / words.split()[1]).write_text(text, "utf-8")
            elif words.strip() == "run":
                printed = self.run(text)
                ran += 1
            elif language == "text":
                self.expect(text, printed)
            else:
                assert not words, f"{self.page.name}: a block of an unknown kind: {words}"
        assert ran > 0

    def run(self, commands: str) -> str:
        """Run commands and return what they print."""
        done = subprocess.run(
            ["bash", "-c", SHELL.format(commands=commands)],
            cwd=self.folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            errors="replace",
            timeout=300,
        )
        assert done.returncode == 0, f"{commands}\n{done.stdout}"
        last = self.state.read_text("utf-8").splitlines()[-1]
        self.folder = Path(shlex.split(last)[1])
        return done.stdout

    def expect(self, text: str, printed: str) -> None:
        """Every line that the page shows is in what the commands before it printed."""
        for line in text.splitlines():
            assert line.strip() in printed, f"{line}\nis not in\n{printed}"


def extent(folder: Path, body: str) -> float:
    """Return the width of a body in the last frame over that in the first."""
    first, *_, last = read_series(folder, "fpd", 0, body)
    widths = [np.ptp(frame.positions[:, 0]) for frame in (first, last)]
    return float(widths[1] / widths[0])


@pytest.mark.slow
def test_own_material(executable: Path, tmp_path: Path) -> None:
    """The class is built against the installed library, and its scene flows."""
    reader = Reader(TUTORIALS / "own_material.md", executable, tmp_path)
    reader.follow()
    # A block of viscosity G tau slumps at about 0.3/s; with a long tau it sags by nu rho g H/E.
    assert 1.15 < extent(reader.folder / "output", "putty") < 1.6
    elastic = "'body.putty.material-props={E = 1e5, nu = 0.3, tau = 1e6}'"
    frames = "'serializer.str-properties={elastic, elastic, putty}'"
    reader.run(f"build/putty -c putty.cfg --set {elastic} --set {frames}")
    assert 0.95 < extent(reader.folder / "elastic", "putty") < 1.05
    # What bounds say is checked in the new class as in all others.
    wrong = "'body.putty.material-props={1e5, 0.3, 0}'"
    said = reader.run(f"build/putty -c putty.cfg --check --set {wrong} || echo $?")
    assert "tau = 0 is out of bounds: above 0" in said
    assert said.splitlines()[-1] == "2"


@pytest.mark.slow
def test_first_scene(executable: Path, tmp_path: Path) -> None:
    """The commands run; the picture is the one that the page shows."""
    reader = Reader(TUTORIALS / "first_scene.md", executable, tmp_path)
    reader.follow()
    for name in ("picture.png", "history.png"):
        assert (reader.folder / name).read_bytes().startswith(b"\x89PNG"), name
    assert (reader.folder / "film.gif").read_bytes().startswith(b"GIF89a")
    assert len((reader.folder / "history.csv").read_text().splitlines()) == 1 + 31
