"""Bad configs: a message with file and line, exit code 2, and no frame."""

from __future__ import annotations

import resource
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
from bad_input import BAD_INPUT, CONFIG, expect_failure, line_number, write_scene
from scene import Run

JOB = "job\n{\n    dt = 1e-3\n    TYPE = 2\n}\n"
GRID = CONFIG[CONFIG.index("grid\n") : CONFIG.index("body\n")]
BODIES = CONFIG[CONFIG.index("body\n") : CONFIG.index("contact\n")]
WALLS = 'boundary-class = "CartesianBox"'


@dataclass
class Case:
    """A text to replace in the good config, and what the program says of it."""

    name: str
    old: str
    new: str
    #: A part of the message.
    message: str
    #: The start of the line that the message names; None when it names the file as a whole.
    line: str | None


# fmt: off
CASES = [
    # sections
    Case("no-job", JOB, "", 'section "job" is missing', None),
    Case("no-grid", GRID, "", 'section "grid" is missing', None),
    Case("no-bodies", BODIES, "", 'section "body" is missing', None),
    Case("unknown-section", "solver\n", "sover\n", 'unknown section "sover"', "sover"),
    Case("two-grids", "solver\n{", GRID + "solver\n{", 'a second section "grid"', "grid#2"),
    Case("key-outside", JOB, "dt = 1\n" + JOB, 'key "dt" outside of a section', "dt = 1"),
    Case("unclosed-section", "TYPE = 2\n}", "TYPE = 2", "starts within section", "serializer"),
    Case("unclosed-last", '"second"}\n}\n', '"second"}\n', "is never closed", "contact"),
    Case("surplus-brace", "TYPE = 2\n}", "TYPE = 2\n}\n}", '"}" without a "{"', "}#2"),
    # keys and values
    Case("unknown-key", "dt =", "step =", 'unknown key "step" in section "job"', "    step"),
    Case("key-case", "TYPE = 2", "type = 2", 'unknown key "type"', "    type"),
    Case("key-twice", "TYPE = 2", "TYPE = 2\n    TYPE = 3", 'key "TYPE" is given twice',
         "    TYPE#2"),
    Case("no-equals", "dt = 1e-3", "dt 1e-3", 'missing "="', "    dt"),
    Case("no-value", "dt = 1e-3", "dt =", '"dt" takes one value', "    dt"),
    Case("empty-value", "dt = 1e-3", "dt = {}", '"dt" takes one value', "    dt"),
    Case("two-values", "dt = 1e-3", "dt = 1e-3, 2", '"dt" takes one value', "    dt"),
    Case("unclosed-list", "{1.0, 1.0}", "{1.0, 1.0", 'missing "," or "}"', "    int-properties#2"),
    Case("unclosed-string", '"DefaultDriver"', '"DefaultDriver', "unclosed string",
         '    class = "DefaultDr'),
    Case("empty-entry", "{1.0, 1.0}", "{1.0,, 1.0}", "empty entry in the list",
         "    properties = {1.0"),
    Case("nested-list", "{1.0, 1.0}", "{1.0, {1.0}}", "within the list", "    properties = {1.0"),
    Case("no-comma", "{1.0, 1.0}", "{1.0 1.0}", "no comma between two values",
         "    properties = {1.0"),
    # classes
    Case("no-class", '    class = "ExplicitUSL"\n', "", 'section "solver" needs "class"', "solver"),
    Case("wrong-class", '"ExplicitUSL"', '"ExplicitULS"', 'unknown solver class "ExplicitULS"',
         '    class = "ExplicitULS'),
    Case("class-of-mpm-3d", '"ExplicitUSL"', '"TGVErrorSolver"',
         'the solver class "TGVErrorSolver" of mpm_3d is not available', '    class = "TGV'),
    Case("case-in-place-of-a-class", '"ExplicitUSL"', '"ShiftedTGVErrorSolver"',
         "a case of the verification, taylor_green", '    class = "Shifted'),
    Case("material-of-mpm-3d", '"IsotropicLinearElasticity"',
         '"CompressibleDamageMechanicsSandstone"', "cemented rock is left to later",
         "    material-class"),
    Case("wrong-transfer", "int-properties = {1, 1}", 'str-properties = {transfer = "FLOP"}',
         'unknown transfer "FLOP"', "    str-properties = {transfer"),
    Case("flip-of-another-transfer", "int-properties = {1, 1}",
         'properties = {flip = 0.9}\n    str-properties = {"PIC"}',
         "flip does not belong to the transfer PIC", "    properties = {flip"),
    Case("class-of-another-role", '"CartesianLinear"', '"CartesianBox"',
         'unknown grid class "CartesianBox"', '    class = "CartesianBox'),
    Case("wrong-material", '"IsotropicLinearElasticity"', '"IsotropicLinearElastcity"',
         'did you mean "IsotropicLinearElasticity"', "    material-class"),
    Case("no-points-class", '    point-class = "DefaultPoints"\n    node', "    node",
         'needs "point-class"', "body"),
    Case("no-nodes-class", '    node-class = "DefaultNodes"\n    material', "    material",
         'needs "node-class"', "body"),
    Case("props-without-class", '    material-class = "IsotropicLinearElasticity"\n', "",
         '"material-props" without "material-class"', "    material-props"),
    # job
    Case("no-dt", "    dt = 1e-3\n", "", 'job needs "dt"', "job"),
    Case("dt-zero", "dt = 1e-3", "dt = 0", "dt = 0 is not a time step", "    dt"),
    Case("dt-negative", "dt = 1e-3", "dt = -1e-3", "dt must be a finite number above 0", "    dt"),
    Case("dt-nan", "dt = 1e-3", "dt = nan", "dt = nan is not a time step", "    dt"),
    Case("dt-infinite", "dt = 1e-3", "dt = inf", "dt = inf is not a time step", "    dt"),
    Case("dt-word", "dt = 1e-3", "dt = small", '"small" is not a number', "    dt"),
    Case("dt-half-number", "dt = 1e-3", "dt = 1e-3s", '"1e-3s" is not a number', "    dt"),
    Case("dt-fortran", "dt = 1e-3", "dt = 1d-3", "write the exponent with e", "    dt"),
    Case("dt-huge", "dt = 1e-3", "dt = 1e999", '"1e999" is too large', "    dt"),
    Case("type-zero", "TYPE = 2", "TYPE = 0", "TYPE = 0 does not exist", "    TYPE"),
    Case("type-six", "TYPE = 2", "TYPE = 6", "TYPE = 6 does not exist", "    TYPE"),
    Case("type-real", "TYPE = 2", "TYPE = 2.0", '"2.0" is not an integer', "    TYPE"),
    Case("type-exponent", "TYPE = 2", "TYPE = 2e0", '"2e0" is not an integer', "    TYPE"),
    Case("threads-negative", "TYPE = 2", "TYPE = 2\n    threads = -1",
         "threads = -1 is out of bounds", "    threads"),
    Case("threads-many", "TYPE = 2", "TYPE = 2\n    threads = 99999",
         "threads = 99999 is out of bounds", "    threads"),
    Case("start-nan", "TYPE = 2", "TYPE = 2\n    t = nan", "t = nan is not a time", "    t "),
    # counts, kinds and bounds of properties
    Case("stop-before-start", "{0.01}", "{-1}", "is not after the start time",
         "    properties = {-1}"),
    Case("stop-missing", "{0.01}", "{}", 'DefaultDriver needs "t_stop"', '    class = "DefaultDr'),
    Case("stop-nan", "{0.01}", "{nan}", "t_stop must be a finite number", "    properties = {nan}"),
    Case("rate-negative", "{100}", "{-1}", "rate = -1 is out of bounds", "    properties = {-1}"),
    Case("digits-many", "{100}", "{100}\n    int-properties = {18}", "digits = 18 is out of bounds",
         "    int-properties"),
    Case("no-folder", '{"frames", "save", "test"}', '{"", "save", "test"}',
         "the name of the frame folder is empty", "    str-properties"),
    Case("cpdi-flag", "{1, 1}", "{2, 1}", "cpdi = 2 is out of bounds", "    int-properties"),
    Case("cpdi-real", "{1, 1}", "{1.5, 1}", '"1.5" is not an integer', "    int-properties"),
    Case("nu-half", "0.3}", "0.5}", "nu = 0.5 is out of bounds", "    material-props"),
    Case("nu-minus-one", "0.3}", "-1}", "nu = -1 is out of bounds", "    material-props"),
    Case("modulus-zero", "{1e5,", "{0,", "E = 0 is out of bounds", "    material-props"),
    Case("modulus-negative", "{1e5,", "{-1e5,", "E = -1e5 is out of bounds", "    material-props"),
    Case("modulus-infinite", "{1e5,", "{inf,", "E must be a finite number", "    material-props"),
    Case("nu-missing", "{1e5, 0.3}", "{1e5}", 'needs "nu"', "    material-class"),
    Case("surplus-property", "{1e5, 0.3}", "{1e5, 0.3, 7}", "surplus entry", "    material-props"),
    Case("unknown-name", "{1e5, 0.3}", "{E = 1e5, nux = 0.3}", 'has no property "nux"',
         "    material-props"),
    Case("name-twice", "{1e5, 0.3}", "{1e5, 0.3, E = 2}", 'property "E" is given twice',
         "    material-props"),
    Case("position-after-name", "{1e5, 0.3}", "{E = 1e5, 0.3}",
         "without a name behind the named entry", "    material-props"),
    Case("cells-zero", "{10, 10}", "{10, 0}", "Ny = 0 is out of bounds",
         "    int-properties = {10"),
    Case("cells-missing", "{10, 10}", "{10}", 'CartesianLinear needs "Ny"',
         '    class = "CartesianLin'),
    Case("cells-surplus", "{10, 10}", "{10, 10, 10}", "surplus entry", "    int-properties = {10"),
    Case("cells-too-many", "{10, 10}", "{100000, 100000}", "the grid has more than",
         "    int-properties = {100000"),
    Case("cells-not-an-integer", "{10, 10}", "{99999999999, 10}", "is too large for an integer",
         "    int-properties = {9"),
    Case("length-zero", "{1.0, 1.0}", "{1.0, 0}", "Ly = 0 is out of bounds",
         "    properties = {1.0"),
    Case("length-nan", "{1.0, 1.0}", "{nan, 1.0}", "Lx must be a finite number",
         "    properties = {nan"),
    Case("wall-code", WALLS,
         'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {0, 0, 0, 7}',
         "= 7 is out of bounds", "    boundary-int-props"),
    Case("wall-values", WALLS,
         'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {0, 0, 0, 4}',
         "the codes need 3 reals, found 0", "    boundary-class"),
    Case("wall-periodic", WALLS,
         'boundary-class = "CartesianBoxCustom"\n    boundary-int-props = {3, 3, 0, 0}',
         "is not periodic", "    boundary-int-props"),
    Case("gravity-missing", '"DefaultDriver"', '"UserDefinedGravityDriver"', 'needs "gx"',
         '    class = "UserDef'),
    Case("projectile-unknown", 'DefaultDriver"\n    properties = {0.01}',
         'BallisticDriver"\n    properties = {0.01, 1, 0}\n    str-properties = {"thrid"}',
         'there is no body "thrid"', '    str-properties = {"thrid"}'),
    # bodies and contacts
    Case("no-name", '    name = "second"\n', "", 'a body needs a "name"', "body#2"),
    Case("empty-name", 'name = "second"', 'name = ""', '"name" takes one value', '    name = ""'),
    Case("name-with-slash", 'name = "second"', 'name = "a/b"', "becomes part of file names",
         '    name = "a/b'),
    Case("same-name", 'name = "second"', 'name = "first"', 'a second body named "first"', "body#2"),
    Case("contact-of-nobody", '{"first", "second"}', '{"first", "secund"}',
         'there is no body "secund"', "    str-properties#2"),
    Case("contact-with-itself", '{"first", "second"}', '{"first", "first"}', 'both are "first"',
         "    str-properties#2"),
    Case("contact-of-one", '{"first", "second"}', '{"first"}', "the body \"body_2\" is not named",
         '    class = "ContactH'),
    Case("contact-number", 'str-properties = {"first", "second"}', "int-properties = {0, 2}",
         "there is no body number 2", "    int-properties = {0, 2"),
    Case("contact-same-number", 'str-properties = {"first", "second"}', "int-properties = {1, 1}",
         'both are "second"', "    int-properties#3"),
    Case("friction-negative", "{0.4}", "{-0.4}", "mu = -0.4 is out of bounds",
         "    properties = {-0.4"),
    # the points file as the config names it
    Case("no-points-file", '    point-file = "second.points"\n', "", "this body has no points file",
         "body#2"),
    Case("points-missing", '"second.points"', '"third.points"', 'there is no file "third.points"',
         '    point-file = "third'),
    Case("points-folder", '"second.points"', '"."', "is a folder, not a file",
         '    point-file = "."'),
]
# fmt: on


def test_the_good_config(mpm3d: Run, tmp_path: Path) -> None:
    """The config that all cases change is good itself."""
    write_scene(tmp_path)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_bad_config(mpm3d: Run, tmp_path: Path, case: Case) -> None:
    """A config with one fault is refused, with its file and line."""
    assert case.old in CONFIG
    config = CONFIG.replace(case.old, case.new, 1)
    write_scene(tmp_path, config)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    place = "scene.cfg: " if case.line is None else f"scene.cfg:{line_number(config, case.line)}: "
    expect_failure(result, tmp_path, BAD_INPUT, place, case.message)


@pytest.mark.parametrize(
    ("config", "place", "message"),
    [
        pytest.param(b"", "scene.cfg: ", "the config is empty", id="empty"),
        pytest.param(b"# nothing\n\n", "scene.cfg: ", "the config is empty", id="comments-only"),
        pytest.param(
            b"job\n{\n\x00\x01\x7fELF\xff\xfe}", "scene.cfg:3: ", "not a text file", id="binary"
        ),
        pytest.param(
            b"job\n{\n    dt = " + 200_000 * b"x" + b"\n}\n",
            "scene.cfg: ",
            'section "serializer" is missing',
            id="long-value",
        ),
        pytest.param(
            CONFIG.replace("1e-3", 200_000 * "x").encode(),
            "scene.cfg:3: ",
            "is not a number",
            id="long-word",
        ),
        pytest.param(
            CONFIG.replace("dt", 200_000 * "y").encode(),
            "scene.cfg:3: ",
            "unknown key",
            id="long-key",
        ),
        pytest.param(
            CONFIG.replace("{100}", "{" + 100_000 * "1," + "}").encode(),
            "scene.cfg:9: ",
            "surplus entry",
            id="long-list",
        ),
        pytest.param(
            CONFIG.replace('"ExplicitUSL"', '"' + 200_000 * "z" + '"').encode(),
            "scene.cfg:19: ",
            "unknown solver class",
            id="long-class",
        ),
        pytest.param(
            CONFIG.replace("dt", "\u03b4t").encode(), "scene.cfg:3: ", "unexpected", id="greek-key"
        ),
        pytest.param(b"{" * 100_000, "scene.cfg:1: ", '"{" without a section name', id="braces"),
    ],
)
def test_bad_text(mpm3d: Run, tmp_path: Path, config: bytes, place: str, message: str) -> None:
    """What is hardly a config is refused as well, and excerpts of it are short."""
    write_scene(tmp_path)
    (tmp_path / "scene.cfg").write_bytes(config)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, place, message)


def test_a_line_of_200000_characters(mpm3d: Run, tmp_path: Path) -> None:
    """Length alone is no fault: a long comment and long white space change nothing."""
    config = CONFIG.replace("1e-3", " " * 100_000 + "1e-3  # " + 200_000 * "x")
    write_scene(tmp_path, config)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        pytest.param("missing.cfg", "there is no such file", id="missing"),
        pytest.param(".", "this is a folder, not a file", id="folder"),
    ],
)
def test_config_that_cannot_be_read(mpm3d: Run, tmp_path: Path, name: str, message: str) -> None:
    """The path of the config is named."""
    result = mpm3d("-c", name, cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, f"{name}: ", message)


def limit_memory() -> None:
    """Let the program have 1 GB."""
    resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9))


@pytest.mark.parametrize("cells", [20_000, 46_000])
def test_grid_too_large_for_the_memory(executable: Path, tmp_path: Path, cells: int) -> None:
    """A body that spreads over more nodes than the memory can hold is refused before it runs.

    Memory is for the nodes between the points of a body: 4e8, and nearly as many as indices.
    """
    config = CONFIG.replace("{10, 10}", f"{{{cells}, {cells}}}").replace("{1, 1}", "{0, 1}")
    write_scene(tmp_path, config)
    (tmp_path / "first.points").write_text(
        "2\n1 1e-9 0.001 0.001 0 0 1\n1 1e-9 0.999 0.999 0 0 1\n"
    )
    result = subprocess.run(
        [executable, "-c", "scene.cfg", "--check"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        errors="replace",
        preexec_fn=limit_memory,
    )
    expect_failure(result, tmp_path, BAD_INPUT, "scene.cfg: ", "memory")


def test_node_frames_too_large(mpm3d: Run, tmp_path: Path) -> None:
    """A grid of 2e9 nodes is refused though its bodies are small: frames show all nodes."""
    write_scene(tmp_path, CONFIG.replace("{10, 10}", "{46000, 46000}").replace("{1, 1}", "{0, 1}"))
    small = "1\n1 1e-12 0.5 0.5 0 0 1\n"
    (tmp_path / "first.points").write_text(small)
    (tmp_path / "second.points").write_text(small)
    result = mpm3d("-c", "scene.cfg", "--check", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, "scene.cfg: ", "nodes, whose frames would take")
