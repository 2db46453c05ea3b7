"""The scenes in configs/: their points are made, --check passes, and they run a few steps."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from frames import NAME
from scene import Run

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SCENES = sorted(str(path.relative_to(CONFIGS.parent)) for path in CONFIGS.rglob("*.cfg"))
STEPS = 5


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of what the scenes need, with their points made."""
    folder = tmp_path_factory.mktemp("project")
    for name in ("configs", "mpm_pygen"):
        shutil.copytree(
            CONFIGS.parent / name,
            folder / name,
            ignore=shutil.ignore_patterns("*.points", "*.msh", "__pycache__"),
        )
    for script in sorted(folder.glob("configs/*/make_points.sh")):
        made = subprocess.run(
            ["bash", script],
            cwd=folder,
            env={**os.environ, "PYTHON": sys.executable, "PYTHONDONTWRITEBYTECODE": "1"},
            capture_output=True,
            text=True,
        )
        assert made.returncode == 0, made.stderr
        assert made.stderr == ""
        assert list(script.parent.glob("*.points")), script
    return folder


def test_there_are_scenes() -> None:
    """Every TYPE has one, and every folder has a README."""
    types = {
        match[1]
        for scene in SCENES
        for match in re.finditer(r"^ *TYPE = (\d)", (CONFIGS.parent / scene).read_text(), re.M)
    }
    assert types == {"1", "2", "3", "4", "5"}
    assert "configs/two_blocks/two_blocks.cfg" in SCENES
    for scene in SCENES:
        assert (CONFIGS.parent / scene).with_name("README.md").is_file(), scene


@pytest.mark.parametrize("scene", SCENES)
def test_scene(mpm3d: Run, copy: Path, scene: str) -> None:
    """A scene is right as it stands, its dt is stable, and it runs."""
    check = mpm3d("-c", scene, "--check", cwd=copy)
    assert (check.returncode, check.stderr) == (0, "")
    assert "BELOW dt" not in check.stdout
    for limit in re.findall(r"stable step (\S+) s", check.stdout):
        assert time_of(check.stdout, "dt") < float(limit)

    # The stop time is the first property of every driver.
    text = (copy / scene).read_text()
    driver = re.search(r"^driver\s*\{.*?^\s*properties = \{([^}]*)\}", text, re.S | re.M)
    assert driver, scene
    # The rate is that of every serializer.
    serializer = re.search(r"^serializer\s*\{.*?^\s*properties = \{([^}]*)\}", text, re.S | re.M)
    assert serializer, scene
    _, *others = driver[1].split(",")
    _, *options = serializer[1].split(",")
    dt = time_of(check.stdout, "dt")
    stop = time_of(check.stdout, "t") + STEPS * dt
    result = mpm3d(
        *("-c", scene),
        *("--set", f"driver.properties={{{','.join([repr(stop), *others])}}}"),
        *("--set", f"serializer.properties={{{','.join([repr(1 / (STEPS * dt)), *options])}}}"),
        cwd=copy,
    )
    assert (result.returncode, result.stderr) == (0, "")
    steps = re.search(r"^done: (\d+) steps", result.stdout, re.M)
    assert steps
    if "AdaptiveDriver" in text:
        # dt is a bound there.
        assert int(steps[1]) > STEPS
    else:
        runs = re.search(r"^ *# samples\n *int-properties = \{(\d+)", text, re.M)
        assert int(steps[1]) == STEPS * (int(runs[1]) if runs else 1)
    folder = re.search(r"^frames: (\d+) in (.+) \(", result.stdout, re.M)
    assert folder
    assert folder[1] == "2"
    names = [path.name for path in (copy / folder[2]).iterdir() if path.suffix.startswith(".vtk")]
    if "VTKHDF" in text:
        assert len(names) == text.count("\nbody")
        return
    assert len(names) == 2 * 2 * text.count("\nbody")
    assert all(NAME.fullmatch(name) for name in names)


def time_of(report: str, name: str) -> float:
    """Return the start time (t) or the time step (dt) that a report tells of."""
    match = re.search(rf"\b{name} (?:=|at most) (\S+)", report)
    assert match, report
    return float(match[1])


@pytest.mark.parametrize("scene", SCENES)
def test_scene_has_its_picture(scene: str) -> None:
    """The README shows it with the command that makes it, and so does the page of all scenes."""
    folder = (CONFIGS.parent / scene).parent
    readme = (folder / "README.md").read_text("utf-8")
    name = Path(scene).stem
    picture = CONFIGS.parent / "docs" / "images" / f"{name}.png"
    assert f"](../../docs/images/{name}.png)" in readme
    assert re.search(rf"^    mpm-pygen view output/{name} .+$", readme, re.M)
    assert f"](images/{name}.png)" in (CONFIGS.parent / "docs" / "scenes.md").read_text("utf-8")
    data = picture.read_bytes()
    assert data.startswith(b"\x89PNG")
    assert len(data) < 100_000
