"""Short pieces of code in the manual that the tests of whole configs and tutorials leave out."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene import Run, block, write_points

ROOT = Path(__file__).resolve().parents[2]
RUNNING = ROOT / "docs" / "3_running.md"
FENCED = re.compile(r"^( *)```(.+?)\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)
SECTION = re.compile(r"^(\w+)\n\{\n.*?^\}\n", re.MULTILINE | re.DOTALL)


def snippets(page: Path, info: str) -> list[str]:
    """Return the fenced blocks of a page with these words behind the fence."""
    return [text for _, words, text in FENCED.findall(page.read_text("utf-8")) if words == info]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """Write the scene of the chapter on running, and its points."""
    (config,) = snippets(RUNNING, "cfg complete two_blocks.cfg")
    path = tmp_path / "two_blocks.cfg"
    path.write_text(config, "utf-8")
    write_points(tmp_path / "block_0.points", block(2, [0.35, 0.0], [0.65, 0.3], [12, 12]))
    flying = block(2, [0.1, 0.5], [0.3, 0.7], [8, 8], velocity=[1.0, 0.0])
    write_points(tmp_path / "block_1.points", flying)
    return path


def test_sections_of_the_manual(mpm3d: Run, scene: Path) -> None:
    """Sections that the chapter shows by themselves run in its scene."""
    whole, parts = scene.read_text("utf-8"), snippets(RUNNING, "cfg")
    assert len(parts) > 1
    for part in parts:
        config = whole
        for section in SECTION.finditer(part):
            own = [match for match in SECTION.finditer(config) if match[1] == section[1]]
            if own:
                config = config.replace(own[0][0], section[0])
            else:
                config += section[0]
        assert config != whole
        scene.write_text(config, "utf-8")
        result = mpm3d("-c", scene.name, "--set", "driver.properties=1e-3", cwd=scene.parent)
        assert (result.returncode, result.stderr) == (0, ""), part
        assert ("history: " in result.stdout) == ("history_rate" in part)


def test_arrays_of_vtkhdf_files(mpm3d: Run, scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lines that read a VTKHDF file get times, pressures and the config."""
    options = ("--set", "serializer.class=VTKHDF", "--set", "driver.properties=0.2")
    result = mpm3d("-c", scene.name, "-q", *options, cwd=scene.parent)
    assert (result.returncode, result.stderr) == (0, "")
    monkeypatch.chdir(scene.parent)
    (code,) = snippets(RUNNING, "python")
    found: dict[str, Any] = {}
    exec(code, found)
    np.testing.assert_allclose(found["times"][:3], np.arange(3) / 60, atol=1e-4)
    assert found["pressure"].shape == (144,)
    # The block stands on the floor: it is compressed on the whole.
    assert found["pressure"].mean() > 0.0
    assert "IsotropicLinearElasticity" in found["config"]


def test_case_of_the_verification(monkeypatch: pytest.MonkeyPatch) -> None:
    """A case is made as the page on the verification says."""
    monkeypatch.syspath_prepend(str(ROOT / "verification"))
    from harness.case import Case

    (code,) = snippets(ROOT / "docs" / "verification.md", "python")
    found: dict[str, Any] = dict.fromkeys(("scene", "measure", "judge"), len)
    lines = [line[3:] for line in code.splitlines()]
    exec("\n".join(lines), {"Case": Case, **found}, found)
    assert isinstance(found["CASE"], Case)
    assert found["CASE"].order > 0.0
    for name in ("near", "below", "Finding"):
        assert hasattr(sys.modules["harness.case"], name)
