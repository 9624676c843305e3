"""Shipped scenarios with one or two things made wrong, by a seed."""

from __future__ import annotations

import random
import re
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "scenarios"
DECKS = sorted(
    file
    for place in (FOLDER, FOLDER / "verification")
    for file in place.glob("*.*")
    if file.suffix == ".yaml"
)

# Numbers at the edges of every format, wrong types, units of other things, texts that mean something to YAML.
HOSTILE = (
    *(
        "0",
        "-1",
        "1",
        "2",
        "1e-320",
        "1e-30",
        "1e-9",
        "1e9",
        "1e30",
        "1e80",
        "1e308",
        "-1e30",
        "0.5",
        "99999",
    ),
    *("4611686018427387904", "9223372036854775807", "2000000", "1e400", ".nan", "true", "null", "~", "''"),
    *("[]", "{}", "[1, 2]", "[0, 0, 0]", "{a: 1}", "'1 mm'", "'1 kg'", "'1 ((Ts^9)^9)^9'", "'1/0'", "'x'"),
    *("'\\0'", "'щ'", "'../../x'", "{expression: '9**9**9'}", "{expression: '1/t'}", "{table: [[0, 1]]}"),
)
_SCALAR = re.compile(r"(?<=[:\[,=] )[^\s\[\]{},#][^\[\]{},#\n]*")
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")
_WORD = re.compile(r"[A-Za-z_]{2,}")


def mutated(seed: int) -> tuple[Path, str]:
    """A deck and its text after one to three random changes."""
    rng = random.Random(seed)
    deck = DECKS[seed % len(DECKS)]
    text = deck.read_text(encoding="utf-8")
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        text = rng.choice(CHANGES)(text, rng)
    return deck, text


def _other_value(text: str, rng: random.Random) -> str:
    found = list(_SCALAR.finditer(text))
    if not found:
        return text
    match = rng.choice(found)
    value = rng.choice((*HOSTILE, rng.choice(found)[0]))
    return text[: match.start()] + value + text[match.end() :]


def _scaled(text: str, rng: random.Random) -> str:
    """A number made larger or smaller, or of the other sign: valid in its form."""
    found = list(_NUMBER.finditer(text))
    match = rng.choice(found)
    number = match[0]
    times = 10.0 ** rng.choice((-40, -20, -9, -6, -3, -1, 1, 3, 6, 9, 20))
    whole = number.isdecimal() and times > 1.0
    value = str(int(number) * int(times)) if whole else f"{rng.choice((1, 1, -1)) * float(number) * times:g}"
    return text[: match.start()] + value + text[match.end() :]


def _misspelt(text: str, rng: random.Random) -> str:
    found = list(_WORD.finditer(text))
    match = rng.choice(found)
    word = rng.choice((match[0][1:], match[0] + "x", rng.choice(found)[0], match[0].upper()))
    return text[: match.start()] + word + text[match.end() :]


def _cut_line(text: str, rng: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    del lines[rng.randrange(len(lines))]
    return "".join(lines)


def _twice(text: str, rng: random.Random) -> str:
    lines = text.splitlines(keepends=True)
    lines.insert(rng.randrange(len(lines)), rng.choice(lines))
    return "".join(lines)


def _byte(text: str, rng: random.Random) -> str:
    place = rng.randrange(len(text))
    return (
        text[:place]
        + rng.choice(("", "{", "]", ":", "-", "\t", "\n", "\x07", "&a ", "*a ", "é"))
        + text[place + 1 :]
    )


CHANGES = (
    _scaled,
    _scaled,
    _scaled,
    _scaled,
    _other_value,
    _other_value,
    _misspelt,
    _cut_line,
    _twice,
    _byte,
)
