"""Fixtures of the tests that run the program.

The executable is the one that the environment variable MPM3D_EXE names, or that of the release
build in build/.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from scene import Result, Run

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def executable() -> Path:
    """Path of the program."""
    path = Path(os.environ.get("MPM3D_EXE", ROOT / "build/release/bin/mpm3d")).resolve()
    if not path.is_file():
        pytest.fail(f"no executable {path}: build it, or set MPM3D_EXE", pytrace=False)
    return path


@pytest.fixture(scope="session")
def mpm3d(executable: Path) -> Run:
    """Return a function that runs the program and keeps what it prints."""

    def run(*arguments: object, cwd: Path, environment: dict[str, str] | None = None) -> Result:
        return subprocess.run(
            [str(executable), *map(str, arguments)],
            cwd=cwd,
            env={**os.environ, "OMP_NUM_THREADS": "1", **(environment or {})},
            capture_output=True,
            text=True,
            errors="replace",
            timeout=120,
        )

    return run


@pytest.fixture(scope="session")
def root() -> Path:
    """Root folder of the project."""
    return ROOT
