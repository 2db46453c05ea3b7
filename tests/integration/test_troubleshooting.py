"""The page of troubleshooting speaks of messages that the program has."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs" / "manual"))

from messages import (  # noqa: E402
    Message,
    form,
    forms,
    messages_of,
    python_messages,
    read_messages,
)

PAGE = ROOT / "docs" / "troubleshooting.md"
#: Sections whose messages are not those of the program.
OTHERS = ("How to read a message", "No message, but the result is wrong", "Building and Python")


@pytest.fixture(scope="module")
def messages() -> list[Message]:
    """Return the messages of the sources."""
    return read_messages(ROOT)


def quoted() -> Iterator[str]:
    """Yield the messages in the first columns of the tables."""
    for section in PAGE.read_text("utf-8").split("\n## ")[1:]:
        title, _, text = section.partition("\n")
        if title not in OTHERS:
            yield from re.findall(r"^\| `([^`]*)` \|", text, re.MULTILINE)


def test_messages_exist(messages: list[Message]) -> None:
    """Each message of the page is one of the program."""
    known = {message.text for message in messages}
    found = list(quoted())
    assert len(found) > 50
    assert [text for text in found if text not in known] == []


def test_sources_are_read_as_meant(tmp_path: Path) -> None:
    """Literals stay, all else is …; variables have the texts that the file gives them."""
    assert form("'a '//excerpt(x(1), 2)//to_text(n)//' isn''t, b'") == "a … isn't, b"
    assert forms("what", "  what = 'one'\n  if (odd) what = 'two '//n\n") == ["one", "two …"]
    source = tmp_path / "x.f90"
    source.write_text(
        "call raise(error, err_io, 'no room (a, b) for '// &\n"
        "           name, file=path, hint='free &\n           &some')\n"
        "! call raise(error, err_io, 'a comment')\n"
        "call self%warn('look out')\n"
    )
    assert list(messages_of(source, "io")) == [
        Message("io", "no room (a, b) for …", "free some", "4"),
        Message("io", "look out", "", "warning"),
    ]


def test_errors_of_the_package_are_read_as_meant(tmp_path: Path) -> None:
    """Literals stay, what is put into them is …; other errors do not count."""
    source = tmp_path / "x.py"
    source.write_text(
        "raise PygenError(f'no {name} ' f'in {place}{mark}')\n"
        "raise PygenError('no file')\nraise ValueError('no number')\n"
    )
    texts = [message.text for message in python_messages(source)]
    assert texts == ["no … in …", "no file"]
