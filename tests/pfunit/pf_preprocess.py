"""Turn a pFUnit test module (.pf) into a Fortran program that runs its tests.

    pf_preprocess.py test_x.pf test_x.f90

The README beside this file says which part of pFUnit 4 is known. Anything else is an error that
names file and line. Line markers make the compiler name the lines of the .pf file.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

MAX_COLUMNS = 126  # pFUnit lengthens a line by 6, gfortran takes 132
MAX_NAME = 44

COMPARISONS = (
    "assertLessThan",
    "assertLessThanOrEqual",
    "assertGreaterThan",
    "assertGreaterThanOrEqual",
)
# Lower-case name: name, number of values compared, keyword arguments.
ASSERTIONS: dict[str, tuple[str, int, tuple[str, ...]]] = {
    name.lower(): (name, values, keywords)
    for name, values, keywords in [
        ("assertTrue", 1, ("message",)),
        ("assertFalse", 1, ("message",)),
        ("assertEqual", 2, ("message", "tolerance")),
        *((name, 2, ("message",)) for name in COMPARISONS),
    ]
}
MARKS = ("test", "before", "after")


class PfError(Exception):
    """A fault in a .pf file, at a line."""

    def __init__(self, line: int, text: str) -> None:
        super().__init__(text)
        self.line = line


@dataclass
class Suite:
    """What was found in a .pf file."""

    module: str = ""
    tests: list[str] = field(default_factory=list)
    before: str = ""
    after: str = ""
    body: list[str] = field(default_factory=list)


def split_arguments(text: str, line: int) -> tuple[list[str], str]:
    """Split `a, b)rest` at the commas of the outer level; return the arguments and the rest."""
    arguments, start, depth, quote = [], 0, 0, ""
    for i, char in enumerate(text):
        if quote:
            if char == quote:
                quote = ""
        elif char in "'\"":
            quote = char
        elif char in "([":
            depth += 1
        elif char in ")]" and depth > 0:
            depth -= 1
        elif char in ",)" and depth == 0:
            arguments.append(text[start:i].strip())
            start = i + 1
            if char == ")":
                return arguments, text[start:].strip()
        elif char == "!":
            break
    if quote:
        raise PfError(line, "a string is not closed")
    raise PfError(line, "no closing parenthesis: an assertion stands on one line")


def expand_assertion(key: str, rest: str, path: Path, line: int) -> list[str]:
    """Return the Fortran lines of an assertion."""
    name, values, keywords = ASSERTIONS[key]
    if not rest.startswith("("):
        raise PfError(line, f"@{name} needs arguments in parentheses")
    arguments, tail = split_arguments(rest[1:], line)
    if tail:
        raise PfError(line, f"nothing may follow @{name}(...), found: {tail}")
    if "" in arguments:
        raise PfError(line, f"an argument of @{name} is empty")
    named = [bool(re.match(r"\w+\s*=(?!=)", argument)) for argument in arguments]
    positional = named.index(True) if True in named else len(named)
    if not all(named[positional:]):
        raise PfError(line, f"@{name}: an argument without a name follows a named one")
    # After the values a message may follow without its name.
    if not values <= positional <= values + 1:
        raise PfError(line, f"@{name} compares {values} value(s) and takes a message")
    for argument in arguments[positional:]:
        keyword = argument.split("=")[0].strip()
        if keyword.lower() not in keywords:
            raise PfError(line, f"@{name} has no argument {keyword}")
    location = f"SourceLocation('{str(path).replace(chr(39), chr(39) * 2)}', {line})"
    # The call is one line, so that the compiler finds fault with the right line of the .pf file.
    return [
        f"    call {name}({', '.join(arguments)}, location={location})",
        "    if (anyExceptions()) return",
        f'# {line + 1} "{path}"',
    ]


def marked_procedure(mark: str, line: int, following: str | None) -> str:
    """Return the name of the subroutine on the line after `@test`, `@before` or `@after`."""
    match = re.fullmatch(r"\s*subroutine\s+(\w+)\s*(\(\s*\))?\s*(!.*)?", following or "", re.I)
    if not match:
        raise PfError(line, f"@{mark} must be followed by a line `subroutine name()`")
    if len(match[1]) > MAX_NAME:
        raise PfError(line + 1, f"the name {match[1]} is longer than {MAX_NAME} characters")
    return match[1]


def parse(lines: list[str], path: Path) -> Suite:
    """Read a .pf file."""
    suite = Suite()
    for number, text in enumerate(lines, start=1):
        if len(text) > MAX_COLUMNS:
            raise PfError(number, f"line longer than {MAX_COLUMNS} columns")
        if match := re.match(r"\s*module\s+(?!procedure\b)(\w+)\s*(!.*)?$", text, re.I):
            if suite.module:
                raise PfError(number, "a second module: a .pf file has one")
            suite.module = match[1]
            if suite.module.lower() != path.stem.lower():
                raise PfError(number, f"the module must be named like the file: {path.stem}")
        match = re.match(r"\s*@\s*(\w*)\s*(.*?)\s*$", text)
        if not match:
            suite.body.append(text)
            continue
        key = match[1].lower()
        if key in ASSERTIONS:
            suite.body += expand_assertion(key, match[2], path, number)
        elif key in MARKS:
            if match[2]:
                raise PfError(number, f"@{key} stands alone on its line, found: {match[2]}")
            name = marked_procedure(key, number, lines[number] if number < len(lines) else None)
            if key == "test":
                suite.tests.append(name)
            elif getattr(suite, key):
                raise PfError(number, f"a second @{key}")
            else:
                setattr(suite, key, name)
            suite.body.append("")
        else:
            raise PfError(number, f"unknown directive @{match[1]}")
    if not suite.module:
        raise PfError(len(lines), "no module")
    return suite


def program(suite: Suite, path: Path) -> str:
    """Return the module and the program that runs its tests."""
    used = {f"run_{i}": name for i, name in enumerate(suite.tests, start=1)}
    around = {"before": suite.before, "after": suite.after}
    used |= {f"run_{mark}": name for mark, name in around.items() if name}
    lines = [f'# 1 "{path}"', *suite.body, "", "program pf_program"]
    lines.append("  use pf_context, only: finish_suite, run_test")
    # Renamed, so that a test may have any name.
    lines += [f"  use {suite.module}, only: {new} => {name}" for new, name in used.items()]
    lines += ["  implicit none", ""]
    extra = "".join(f", {mark}=run_{mark}" for mark, name in around.items() if name)
    for i, name in enumerate(suite.tests, start=1):
        lines.append(f"  call run_test('{suite.module}.{name}', run_{i}{extra})")
    lines += [f"  call finish_suite('{suite.module}')", "end program pf_program", ""]
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    """Run the command line; return the exit status."""
    if len(arguments) != 2:
        print("usage: pf_preprocess.py test_x.pf test_x.f90", file=sys.stderr)
        return 1
    source, target = Path(arguments[0]), Path(arguments[1])
    try:
        suite = parse(source.read_text(encoding="utf-8").splitlines(), source)
    except PfError as error:
        print(f"{source}:{error.line}: error: {error}", file=sys.stderr)
        return 1
    target.write_text(program(suite, source), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
