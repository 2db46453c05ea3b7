"""Bad points files: a message with file and line, exit code 2, and no frame."""

from __future__ import annotations

from pathlib import Path

import pytest
from bad_input import BAD_INPUT, CONFIG, expect_failure, write_scene
from scene import Run

ROW = "1 0.001 0.25 0.25 0 0 1"
POINTS_CASES = {
    "empty": ("", None, "the points file is empty"),
    "blank": ("\n \n\n", None, "the points file is empty"),
    "count-word": (f"two\n{ROW}\n", 1, '"two" is not a number of points'),
    "count-zero": ("0\n", 1, '"0" is not a number of points'),
    "count-negative": (f"-1\n{ROW}\n", 1, '"-1" is not a number of points'),
    "count-real": (f"1.0\n{ROW}\n", 1, '"1.0" is not a number of points'),
    "count-missing": (f"{ROW}\n", 1, "is not a number of points"),
    "count-huge": (f"99999999999999999999\n{ROW}\n", 2, "the file ends after 1 of"),
    "short": (f"3\n{ROW}\n{ROW}\n", 3, "the file ends after 2 of 3 points"),
    "long": (f"1\n{ROW}\n{ROW}\n", 3, "more than the 1 points"),
    "narrow": ("1\n1 0.001 0.25 0.25 0 1\n", 2, "this row has 6 numbers"),
    "wide": ("1\n1 0.001 0.25 0.25 0 0 0 0 1\n", 2, "this row has 9 numbers"),
    "ragged": (f"2\n{ROW}\n1 0.001 0.25 0.25 0 1\n", 3, "the first row has 7"),
    "word": (f"2\n{ROW}\n1 0.001 0.25 here 0 0 1\n", 3, '"here" in column 4 is not a number'),
    "commas": ("1\n1, 0.001, 0.25, 0.25, 0, 0, 1\n", 2, '"1," in column 1 is not a number'),
    "nan": ("1\n1 0.001 nan 0.25 0 0 1\n", 2, '"nan" in column 3 is not a finite number'),
    "infinite": ("1\n1 0.001 0.25 0.25 -inf 0 1\n", 2, '"-inf" in column 5 is not a finite'),
    "too-large": ("1\n1 0.001 1e999 0.25 0 0 1\n", 2, '"1e999" in column 3 is too large'),
    "mass-zero": (f"2\n{ROW}\n0 0.001 0.25 0.25 0 0 1\n", 3, "mass = 0 of a point must be above 0"),
    "mass-negative": ("1\n-1 0.001 0.25 0.25 0 0 1\n", 2, "mass = -1 of a point"),
    "volume-zero": ("1\n1 0 0.25 0.25 0 0 1\n", 2, "volume = 0 of a point must be above 0"),
    "volume-negative": ("1\n1 -1e-3 0.25 0.25 0 0 1\n", 2, "volume = -0.001 of a point"),
    "active-two": ("1\n1 0.001 0.25 0.25 0 0 2\n", 2, "active = 2 is neither 0 nor 1"),
    "outside": (f"2\n{ROW}\n1 0.001 1.25 0.25 0 0 1\n", 3, "is outside of the grid"),
    "below": ("1\n1 0.001 0.25 -1e-9 0 0 1\n", 2, "is outside of the grid"),
    "wide-point": ("1\n1 4 0.5 0.5 0 0 1\n", 2, "is wider than four cells"),
    "binary": ("1\n\x00\x01\x02\n", 2, "this row has 1 number"),
    "long-line": ("1\n" + 200_000 * "x" + "\n", 2, "this row has 1 number"),
}


@pytest.mark.parametrize("name", POINTS_CASES)
def test_bad_points_file(mpm3d: Run, tmp_path: Path, name: str) -> None:
    """A points file with a fault is refused, with its name and line."""
    text, line, message = POINTS_CASES[name]
    write_scene(tmp_path)
    (tmp_path / "second.points").write_text(text)
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    place = "second.points: " if line is None else f"second.points:{line}: "
    expect_failure(result, tmp_path, BAD_INPUT, place, message)


@pytest.mark.parametrize(
    ("radius", "message"),
    [
        pytest.param("0", "the radius r = 0 of a point must be above 0", id="on-axis"),
        pytest.param("-0.1", "the radius r = -0.1 of a point", id="behind-axis"),
    ],
)
def test_radius_in_type_4(mpm3d: Run, tmp_path: Path, radius: str, message: str) -> None:
    """On the axis a point of an axisymmetric body has no mass."""
    write_scene(tmp_path, CONFIG.replace("TYPE = 2", "TYPE = 4"))
    (tmp_path / "second.points").write_text(f"1\n1 0.001 {radius} 0.25 0 0 1\n")
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    expect_failure(result, tmp_path, BAD_INPUT, "second.points:2: ", message)
