"""The command line: what each option does to a good scene, and what the program tells of itself."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from frames import read_series
from scene import Body, Run, Scene, block, drop_scene, huang

ROLES = [
    "serializer",
    "driver",
    "solver",
    "grid",
    "body",
    "points",
    "part",
    "nodes",
    "material",
    "boundary",
    "contact",
    "probe",
]
ROOT = Path(__file__).resolve().parents[2]
STATES = "as mpm_3d|improved|new|not available"
#: Every class that configs of mpm_3d v3 can name.
REGISTRY = {
    "serializer": "DefaultVTK MinimalVTK SlicePointsVTK DebugVTK FVMDefaultVTK",
    "driver": """DefaultDriver ColumnCollapseDriver UserDefinedGravityDriver CavityFlowDriver
        BallisticDriver ChuteFlowDriver FishRandomSampleDriver FishMixtureModelRandomSampleDriver
        FiniteVolumeDriver FVMVariableStepDriver FVMNumericalDampingDriver FVMBolideImpactDriver
        FVMBolideRestartDriver""",
    "solver": """ExplicitUSL ParallelExplicitUSL ThreadPoolExplicitUSL
        ExplicitUSLwithVolumetricStrainSmoothing ExplicitMixtureSolver TGVErrorSolver
        ShiftedTGVErrorSolver GeneralizedVortexErrorSolver FVMDefaultSolver FVMRungeKuttaSolver
        FVMSteadyStateSolver FVMMixtureSolver FVMMixtureSolverRK4 FVMStaticMixtureSolverRK4
        ParallelMixtureSolverRK4""",
    "grid": """CartesianLinear CartesianPeriodic CartesianCustom CartesianCubic CartesianQuadratic
        CartesianUGIMP CartesianCubicCustom CartesianQuadraticCustom CartesianUGIMPCustom
        CartesianCubic_Offset Linear1DNonUniform TriangularGridLinear TetrahedralGridLinear
        FVMCartesian FVMGmsh2D FVMGmsh3D FVMLinear1DNonUniform""",
    "body": """DefaultBody HydrostaticBody LaunchedBody PrestressedBody WheelBody FVMDefaultBody
        FVMRocketBody""",
    "points": """DefaultPoints ThreadPoolPoints CartesianPoints GmshPoints
        ImprovedQuadraturePoints""",
    "part": "Ball Box SineWave SandPile",
    "nodes": "DefaultNodes",
    "material": """IsotropicLinearElasticity Sand_SachithLocal BarotropicViscousFluid
        CompressibleNeohookeanElasticity SlurryGranularPhase SlurryFluidPhase
        SlurryGranularPhase_wUnderCompaction Cornstarch TillotsonEOSFluid BreakageMechanicsSand
        CompressibleBreakageMechanicsSand CompressibleBreakageMechanicsRestart
        CompressibleDamageMechanicsSandstone Fish FVMBarotropicViscousFluid FVMSlurryFluidPhase
        FVMCarmanKozenyFluid FVMIdealGas FVMSlurryGasPhase""",
    "boundary": """CartesianBox CartesianSmoothBox CartesianFrictionalBox CartesianBoxCustom
        AssignedVelocity GeneralCustomBoundary""",
    "contact": """ContactHuang ContactHuang_ReflectedBoundary ContactRigid_ReflectedBoundary
        ContactLinked SlurryMixture SlurryContact SlurryContact_ReflectedBoundary""",
}
#: Those of them that are not here, beside the FVM ones.
MISSING = {
    "FiniteVolumeDriver",
    "ParallelMixtureSolverRK4",
    "TGVErrorSolver",
    "ShiftedTGVErrorSolver",
    "GeneralizedVortexErrorSolver",
    "CompressibleBreakageMechanicsSand",
    "CompressibleBreakageMechanicsRestart",
    "CompressibleDamageMechanicsSandstone",
}


def touching_scene() -> Scene:
    """Make two blocks in contact."""
    return drop_scene(
        bodies=[
            Body("low", block(2, [0.3, 0.2], [0.7, 0.4], [8, 4], velocity=[0.0, 1.0])),
            Body("high", block(2, [0.4, 0.45], [0.6, 0.6], [4, 3], velocity=[1.0, -1.0])),
        ],
        contacts=[huang("low", "high")],
        gravity=[0.0, -9.81],
        rate=100.0,
        t_stop=0.02,
    )


def entry(line: str) -> tuple[str, str, str]:
    """Return name, state and purpose or reason of a line of --list; no name: what is better."""
    match = re.fullmatch(rf"  (\w+|) +({STATES}):? +(.*)", line)
    assert match is not None, line
    return match[1], match[2], match[3]


def listed_classes(run: Run, folder: Path) -> dict[str, list[str]]:
    """Return the classes by role, as --list prints them, without those that are missing."""
    result = run("--list", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    role, classes = "", dict[str, list[str]]()
    for line in result.stdout.splitlines():
        if line.startswith(" "):
            name, state, text = entry(line)
            assert len(text) > 20 or state == "improved"
            if name and state != "not available":
                classes[role].append(name)
        else:
            role = line
            classes[role] = []
    return classes


def test_version(mpm3d: Run, tmp_path: Path) -> None:
    """One line with version, compiler and kind of build."""
    result = mpm3d("--version", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert re.fullmatch(r"mpm3d \d+\.\d+\.\d+ \(.+, .+, .+\)\n", result.stdout)


@pytest.mark.parametrize("option", ["--help", "-h"])
def test_help(mpm3d: Run, tmp_path: Path, option: str) -> None:
    """The help names every option and exit code."""
    result = mpm3d(option, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    for word in (
        *("-c", "--check", "--estimate", "--list", "--describe", "--version", "--help"),
        *("--threads", "--max-memory", "--set", "-q", "-v", "exit status", "examples"),
    ):
        assert word in result.stdout, word


def test_list(mpm3d: Run, tmp_path: Path) -> None:
    """Every role has classes; none has two of one name."""
    classes = listed_classes(mpm3d, tmp_path)
    assert sorted(classes) == sorted(ROLES)
    for role, names in classes.items():
        assert names, role
        assert len(set(names)) == len(names)
    expected = {
        "serializer": {"DefaultVTK", "MinimalVTK"},
        "driver": {"DefaultDriver", "UserDefinedGravityDriver", "BallisticDriver"},
        "solver": {"ExplicitUSL", "ExplicitMUSL", "ExplicitUSF"},
        "grid": {"CartesianLinear"},
        "body": {"DefaultBody"},
        "points": {"DefaultPoints", "CartesianPoints"},
        "part": {"Ball", "Box", "SandPile", "SineWave"},
        "nodes": {"DefaultNodes"},
        "material": {"IsotropicLinearElasticity"},
        "boundary": {
            "CartesianBox",
            "CartesianSmoothBox",
            "CartesianFrictionalBox",
            "CartesianBoxCustom",
        },
        "contact": {"ContactHuang", "ContactLinked"},
    }
    for role, names in expected.items():
        assert names <= set(classes[role])


@pytest.mark.parametrize("role", ["material", "materials", "boundaries", "bodies", "contacts"])
def test_list_of_a_role(mpm3d: Run, tmp_path: Path, role: str) -> None:
    """A role may be named in singular or plural."""
    result = mpm3d("--list", role, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    head, *lines = result.stdout.splitlines()
    assert head == role
    singular = {"bodies": "body", "boundaries": "boundary"}.get(role, role.rstrip("s"))
    entries = [entry(line) for line in lines]
    names = [name for name, state, _ in entries if name and state != "not available"]
    assert names == listed_classes(mpm3d, tmp_path)[singular]


def test_list_has_every_class_of_mpm_3d(mpm3d: Run, tmp_path: Path) -> None:
    """Each is listed under its role with a state; a reason stands with all but those kept."""
    for role, names in REGISTRY.items():
        result = mpm3d("--list", role, cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        entries = [entry(line) for line in result.stdout.splitlines()[1:]]
        states = {name: state for name, state, _ in entries if name}
        improved = sum(state == "improved" for name, state, _ in entries if not name)
        assert improved == sum(state == "improved" for state in states.values())
        for name in names.split():
            missing = name.startswith("FVM") or name in MISSING
            assert name in states, name
            assert (states[name] == "not available") == missing, name
            assert states[name] != "new", name
            if missing:
                described = mpm3d("--describe", name, cwd=tmp_path)
                assert described.returncode == 1
                reason = next(text for other, _, text in entries if other == name)
                assert f'class "{name}" of mpm_3d is not available' in described.stderr
                assert reason in described.stderr
        others = [state for name, state in states.items() if name not in names.split()]
        assert set(others) <= {"new"}


def test_cases_in_place_of_solvers() -> None:
    """The cases that the messages name are there."""
    source = (ROOT / "src" / "config" / "original_classes.f90").read_text("utf-8")
    named = re.findall(r"a case of the verification,[ &\n]*(\w+)", source)
    assert sorted(named) == ["taylor_green", "taylor_green", "vortex"]
    pages = re.findall(r"docs/verification/\w+\.md", source)
    assert len(pages) == len(named)
    for name, page in zip(named, pages, strict=True):
        assert (ROOT / "verification" / "cases" / f"{name}.py").is_file()
        assert f"({name})" in (ROOT / page).read_text("utf-8")


def test_describe_every_class(mpm3d: Run, tmp_path: Path) -> None:
    """A description has role, purpose, source, properties with their meaning, and an example."""
    for role, names in listed_classes(mpm3d, tmp_path).items():
        for name in names:
            result = mpm3d("--describe", name, cwd=tmp_path)
            assert (result.returncode, result.stderr) == (0, "")
            text = result.stdout
            assert text.startswith(f"{name} ({role})\n  ")
            assert max(map(len, text.splitlines())) <= 100, name
            body, example = text.split("\nexample\n")
            assert f'class = "{name}"' in example, name
            assert "\nsource\n  " in body, name
            # A property is a line of its own, with its meaning below.
            for kind in ("reals", "integers", "strings"):
                for match in re.finditer(rf"^{kind} \(.*\)\n((?:  .*\n)+)", body, re.M):
                    lines = match[1].splitlines()
                    heads = [i for i, line in enumerate(lines) if line[:6].strip()]
                    assert heads[0] == 0
                    for i in heads:
                        assert re.match(r"  [A-Za-z]\w*( \[.+\])?,? ?", lines[i]), lines[i]
                        assert lines[i + 1].startswith("      "), lines[i]


@pytest.mark.parametrize(
    ("name", "properties"),
    [
        ("ContactHuang", ["mu", "body_1", "body_2", "id_1", "id_2"]),
        ("IsotropicLinearElasticity", ["E [Pa]", "nu"]),
        ("CartesianLinear", ["Lx [m]", "Ly [m]", "Lz [m]", "Nx", "Ny", "Nz"]),
        ("ExplicitUSL", ["cpdi", "contact", "staggered", "transfer", "flip", "xpic_order"]),
        ("DefaultVTK", ["rate [1/s]", "digits", "frame_folder", "save_folder", "run_name"]),
        ("UserDefinedGravityDriver", ["t_stop [s]", "gx [m/s2]", "gy [m/s2]", "gz [m/s2]"]),
        ("BallisticDriver", ["t_stop [s]", "vx [m/s]", "vy [m/s]", "vz [m/s]", "projectile"]),
    ],
)
def test_describe_names_properties(
    mpm3d: Run, tmp_path: Path, name: str, properties: list[str]
) -> None:
    """All properties of a class appear, with their units."""
    text = mpm3d("--describe", name, cwd=tmp_path).stdout
    for item in properties:
        assert re.search(rf"^  {re.escape(item)},", text, re.M), item


def test_named_property_is_the_described_one(mpm3d: Run, tmp_path: Path) -> None:
    """A name that --describe gives is taken in a config; the message on another names the class."""
    touching_scene().write(tmp_path)
    good = mpm3d(
        *("-c", "scene.cfg", "--check", "--set", "body.low.material-props={E = 2e5, nu = 0.1}"),
        cwd=tmp_path,
    )
    assert (good.returncode, good.stderr) == (0, "")
    bad = mpm3d(
        *("-c", "scene.cfg", "--check", "--set", "body.low.material-props={E = 2e5, mu = 0.1}"),
        cwd=tmp_path,
    )
    assert bad.returncode == 2
    assert "mpm3d --describe IsotropicLinearElasticity" in bad.stderr


def test_check(mpm3d: Run, tmp_path: Path) -> None:
    """--check reports sizes, memory, times and the stable step; it writes and runs nothing."""
    scene = touching_scene()
    scene.write(tmp_path)
    before = sorted(os.listdir(tmp_path))
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert sorted(os.listdir(tmp_path)) == before
    text = result.stdout
    assert "TYPE 2 (plane strain)" in text
    assert "10 x 10 cells, 121 nodes" in text
    assert re.search(r'"low", 32 points, mass 80 kg, wave speed \S+ m/s, stable step \S+ s', text)
    assert re.search(r'"high", 12 points, mass 30 kg', text)
    assert re.search(r"^contacts: 1$", text, re.M)
    assert re.search(r"^memory: .*MB", text, re.M)
    assert "t = 0 to 0.02 s, dt = 0.001 s, 20 steps" in text
    assert re.search(r"^frames: +3 in frames", text, re.M)
    assert "done" not in text


def test_check_finds_faults(mpm3d: Run, tmp_path: Path) -> None:
    """--check reads the points as a run does."""
    touching_scene().write(tmp_path)
    (tmp_path / "high.points").write_text("1\n1 0.001 0.5 2.5 0 0 1\n")
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr.startswith("high.points:2: error: ")


def test_summary_of_a_run(mpm3d: Run, tmp_path: Path) -> None:
    """A run tells of itself at its start and end; without a terminal there is no progress line."""
    touching_scene().write(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    text = result.stdout
    assert "running 20 steps on 1 thread" in text
    assert re.search(
        r"^done: 20 steps to t = 0.02 s in .* ns per point and step, frames included$", text, re.M
    )
    assert re.search(r"^momentum: .* -> .* kg m/s", text, re.M)
    assert re.search(r"^energy: kinetic .*, strain .*, potential .* J", text, re.M)
    assert re.search(r"^frames: 3 in frames", text, re.M)
    assert "\r" not in text


def test_quiet_and_verbose(mpm3d: Run, tmp_path: Path) -> None:
    """-q says nothing; -v adds a line for every frame and a table of the phases; frames stay."""
    touching_scene().write(tmp_path)
    quiet, usual, verbose = (
        mpm3d("-c", "scene.cfg", *options, cwd=tmp_path) for options in (["-q"], [], ["-v"])
    )
    for result in (quiet, usual, verbose):
        assert (result.returncode, result.stderr) == (0, "")
    assert quiet.stdout == ""
    lines = verbose.stdout.splitlines()
    first = lines.index("phase       seconds   share   ns per point and step")
    assert first == len(usual.stdout.splitlines()) + 3
    assert "frame 1 at t = 0.01 s, step 10" in verbose.stdout
    assert lines[first + 1].split()[0] == "set-up"
    rows = [line.split() for line in lines[first + 2 :]]
    names = ["sort", "P2G", "nodes", "contact", "G2P", "material", "output", "other"]
    assert [row[0] for row in rows] == names
    assert all(float(row[1]) >= 0.0 and float(row[4]) >= 0.0 for row in rows)
    # The shares are rounded to a tenth.
    assert sum(float(row[2]) for row in rows) == pytest.approx(100.0, abs=0.05 * len(rows))
    assert len(read_series(tmp_path / "frames", "fpd", 0, "low")) == 3


def test_quiet_check(mpm3d: Run, tmp_path: Path) -> None:
    """--check -q is silent when all is well."""
    touching_scene().write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--check", "-q", cwd=tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


@pytest.mark.parametrize(
    ("option", "line"),
    [
        ("job.dt=5e-4", "dt = 0.0005 s, 40 steps"),
        ("job.t=0.01", "t = 0.01 to 0.02 s, dt = 0.001 s, 10 steps"),
        ("driver.properties={0.05, 0, 0}", "t = 0 to 0.05 s"),
        ("driver.properties={t_stop=0.05, gx = 0, gy = 0}", "t = 0 to 0.05 s"),
        ("driver.properties = 0.05, 0, 0", "t = 0 to 0.05 s"),
        ("grid.int-properties={20, 5}", "20 x 5 cells, 126 nodes"),
        ("serializer.properties=0", "frames:  1 in frames"),
        ('serializer.str-properties={"other", "save", "test"}', "in other"),
        ("body.low.material-props={4e5, 0.3}", '"low", 32 points, mass 80 kg, wave speed 23.2048'),
        ("body.0.material-props={4e5, 0.3}", '"low", 32 points, mass 80 kg, wave speed 23.2048'),
        ("body.1.material-props={4e5, 0.3}", '"high", 12 points, mass 30 kg, wave speed 23.2048'),
        ('body.high.name="roof"', 'there is no body "high"'),
        ("body.high.point-file=low.points", '"high", 32 points'),
        ("contact.0.str-properties={high, low}", "contacts: 1"),
        ("contact.touch.properties=-1", "mu = -1 is out of bounds"),
        ("contact.0.properties=-1", "mu = -1 is out of bounds"),
    ],
)
def test_set(mpm3d: Run, tmp_path: Path, option: str, line: str) -> None:
    """--set changes one key of the section that it names, for --check as for a run."""
    touching_scene().write(tmp_path)
    result = mpm3d("-c", "scene.cfg", "--check", "--set", option, cwd=tmp_path)
    assert line in (result.stderr if result.returncode else result.stdout)


def test_set_repeated(mpm3d: Run, tmp_path: Path) -> None:
    """--set may repeat, and the last one wins."""
    touching_scene().write(tmp_path)
    options = ["--set", "job.dt=1", "--set", "job.t=0.01", "--set", "job.dt=5e-4"]
    result = mpm3d("-c", "scene.cfg", "--check", *options, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "t = 0.01 to 0.02 s, dt = 0.0005 s, 20 steps" in result.stdout


def test_set_is_the_same_as_editing(mpm3d: Run, tmp_path: Path) -> None:
    """Frames of a changed config and of --set are equal."""
    scene = touching_scene()
    scene.write(tmp_path / "set")
    assert not mpm3d(
        *("-c", "scene.cfg", "--set", "contact.touch.properties=0", "--set", "job.dt=5e-4"),
        cwd=tmp_path / "set",
    ).returncode
    scene.dt, scene.contacts = 5e-4, [huang("low", "high", 0.0)]
    scene.write(tmp_path / "edited")
    assert not mpm3d("-c", "scene.cfg", cwd=tmp_path / "edited").returncode
    names = sorted(path.name for path in (tmp_path / "set" / "frames").glob("*.vtk"))
    assert len(names) == 12
    for name in names:
        path = Path("frames") / name
        assert (tmp_path / "set" / path).read_bytes() == (tmp_path / "edited" / path).read_bytes()


def test_options_in_any_order(mpm3d: Run, tmp_path: Path) -> None:
    """The config need not come first."""
    touching_scene().write(tmp_path)
    result = mpm3d("--threads", "1", "--check", "--config", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
