"""Pages of the documentation as what they are made of: files, commands, what these print, Python."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import zip_longest
from math import isclose
from pathlib import Path

from cli_process import ROOT, Done

Call = Callable[..., Done]

_BLOCK = re.compile(r"^(?:<!-- (file|into): (\S+) -->\n)?```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
# wall times differ from run to run
_WALL = re.compile(r"(?:about )?[\d.]+ m?s$")


@dataclass(frozen=True)
class Block:
    """A block of a page.

    Attributes:
        language: ``yaml``, ``sh``, ``text`` or ``python``.
        text: What stands in it.
        line: Of the page.
        way: ``file`` if it is a whole file, ``into`` if it gives sections of one; else empty.
        file: Its name.
    """

    language: str
    text: str
    line: int
    way: str
    file: str


def blocks(page: str) -> list[Block]:
    """All blocks of a page, in order."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return [
        Block(b[3], b[4], text.count("\n", 0, b.start(4)) + 1, b[1] or "", b[2] or "")
        for b in _BLOCK.finditer(text)
    ]


def follow(page: str, folder: Path, call: Call, *, pictures: bool) -> None:
    """Do what a page says: write its files, run its commands and Python, and compare what they print.

    Args:
        page: From the root of the repository.
        folder: The current one.
        call: Calls the program.
        pictures: Whether pictures are drawn too.
    """
    printed = ""
    names: dict[str, object] = {}
    all_blocks = blocks(page)
    for block, following in zip_longest(all_blocks, all_blocks[1:]):
        if block.way:
            _write(folder / block.file, block)
        elif block.language == "sh":
            fails = following is not None and "error:" in following.text
            printed = "".join(_said(call, words, fails) for words in _commands(block.text, pictures))
        elif block.language == "text":
            lost = [line for line in block.text.splitlines() if not _among(line, printed)]
            assert not lost, f"{page}:{block.line}: {lost} not in what was printed:\n{printed}"
        elif block.language == "python":
            exec(compile("\n" * (block.line - 1) + block.text, page, "exec"), names)


def _write(file: Path, block: Block) -> None:
    """A file, or its sections: those that it has are replaced, others added."""
    if block.way == "file":
        file.write_text(block.text, encoding="utf-8")
        return
    sections = dict(_sections(file.read_text(encoding="utf-8"))) | dict(_sections(block.text))
    file.write_text("".join(sections.values()), encoding="utf-8")


def _sections(text: str) -> Iterator[tuple[str, str]]:
    """Sections of a scenario by their keys, each with its text."""
    for part in re.split(r"^(?=\w)", text, flags=re.MULTILINE):
        if part.strip():
            yield part.partition(":")[0], part


def _commands(text: str, pictures: bool) -> Iterator[list[str]]:
    for line in text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if not words or words[0] != "dismech" or (words[1] == "render" and not pictures):
            continue
        quiet = ["--no-render"] if words[1] == "run" and not pictures and "--no-render" not in words else []
        yield [*words[1:], *quiet]


def _said(call: Call, words: list[str], fails: bool) -> str:
    done = call(*words)
    assert (done.code != 0) == fails, (words, done.stderr)
    return done.stdout + done.stderr


def _among(line: str, printed: str) -> bool:
    """Whether a line, or its start up to an ellipsis, was printed; numbers to a percent, no wall times."""
    if line.endswith("…"):
        return any(other.startswith(line[:-1]) for other in printed.splitlines())
    return not line.strip() or any(_alike(line.strip(), other.strip()) for other in printed.splitlines())


def _alike(line: str, other: str) -> bool:
    line, other = _WALL.sub("", line), _WALL.sub("", other)
    if re.split(r"\s+", _NUMBER.sub("#", line)) != re.split(r"\s+", _NUMBER.sub("#", other)):
        return False
    pairs = zip(_NUMBER.findall(line), _NUMBER.findall(other), strict=True)
    return all(isclose(float(a), float(b), rel_tol=0.01, abs_tol=1e-9) for a, b in pairs)
