"""Spoil good inputs: changes of words that know the grammar, and changes of bytes that do not."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

from seeds import Seeds

#: How often each kind of input is made.
KINDS = {"cfg": 60, "points": 20, "parts": 12, "set": 8}
#: Longest input. [byte]
MOST = 1 << 16
#: Numbers at the edges of what is a number, and beyond.
NUMBERS = re.findall(
    r"\S+",
    """
0 -0 1 -1 2 3 5 7 10 1e-300 1e-320 -1e-320 1e300 -1e300 1.7976931348623157e308 1e309 -1e309
nan inf -inf infinity 1e 1e+ .5 5. . - + 1d5 0x10 1_000 1e5000 1e-5000
2147483647 2147483648 -2147483648 -2147483649 4294967296 9223372036854775807 9223372036854775808
1e15 1e9 100000 65536 0.1 0.5 0.25 1e-3 1e-9 1e-17 0.9999999999999999 1.0000000000000002
00001 1,5 1e0.5 --1 3.14.15
""",
)
MARKS = ["{", "}", "=", ",", "#", '"', "'", "\n", "\t", "\r\n", " ", "{}", "{,", ",}", "= =", "{{"]
ODD = ["\ufeff", "ü", "\u2028", "😀", "\x00", "\x7f", "\x1b[31m", "\\", "%s%n", "../", "/dev/null"]
TOKEN = re.compile(r'"[^"\n]*"|\'[^\'\n]*\'|[^\s"\'{}=,#]+|[{}=,#"\']|\n|[^\S\n]+')
NUMBER = re.compile(r"[-+]?\d[\d.eE+-]*\Z")


def make_input(seeds: Seeds, seed: int, index: int) -> tuple[str, bytes]:
    """Return one input, which the seed and its index alone determine.

    Returns
    -------
    tuple[str, bytes]
        The ending of its name, which says what it is, and its content.
    """
    rng = random.Random(f"{seed}:{index}")
    kind = rng.choices(list(KINDS), weights=list(KINDS.values()))[0]
    ending = kind if kind in seeds.texts else f"{rng.randint(1, 5)}.{kind}"
    text = rng.choice(seeds.texts[ending])
    if rng.random() < 0.3:
        # Numbers alone: most of such inputs are read to the end.
        for _ in range(1 + int(rng.expovariate(1.0))):
            text = "".join(new_number(rng, TOKEN.findall(text), seeds, ending))
        return ending, text.encode()
    if rng.random() < 0.75:
        text = change_words(rng, text, seeds, ending)
    data = text.encode("utf-8", "surrogateescape")
    if rng.random() < 0.35:
        data = change_bytes(rng, data, seeds)
    return ending, data[:MOST]


def change_words(rng: random.Random, text: str, seeds: Seeds, ending: str) -> str:
    """Change some words, lines or sections."""
    tokens = TOKEN.findall(text)
    for _ in range(1 + int(rng.expovariate(rng.choice([0.5, 2.0])))):
        if not tokens:
            break
        tokens = rng.choice(CHANGES)(rng, tokens, seeds, ending)
    return "".join(tokens)


def places(tokens: list[str], wanted: Callable[[str], object]) -> list[int]:
    """Return the positions of the words that are wanted, or all when there are none."""
    return [i for i, token in enumerate(tokens) if wanted(token)] or list(range(len(tokens)))


def new_number(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Replace a number."""
    i = rng.choice(places(tokens, NUMBER.match))
    number = rng.choice(NUMBERS)
    if rng.random() < 0.4:
        number = repr(rng.choice([-1, 1]) * 10.0 ** rng.uniform(-12, 12))
    elif rng.random() < 0.3:
        number = str(rng.randint(-3, 300))
    return [*tokens[:i], number, *tokens[i + 1 :]]


def new_word(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Replace a word by one that another place could have."""
    i = rng.choice(places(tokens, str.strip))
    word = rng.choice(seeds.words)
    if tokens[i][:1] in "\"'":
        word = f'"{word}"'
    return [*tokens[:i], word, *tokens[i + 1 :]]


def new_class(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Replace a quoted text by a class."""
    i = rng.choice(places(tokens, lambda token: token[:1] == '"'))
    names = [word for word in seeds.words if word[:1].isupper()]
    return [*tokens[:i], f'"{rng.choice(names)}"', *tokens[i + 1 :]]


def new_mark(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Put a mark, or something odd, between two words."""
    i = rng.randrange(len(tokens) + 1)
    return [*tokens[:i], rng.choice(ODD if rng.random() < 0.15 else MARKS), *tokens[i:]]


def new_entry(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Put a named entry, or some values, into a list."""
    i = rng.choice(places(tokens, lambda token: token in "{,"))
    value = rng.choice([*NUMBERS, f'"{rng.choice(seeds.words)}"'])
    name = f"{rng.choice(seeds.words)} = " if rng.random() < 0.6 else ""
    n = 1 if rng.random() < 0.9 else rng.choice([2, 3, 10, 100, 1000])
    return [*tokens[: i + 1], *(f"{name}{value}," for _ in range(n)), *tokens[i + 1 :]]


def drop_words(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Leave out some words."""
    i = rng.randrange(len(tokens))
    return tokens[:i] + tokens[i + 1 + int(rng.expovariate(0.5)) :]


def repeat_words(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Repeat some words, now and then very often."""
    i = rng.randrange(len(tokens))
    j = i + 1 + int(rng.expovariate(0.1))
    n = 1 if rng.random() < 0.8 else rng.choice([2, 10, 100, 1000])
    return tokens[:j] + tokens[i:j] * n + tokens[j:]


def swap_words(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Exchange two words."""
    i, j = rng.randrange(len(tokens)), rng.randrange(len(tokens))
    changed = list(tokens)
    changed[i], changed[j] = changed[j], changed[i]
    return changed


def borrow(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Put a section or a line of another text between two lines, or in place of a section."""
    other = rng.choice(seeds.texts[ending])
    pieces = re.split(r"(?<=^\}\n)", other, flags=re.MULTILINE)
    if rng.random() < 0.3:
        pieces = other.splitlines(keepends=True)
    i = rng.choice(places(tokens, "\n".__eq__))
    j = i if rng.random() < 0.5 else rng.randrange(i, len(tokens))
    return [*tokens[: i + 1], *TOKEN.findall(rng.choice(pieces)), *tokens[j + 1 :]]


def new_type(rng: random.Random, tokens: list[str], seeds: Seeds, ending: str) -> list[str]:
    """Change the TYPE, and with it what every class takes."""
    text = "".join(tokens)
    sim_type = rng.randint(1, 5)
    text = re.sub(r"TYPE = \d", f"TYPE = {sim_type}", text)
    return TOKEN.findall(re.sub(r'"\d\.points"', f'"{sim_type}.points"', text))


CHANGES = [
    *(4 * [new_number]),
    *(2 * [new_word]),
    *(2 * [new_class]),
    *(2 * [new_entry]),
    new_mark,
    drop_words,
    repeat_words,
    swap_words,
    borrow,
    new_type,
]


def change_bytes(rng: random.Random, data: bytes, seeds: Seeds) -> bytes:
    """Change some bytes."""
    changed = bytearray(data)
    for _ in range(1 + int(rng.expovariate(0.4))):
        i = rng.randrange(len(changed) + 1)
        how = rng.randrange(6)
        if how == 0 and i < len(changed):
            changed[i] ^= 1 << rng.randrange(8)
        elif how == 1 and i < len(changed):
            changed[i] = rng.randrange(256)
        elif how == 2:
            changed[i:i] = bytes(rng.randrange(256) for _ in range(rng.choice([1, 2, 8])))
        elif how == 3:
            del changed[i : i + int(rng.expovariate(0.1)) + 1]
        elif how == 4:
            j = rng.randrange(len(changed) + 1)
            changed[i:i] = changed[min(i, j) : max(i, j)]
        elif rng.random() < 0.3:
            del changed[i:]
        else:
            changed[i:i] = rng.choice([b"#", b'"', b"{", b"}", b"=", b",", b"\n", b"9", b" "]) * (
                rng.choice([1, 3, 64, 5000])
            )
    return bytes(changed)
