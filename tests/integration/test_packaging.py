"""Installing: what `cmake --install` and the package for Debian hold works far from the build."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from scene import drop_scene

ROOT = Path(__file__).resolve().parents[2]
SHARE = "share/mpm3d"
#: Pages with lines of Fortran: the use of the library, and the state of a class.
PAGES = ("2_installing.md", "4_framework.md")


@pytest.fixture(scope="module")
def build(executable: Path) -> Path:
    """Return the folder of the build."""
    return executable.parents[1]


@pytest.fixture(scope="module")
def installed(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install into a folder, and give the folder another name."""
    folder = tmp_path_factory.mktemp("prefix")
    call("cmake", "--install", build, "--prefix", folder / "first")
    return (folder / "first").rename(folder / "second")


@pytest.fixture(scope="module")
def package(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make the package for Debian."""
    folder = tmp_path_factory.mktemp("package")
    call("cpack", "--config", build / "CPackConfig.cmake", "-G", "DEB", "-B", folder)
    (path,) = folder.glob("*.deb")
    return path


def call(*command: str | Path, **keywords: object) -> str:
    """Run a command and return what it prints."""
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", **keywords
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


def use(prefix: Path, folder: Path) -> None:
    """Make and run a scene with what is in a prefix, in an environment that knows nothing else."""
    tools = folder / "tools"
    tools.mkdir()
    python = tools / "python3"
    python.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} "$@"\n', "utf-8")
    python.chmod(0o755)
    plain = {
        "HOME": str(folder),
        "PATH": f"{prefix / 'bin'}:{tools}:/usr/bin:/bin",
        "OMP_NUM_THREADS": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
        # Where libraries of the tests are, when it is not where the system looks.
        **{key: os.environ[key] for key in ("LD_LIBRARY_PATH",) if key in os.environ},
    }

    def run(*command: str | Path) -> str:
        return call("env", *command, cwd=folder, env=plain)

    assert run("mpm3d", "--version").startswith("mpm3d ")
    assert "accepted by mpm3d --check" in run("mpm-pygen", "scene", "bar_1d", "-o", "bar")
    assert "done: " in run("mpm3d", "-c", "bar/bar_1d.cfg")
    assert "bar_0" in run("mpm-pygen", "view", "output/bar_1d", "--list")
    # A scene that needs no points file runs from where it was installed.
    config = prefix / SHARE / "configs/generated_block/generated_block.cfg"
    assert "stable step" in run("mpm3d", "-c", config, "--check")


def look(prefix: Path) -> None:
    """Everything that belongs to an installation is in its place."""
    completion = prefix / "share/bash-completion/completions/mpm3d"
    assert completion.read_bytes() == (ROOT / "src/app/mpm3d.bash").read_bytes()
    for name in (
        *("README.md", "LICENSE", "CITATION.cff", "CHANGELOG.md", "docs/README.md"),
        *("docs/reference/materials/isotropic_linear_elasticity.md", "docs/images/two_blocks.png"),
        *("docs/verification/README.md", "configs/two_blocks/two_blocks.cfg"),
    ):
        assert (prefix / SHARE / name).read_bytes() == (ROOT / name).read_bytes(), name
    assert (prefix / "share/doc/mpm3d/copyright").read_bytes() == (ROOT / "LICENSE").read_bytes()
    scenes = {path.name for path in (ROOT / "configs").iterdir()}
    assert {path.name for path in (prefix / SHARE / "configs").iterdir()} == scenes
    unwanted = {".points", ".msh", ".pyc", ".vtk"}
    assert [path for path in prefix.rglob("*") if path.suffix in unwanted] == []


def naming(prefix: Path, folder: Path) -> list[str]:
    """Return what in a prefix names a place in a folder.

    Names of sources do not count: gfortran puts them into programs, for messages of its own.
    """
    mark = re.compile(re.escape(os.fsencode(folder)) + rb"[^\0\s\"',;:]*")
    files = [path for path in prefix.rglob("*") if path.is_file()]
    return [
        f"{path.relative_to(prefix)}: {os.fsdecode(place)}"
        for path in files
        for place in mark.findall(path.read_bytes())
        if not place.endswith(b".f90")
    ]


PROJECT = """cmake_minimum_required(VERSION 3.25)
project(mine LANGUAGES Fortran)
{find}
add_executable(mine state.f90 mine.f90)
target_link_libraries(mine PRIVATE mpm3d::mpm3d_core)
"""
STATE = """module mpm_my_material
  use mpm_isotropic_linear_elasticity, only: isotropic_linear_elasticity_t
  use mpm_kinds, only: wp
  use mpm_store, only: store_t
  implicit none
  type, extends(isotropic_linear_elasticity_t) :: my_material_t
    real(wp) :: largest = 0.0_wp
  contains
    procedure :: save => my_material_save
    procedure :: restore => my_material_restore
  end type my_material_t
contains
{procedures}end module mpm_my_material
"""


@pytest.mark.slow
def test_library(installed: Path, tmp_path: Path) -> None:
    """The lines of the manual that use the library make a program that runs a scene."""
    pages = {name: (ROOT / "docs" / name).read_text("utf-8") for name in PAGES}

    def snippet(page: str, language: str) -> str:
        (text,) = re.findall(rf"^```{language}\n(.*?)^```$", pages[page], re.DOTALL | re.MULTILINE)
        return str(text)

    find, _, link = snippet(PAGES[0], "cmake").strip().partition("\n")
    assert link in PROJECT
    (tmp_path / "CMakeLists.txt").write_text(PROJECT.format(find=find))
    program = snippet(PAGES[0], "fortran")
    uses, _, rest = program.partition("\n\n")
    (tmp_path / "mine.f90").write_text(f"program mine\n{uses}\nimplicit none\n{rest}end program\n")
    state = STATE.format(procedures=snippet(PAGES[1], "fortran"))
    (tmp_path / "state.f90").write_text(state)
    build, prefix = tmp_path / "build", f"-DCMAKE_PREFIX_PATH={installed}"
    call("cmake", "-S", tmp_path, "-B", build, "-G", "Ninja", prefix)
    call("cmake", "--build", build)
    drop_scene(rate=100.0, t_stop=0.05).write(tmp_path)
    call(build / "mine", cwd=tmp_path)
    assert len(list((tmp_path / "frames").glob("fpd.*.vtk"))) == 6


@pytest.mark.slow
def test_package(package: Path, build: Path, tmp_path: Path) -> None:
    """The package names the libraries that the program needs, and holds an installation."""
    names = ("Package", "Version", "Depends", "Recommends", "Maintainer", "Description")
    fields = dict(
        line.split(": ", maxsplit=1)
        for line in call("dpkg-deb", "--field", package, *names).splitlines()
        if not line.startswith(" ")
    )
    version = call(build / "bin/mpm3d", "--version").split()[1]
    assert (fields["Package"], fields["Version"]) == ("mpm3d", version)
    assert package.name.startswith(f"mpm3d_{version}_")
    assert fields["Maintainer"] == "the mpm3d contributors"
    needed = {part.split()[0] for part in fields["Depends"].split(", ")}
    assert {"libc6", "libgfortran5", "libgomp1"} <= needed
    uses_hdf5 = "HDF5_Fortran_LIBRARY_hdf5:" in (build / "CMakeCache.txt").read_text("utf-8")
    assert uses_hdf5 == any(name.startswith("libhdf5-fortran") for name in needed)
    assert "python3-numpy" in fields["Recommends"]
    assert "mpm_pygen/__pycache__" in call("dpkg-deb", "--info", package, "prerm")
    call("dpkg-deb", "--extract", package, tmp_path / "root")
    prefix = tmp_path / "root/usr"
    look(prefix)
    (tmp_path / "home").mkdir()
    use(prefix, tmp_path / "home")
    assert naming(prefix, build) == []
