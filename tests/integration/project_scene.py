"""Scenes of configs/ as tests run them: in a copy, with their points made."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from scene import Run

ROOT = Path(__file__).resolve().parents[2]


def run_config(run: Run, name: str, folder: Path, *options: str) -> tuple[Path, str]:
    """Run a scene in a folder; return that of its frames, and what the program says."""
    for part in (f"configs/{name}", "mpm_pygen"):
        if not (folder / part).exists():
            ignored = shutil.ignore_patterns("*.points", "__pycache__")
            shutil.copytree(ROOT / part, folder / part, ignore=ignored)
    environment = {**os.environ, "PYTHON": sys.executable, "PYTHONDONTWRITEBYTECODE": "1"}
    script = folder / "configs" / name / "make_points.sh"
    if script.exists():
        subprocess.run(["bash", script], env=environment, check=True, capture_output=True)
    result = run("-c", f"configs/{name}/{name}.cfg", *options, cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    return folder / "output" / name, result.stdout
