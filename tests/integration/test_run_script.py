"""scripts/run: what a newcomer calls first, here with a program that is built already."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def project(executable: Path, tmp_path: Path) -> Path:
    """Make a folder that looks like the project, with stand-ins for installing and building."""
    project = tmp_path / "project"
    (project / "scripts").mkdir(parents=True)
    shutil.copy(ROOT / "scripts/run", project / "scripts/run")
    python = shlex.quote(sys.executable)
    deps = project / "scripts/deps"
    deps.write_text(f'#!/bin/sh\nif [ "$1" = python ]; then echo {python}; fi\n')
    tools = project / "tools"
    tools.mkdir()
    (tools / "cmake").write_text("#!/bin/sh\n")
    for script in (deps, tools / "cmake"):
        script.chmod(0o755)
    (project / "build").mkdir()
    (project / "build/release").symlink_to(executable.parents[1])
    (project / "mpm_pygen").symlink_to(ROOT / "mpm_pygen")
    ignored = shutil.ignore_patterns("*.points")
    shutil.copytree(ROOT / "configs/bar_1d", project / "configs/bar_1d", ignore=ignored)
    return project


def run(project: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Call scripts/run from the root of the project."""
    environment = {
        **os.environ,
        "PATH": f"{project / 'tools'}:{os.environ['PATH']}",
        "OMP_NUM_THREADS": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = ["bash", "scripts/run", *arguments]
    return subprocess.run(
        command, cwd=project, env=environment, capture_output=True, encoding="utf-8"
    )


def test_a_scene(project: Path) -> None:
    """Points are made once, the scene runs, and the way to its frames and a picture is told."""
    first = run(project, "configs/bar_1d/bar_1d.cfg")
    assert (first.returncode, first.stderr) == (0, "")
    assert "\nMaking the points\n" in first.stdout
    assert "\ndone: 1000 steps" in first.stdout
    frames = project.resolve() / "output/bar_1d"
    assert f"\nThe frames are in {frames}\n" in first.stdout
    assert "-m mpm_pygen view output/bar_1d\n" in first.stdout
    again = run(project, "configs/bar_1d/bar_1d.cfg", "--set", "driver.properties={0.01, 0}")
    assert (again.returncode, again.stderr) == (0, "")
    assert "Making the points" not in again.stdout
    assert f"\nThe frames are in {frames}\n" in again.stdout


def test_mistakes(project: Path) -> None:
    """No config, one that is not there, and one that is wrong have an exit status of their own."""
    assert run(project).returncode == 1
    absent = run(project, "none.cfg")
    assert (absent.returncode, absent.stderr) == (2, "scripts/run: no such file: none.cfg\n")
    wrong = run(project, "configs/bar_1d/bar_1d.cfg", "--set", "job.dt=-1")
    assert wrong.returncode == 2
    assert "error: " in wrong.stderr
    assert "The frames are in" not in wrong.stdout
