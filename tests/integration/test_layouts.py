"""One scene in many layouts of its config: the frames do not differ in a byte."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from bad_input import CONFIG, write_scene
from scene import Run


def sections(text: str) -> list[str]:
    """Split a config behind the closing brace of each section."""
    return re.findall(r"\w+\n\{.*?\n\}\n", text, re.DOTALL)


def lists_over_lines(text: str) -> str:
    """Put each entry of a list on a line of its own, with a comma behind the last one."""

    def spread(match: re.Match[str]) -> str:
        entries = "".join(f"\n        {entry.strip()}," for entry in match[1].split(","))
        return f"{{ # a list{entries}\n    }}"

    return re.sub(r"\{([^{}\n]+)\}", spread, text)


def commented(text: str) -> str:
    """Put comments wherever they may stand."""
    lines = [f'{line}   # a "comment" {{ with = marks' for line in text.split("\n")]
    return "# first\n\n" + "\n   # between {\n".join(lines)


def named(text: str) -> str:
    """Name the entries of all lists."""
    for positional, by_name in (
        ("{100}", "{rate = 100}"),
        (
            '{"frames", "save", "test"}',
            '{run_name = test, frame_folder = frames, save_folder = ""}',
        ),
        ("{0.01}", "{t_stop = 0.01}"),
        ("{1, 1}", "{contact = 1, cpdi = 1}"),
        ("{1.0, 1.0}", "{Ly = 1, Lx = 1}"),
        ("{10, 10}", "{10, Ny = 10}"),
        ("{1e5, 0.3}", "{nu = 0.3, E = 1e5}"),
        ("{0.4}", "{mu = 4e-1}"),
        ('{"first", "second"}', "{body_2 = second, body_1 = first}"),
    ):
        assert positional in text
        text = text.replace(positional, by_name)
    return text


LAYOUTS: dict[str, Callable[[str], str]] = {
    "brace-on-the-same-line": lambda text: re.sub(r"\n\{", " {", text),
    "blank-lines-before-the-brace": lambda text: re.sub(r"\n\{", "\n\n  # here\n\n{", text),
    "lists-over-lines": lists_over_lines,
    "comments": commented,
    "unquoted": lambda text: text.replace('"', ""),
    "single-quotes": lambda text: text.replace('"', "'"),
    "lists-without-braces": lambda text: re.sub(r"= \{(.*)\}", r"= \1", text),
    "trailing-commas": lambda text: re.sub(r"= \{(.*)\}", r"= {\1 , }", text),
    "carriage-returns": lambda text: text.replace("\n", "\r\n"),
    "byte-order-mark": lambda text: "\ufeff" + text,
    "no-last-newline": lambda text: text.rstrip("\n"),
    "tabs": lambda text: text.replace("    ", "\t").replace(" = ", "\t=\t"),
    "no-blanks": lambda text: text.replace(" ", ""),
    "wide": lambda text: text.replace(",", "   ,   ").replace("{", "{   ").replace("=", "    =  "),
    "named-entries": named,
    # Bodies keep their order, which numbers them.
    "sections-reversed": lambda text: "".join(
        [s for s in reversed(sections(text)) if not s.startswith("body")]
        + [s for s in sections(text) if s.startswith("body")]
    ),
    "keys-reversed": lambda text: re.sub(
        r"\n\{\n(.*?\n)\}\n",
        lambda match: "\n{\n" + "".join(reversed(match[1].splitlines(keepends=True))) + "}\n",
        text,
        flags=re.DOTALL,
    ),
    "all-numbers-otherwise": lambda text: (
        text.replace("1e-3", "+.001")
        .replace("{0.01}", "{1E-2}")
        .replace("{1.0, 1.0}", "{1., 01}")
        .replace("1e5", "100000.0")
    ),
}


def one_line_sections(text: str) -> str:
    """Put each section on one line; values without braces end at the next key."""
    return "".join(" ".join(section.split()) + "\n" for section in sections(text))


LAYOUTS["one-line-sections"] = one_line_sections
LAYOUTS["one-line"] = lambda text: one_line_sections(text).replace("\n", " ")


def frames_of(run: Run, folder: Path, config: str) -> dict[str, bytes]:
    """Run a config; return its frames."""
    folder.mkdir()
    write_scene(folder, config)
    result = run("-c", "scene.cfg", cwd=folder)
    assert (result.returncode, result.stderr) == (0, "")
    return {path.name: path.read_bytes() for path in (folder / "frames").glob("*.vtk")}


@pytest.fixture(scope="module")
def expected(mpm3d: Run, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Frames of the layout that the manual shows."""
    frames = frames_of(mpm3d, tmp_path_factory.mktemp("layouts") / "usual", CONFIG)
    assert len(frames) == 2 * 2 * 2
    return frames


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layout(mpm3d: Run, tmp_path: Path, expected: dict[str, bytes], layout: str) -> None:
    """The layout does not matter."""
    config = LAYOUTS[layout](CONFIG)
    assert config != CONFIG
    assert frames_of(mpm3d, tmp_path / "other", config) == expected


def test_quotes_protect_marks(mpm3d: Run, tmp_path: Path) -> None:
    """A quoted text may hold blanks and all marks."""
    folder = "a b,c={d} #e'f"
    write_scene(tmp_path, CONFIG.replace('"frames"', f'"{folder}"'))
    result = mpm3d("-c", "scene.cfg", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert (tmp_path / folder / "fpd.0.first.0000000000.vtk").is_file()
