"""Every error and warning of the program and of mpm_pygen, read from their sources."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

#: Folders of src/ and what their messages are about, in the order of the page.
AREAS = {
    "app": "Command line",
    "config": "Config",
    "cmake": "Names of classes and roles",
    "points": "Points",
    "parts": "Parts",
    "bodies": "Bodies",
    "grids": "Grids",
    "materials": "Materials",
    "boundaries": "Boundaries",
    "contacts": "Contacts",
    "drivers": "Drivers",
    "solvers": "Solvers",
    "serializers": "Serializers",
    "job": "Runs, checkpoints, warnings",
    "core": "State in checkpoints",
    "io": "Files",
    "mpm_pygen": "mpm_pygen",
}
#: Exit status of the program by the constant of `mpm_errors`.
STATUS = {"err_usage": "1", "err_input": "2", "err_simulation": "3", "err_io": "4"}
#: Position of the message and of the hint among the arguments of the procedures that make errors.
MESSAGE_AT = {
    "raise": (2, 5),
    "reject": (1, 3),
    "fail": (0, 2),
    "raise_at": (2, 3),
    "refuse": (1, 99),
    "warn": (0, 99),
}
CALL = re.compile(rf"call (?:\w+%)*({'|'.join(MESSAGE_AT)})\((.*)\)\s*$", re.MULTILINE)
COMMENT = re.compile(r"^\s*!.*\n", re.MULTILINE)
CONTINUED = re.compile(r"&[ \t]*\n\s*(&?)")
LITERAL = re.compile(r"'((?:[^']|'')*)'")
OPEN = "…"


@dataclass(frozen=True)
class Message:
    """What the program may say."""

    #: Folder of src/ in which it is made.
    area: str
    #: The text, with … in place of what differs from case to case.
    text: str
    #: The way out that is printed with it, likewise; may be empty.
    hint: str
    #: Exit status; 'warning' when the run goes on.
    status: str


def split(text: str, separator: str) -> list[str]:
    """Split at separators outside of quotes and parentheses."""
    parts, start, depth, quoted, i = [], 0, 0, False, 0
    while i < len(text):
        if text[i] == "'":
            quoted = not quoted
        elif not quoted and text[i] in "([":
            depth += 1
        elif not quoted and text[i] in ")]":
            depth -= 1
        elif not quoted and depth == 0 and text.startswith(separator, i):
            parts.append(text[start:i].strip())
            i += len(separator)
            start = i
            continue
        i += 1
    return [*parts, text[start:].strip()]


def form(expression: str) -> str:
    """Return the text that an expression makes, with … for what is not a literal."""
    text = ""
    for part in split(expression, "//"):
        literal = LITERAL.fullmatch(part)
        text += literal[1].replace("''", "'") if literal else OPEN
    # Templates name the role.
    return re.sub(f"{OPEN}+", OPEN, re.sub("@(role|plural)@", OPEN, text)).strip()


def forms(expression: str, code: str) -> list[str]:
    """Return the texts that an expression makes; those of a variable are what the file gives it."""
    if re.fullmatch(r"\w+", expression):
        pattern = rf"^\s*(?:if \(.*?\) )?(?:character.*:: )?{expression} = (.*)$"
        found = [form(value) for value in re.findall(pattern, code, re.MULTILINE)]
        return [text for text in found if text.strip(OPEN + " ")]
    text = form(expression)
    return [text] if text.strip(OPEN + " ") else []


def arguments(inside: str) -> tuple[list[str], dict[str, str]]:
    """Return the arguments of a call without a keyword, and those with one."""
    places: list[str] = []
    named: dict[str, str] = {}
    for item in split(inside, ","):
        match = re.match(r"(\w+)\s*=(?!=)\s*(.*)$", item)
        if match:
            named[match[1]] = match[2]
        else:
            places.append(item)
    return places, named


def messages_of(path: Path, area: str) -> Iterator[Message]:
    """Yield the messages of a source file."""
    code = COMMENT.sub("", path.read_text("utf-8"))
    code = CONTINUED.sub(lambda match: "" if match[1] else " ", code)
    for name, inside in CALL.findall(code):
        places, named = arguments(inside)
        at, hint_at = MESSAGE_AT[name]
        message = named.get("message", places[at] if at < len(places) else "")
        hint = named.get("hint", places[hint_at] if hint_at < len(places) else "")
        hints = forms(hint, code) or ([OPEN] if hint else [])
        status = "warning" if name == "warn" else "2"
        if name == "raise":
            status = STATUS.get(places[1], "130, 143")
        for text in forms(message, code):
            yield Message(area, text, " / ".join(hints), status)
    # What points have to tell, once, is a warning.
    for remark in re.findall(r"%remark = (.*)$", code, re.MULTILINE):
        yield Message(area, f'body "{OPEN}": {form(remark)}', "", "warning")


def python_messages(path: Path) -> Iterator[Message]:
    """Yield the messages of the errors of mpm_pygen in a source file."""
    for call in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not isinstance(call, ast.Call) or not call.args:
            continue
        if not isinstance(call.func, ast.Name) or call.func.id != "PygenError":
            continue
        text = call.args[0]
        parts = text.values if isinstance(text, ast.JoinedStr) else [text]
        words = [
            part.value if isinstance(part, ast.Constant) and isinstance(part.value, str) else OPEN
            for part in parts
        ]
        yield Message("mpm_pygen", re.sub(f"{OPEN}+", OPEN, "".join(words)), "", "2")


def read_messages(root: Path) -> list[Message]:
    """Return the messages of all sources of the project, area by area."""
    found: list[Message] = []
    folders = {path.name for path in (root / "src").iterdir() if path.is_dir()}
    for area in [*AREAS, *sorted(folders - AREAS.keys())]:
        if area == "mpm_pygen":
            for path in sorted((root / "mpm_pygen" / "src").rglob("*.py")):
                found += python_messages(path)
            continue
        for path in sorted((root / "src" / area).rglob("*")):
            if re.search(r"\.[fF]90(\.in)?$", path.name):
                found += messages_of(path, area)
    return [item for item in dict.fromkeys(found) if item.text.strip(f"{OPEN}: ")]


def cell(text: str) -> str:
    """Return a cell of a table."""
    return f"`{text}`".replace("|", "\\|") if text else ""


def messages_text(messages: list[Message]) -> str:
    """Markdown of the page."""
    lines = [
        "<!-- Written by scripts/docs. -->",
        "",
        "# Messages",
        "",
        "[Contents](../README.md) · [troubleshooting](../troubleshooting.md)",
        "",
        "Every error and warning of the program, and of mpm_pygen, and the way out that is printed "
        f"in the next line, where {OPEN} stands for names, numbers and places. The status is that "
        "of the program; it goes on after a warning.",
    ]
    area = ""
    for message in messages:
        if message.area != area:
            area = message.area
            lines += [
                "",
                f"## {AREAS.get(area, area.capitalize())}",
                "",
                "| message | way out | status |",
                "|---|---|---|",
            ]
        lines.append(f"| {cell(message.text)} | {cell(message.hint)} | {message.status} |")
    return "\n".join(lines) + "\n"
