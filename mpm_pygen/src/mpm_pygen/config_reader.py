"""Reading configs of mpm3d back into the dataclasses of `mpm_pygen.config`."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpm_pygen.config import Body, Config, Job, Object, Parts, Value, Values
from mpm_pygen.errors import PygenError

_TOKEN = re.compile(
    r"""(?P<blank>[ \t\r]+|\#[^\n]*)|(?P<line>\n)|(?P<mark>[{}=,])
      |"(?P<double>[^"\n]*)"|'(?P<single>[^'\n]*)'|(?P<word>[^\s{}=,\#"']+)""",
    re.VERBOSE,
)
_INTEGER = re.compile(r"[+-]?\d+")


@dataclass
class _Token:
    """A mark (one of {}=,), quoted text, or a word, and its line."""

    kind: str
    text: str
    line: int


@dataclass
class _Section:
    """A section: its entries by key, each as a list of (name, value)."""

    name: str
    entries: dict[str, list[tuple[str, Value]]]


def read_config(path: str | os.PathLike[str]) -> Config:
    """Read a config. Points are not read: `Body.points` is None.

    Parameters
    ----------
    path : str or PathLike
        The file. Only its form is checked; `mpm3d --check` checks the content.
    """
    path = Path(path)
    return parse_config(path.read_text("utf-8"), str(path))


def parse_config(text: str, path: str = "config") -> Config:
    """Make a config of its text.

    Parameters
    ----------
    text : str
        What a file holds.
    path : str
        Name of the file, for messages.
    """
    _, sections = _parse(path, text)
    one: dict[str, _Section] = {}
    bodies, contacts, probes = [], [], []
    for section in sections:
        if section.name == "body":
            bodies.append(_body(section))
        elif section.name == "contact":
            contacts.append(_object(section))
        elif section.name == "probe":
            probes.append(_object(section))
        else:
            one[section.name] = section
    for name in ("job", "serializer", "driver", "solver", "grid"):
        if name not in one:
            raise PygenError(f"{path}: there is no section {name}")
    job = one["job"].entries
    return Config(
        job=Job(
            dt=_single(job, "dt", 0.0),
            sim_type=_single(job, "TYPE", 3),
            t=_single(job, "t", 0.0),
            threads=_single(job, "threads", 0),
        ),
        serializer=_object(one["serializer"]),
        driver=_object(one["driver"]),
        solver=_object(one["solver"]),
        grid=_object(one["grid"]),
        bodies=bodies,
        contacts=contacts,
        probes=probes,
    )


def read_parts(path: str | os.PathLike[str]) -> Parts:
    """Read a generator text of `CartesianPoints`.

    Parameters
    ----------
    path : str or PathLike
        The file.
    """
    entries, sections = _parse(str(path), Path(path).read_text("utf-8"))
    for key in ("Lx", "Nx", "lmpp", "rho"):
        if key not in entries:
            raise PygenError(f"{path}: there is no {key}")
    return Parts(
        lengths=[float(value) for _, value in entries["Lx"]],
        cells=[int(value) for _, value in entries["Nx"]],
        per_cell=_single(entries, "lmpp", 0),
        density=_single(entries, "rho", 0.0),
        parts=[_object(section) for section in sections],
    )


def _body(section: _Section) -> Body:
    """Make a body of its section."""
    entries = section.entries
    parts = {
        role: _object(section, f"{role}-", "props")
        for role in ("point", "node", "material", "boundary")
        if f"{role}-class" in entries
    }
    itself = _object(section)
    itself.name = ""
    return Body(
        name=_single(entries, "name", ""),
        point_file=_single(entries, "point-file", ""),
        body=itself,
        **parts,  # type: ignore[arg-type]
    )


def _object(section: _Section, prefix: str = "", ending: str = "properties") -> Object:
    """Make an object of its entries."""
    entries = section.entries
    return Object(
        class_name=_single(entries, f"{prefix}class", ""),
        properties=_values(entries.get(f"{prefix}{ending}", [])),
        int_properties=_values(entries.get(f"{prefix}int-{ending}", [])),
        str_properties=_values(entries.get(f"{prefix}str-{ending}", [])),
        name="" if prefix else _single(entries, "name", ""),
    )


def _values(items: list[tuple[str, Value]]) -> Values:
    """Give a list as a tuple, as a mapping when all have names, or as both."""
    ordered: list[Value | Mapping[str, Value]] = [value for name, value in items if not name]
    named = {name: value for name, value in items if name}
    if named and not ordered:
        return named
    return (*ordered, named) if named else tuple(ordered)


def _single(entries: dict[str, list[tuple[str, Value]]], key: str, default: Value) -> Any:
    """Give the only value of an entry."""
    items = entries.get(key, [])
    return items[0][1] if items else default


def _parse(path: str, text: str) -> tuple[dict[str, list[tuple[str, Value]]], list[_Section]]:
    """Read the entries outside of sections, and the sections."""
    tokens = _tokens(path, text)
    outside: dict[str, list[tuple[str, Value]]] = {}
    sections: list[_Section] = []
    current: dict[str, list[tuple[str, Value]]] = outside
    k = 0
    while k < len(tokens):
        token = tokens[k]
        following = (
            tokens[k + 1].text if k + 1 < len(tokens) and tokens[k + 1].kind == "mark" else ""
        )
        if token.kind == "mark" and token.text == "}" and current is not outside:
            current = outside
            k += 1
        elif token.kind == "word" and following == "{" and current is outside:
            sections.append(_Section(token.text, {}))
            current = sections[-1].entries
            k += 2
        elif token.kind == "word" and following == "=":
            current[token.text], k = _items(path, tokens, k + 2)
        else:
            raise PygenError(f"{path}:{token.line}: {token.text!r} has no place here")
    if current is not outside:
        raise PygenError(f"{path}: the section {sections[-1].name} has no end")
    return outside, sections


def _items(path: str, tokens: list[_Token], k: int) -> tuple[list[tuple[str, Value]], int]:
    """Read the values of an entry from token k on; also tell where the next entry starts."""
    items: list[tuple[str, Value]] = []

    def is_mark(index: int, text: str) -> bool:
        return index < len(tokens) and tokens[index].kind == "mark" and tokens[index].text == text

    braces = is_mark(k, "{")
    k += braces
    while not (braces and is_mark(k, "}")):
        if k >= len(tokens) or tokens[k].kind == "mark":
            line = tokens[min(k, len(tokens) - 1)].line
            raise PygenError(f"{path}:{line}: a value is missing")
        name = ""
        if braces and is_mark(k + 1, "="):
            name, k = tokens[k].text, k + 2
            if k >= len(tokens) or tokens[k].kind == "mark":
                raise PygenError(f"{path}:{tokens[k - 1].line}: {name} has no value")
        items.append((name, _value(tokens[k])))
        k += 1
        if is_mark(k, ","):
            k += 1
        elif not braces:
            return items, k
        elif not is_mark(k, "}"):
            raise PygenError(f"{path}:{tokens[k - 1].line}: a comma or brace is missing")
    return items, k + 1


def _value(token: _Token) -> Value:
    """Give a number for a word that is one, and text for all else."""
    if token.kind == "word":
        if _INTEGER.fullmatch(token.text):
            return int(token.text)
        try:
            return float(token.text)
        except ValueError:
            pass
    return token.text


def _tokens(path: str, text: str) -> list[_Token]:
    """Split the text."""
    tokens, position, line = [], 0, 1
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise PygenError(f"{path}:{line}: a quote has no end on its line")
        position = match.end()
        kind = match.lastgroup or ""
        if kind == "line":
            line += 1
        elif kind != "blank":
            tokens.append(
                _Token("text" if kind in ("double", "single") else kind, match[kind], line)
            )
    return tokens
