"""TOML to a tree with positions: :mod:`tomllib` reads the values, a scan of the keys finds the places."""

from __future__ import annotations

import datetime as dt
import math
import re
import tomllib
from bisect import bisect_right
from typing import Any, Final

from .problems import Problem, ProblemsError
from .tree import MAX_DEPTH, MAX_NODES, TOO_MANY, KeyPath, Mark, Node, Source

_BLANK: Final = re.compile(r"(?:[ \t\r\n]++|#[^\n]*+)*+")
_BARE_KEY: Final = re.compile(r"[A-Za-z0-9_-]+")
# Possessive, as the text is known to be sound: what could be given back would be kept for each character.
_STRING: Final = re.compile(
    r'"""(?:[^"\\]++|\\.|"(?!""))*+"""+|\'\'\'(?:[^\']++|\'(?!\'\'))*+\'\'\'+|"(?:[^"\\\n]++|\\.)*+"|\'[^\'\n]*+\'',
    re.DOTALL,
)
_BARE_VALUE: Final = re.compile(r"[^,\]}#\n]*")
_DECIMAL_COMMA: Final = re.compile(r"(?:(?<==)|(?<== ))[-+]?[0-9]+,[0-9]+")
# A key of more parts than there may be levels, on which tomllib spends the square of their number.
_PART: Final = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+"""
_LONG_KEY: Final = re.compile(rf"(?:^|[{{,\[])[ \t]*+(?:{_PART}){{{MAX_DEPTH}}}", re.MULTILINE)
_PLACE: Final = re.compile(r"\s*\(at (?:line (\d+), column (\d+)|end of document)\)")


def parse_toml(source: Source) -> Node:
    """The tree of a TOML text.

    Raises:
        ProblemsError: with every fault found, each at its place.
    """
    text = source.text.replace("\r\n", "\n")
    if long := _LONG_KEY.search(text):
        raise _single(
            source, text.count("\n", 0, long.end()) + 1, 1, f"nested deeper than {MAX_DEPTH} levels"
        )
    try:
        data = tomllib.loads(text)
    except RecursionError:
        raise _single(source, 1, 1, f"nested deeper than {MAX_DEPTH} levels") from None
    except ValueError as error:
        place = _PLACE.search(str(error))
        lines = text.count("\n") + 1
        line, column = (int(place[1]), int(place[2])) if place and place[1] else (lines, 1)
        raise _single(source, line, *_reason(text, line, column, _PLACE.sub("", str(error)))) from None
    if fault := _too_much(data):
        raise _single(source, 1, 1, fault)
    builder = _Builder(source, text)
    tree = builder.node(data, ())
    if builder.problems:
        raise ProblemsError(builder.problems)
    return tree


def _reason(text: str, line: int, column: int, message: str) -> tuple[int, str]:
    """Column and message of what :mod:`tomllib` stumbled over: a decimal comma is named as such."""
    for number in _DECIMAL_COMMA.finditer(text.split("\n")[line - 1]):
        if number.start() < column <= number.end() + 1:
            return number.start() + 1, f"a comma parts values; write {number[0].replace(',', '.')}"
    return column, f"not valid TOML: {message}"


def _single(source: Source, line: int, column: int, message: str) -> ProblemsError:
    return ProblemsError([Problem(Mark(source, line, column), (), message)])


def _too_much(data: Any) -> str:
    """Whether there are too many levels or values, before their places are looked for; else nothing."""
    level, count = [data], 1
    for _ in range(MAX_DEPTH + 1):
        level = [
            child
            for item in level
            for child in (item.values() if isinstance(item, dict) else item if isinstance(item, list) else ())
        ]
        if not level:
            return ""
        count += len(level)
        if count > MAX_NODES:
            return TOO_MANY
    return f"nested deeper than {MAX_DEPTH} levels"


class _Builder:
    """Joins the values with the places that the scan found."""

    def __init__(self, source: Source, text: str) -> None:
        self.source = source
        self.scan = _Scan(text)
        self.starts = [0, *(m.end() for m in re.finditer("\n", text))]
        self.problems: list[Problem] = []

    def node(self, data: Any, path: KeyPath) -> Node:
        mark, key_mark = self._mark(self.scan.values.get(path)), None
        if path in self.scan.keys:
            key_mark = self._mark(self.scan.keys[path])
            mark = mark or key_mark
        mark = mark or Mark(self.source, 1, 1)
        if isinstance(data, dict):
            return Node({key: self.node(value, (*path, key)) for key, value in data.items()}, mark, key_mark)
        if isinstance(data, list):
            return Node(tuple(self.node(value, (*path, i)) for i, value in enumerate(data)), mark, key_mark)
        fault = _fault(data)
        if fault:
            self.problems.append(Problem(mark, path, fault))
        return Node(None if fault else data, mark, key_mark)

    def _mark(self, span: tuple[int, int] | None) -> Mark | None:
        if span is None:
            return None
        offset, end = span
        line = bisect_right(self.starts, offset)
        return Mark(self.source, line, offset - self.starts[line - 1] + 1, max(end - offset, 1))


def _fault(value: Any) -> str | None:
    if isinstance(value, dt.date | dt.time):
        return "dates and times of day have no meaning here"
    if isinstance(value, float) and not math.isfinite(value):
        return f"expected a finite number, got {value}"
    if isinstance(value, int) and abs(value) >= 2**63:
        return "integer too large"
    return None


class _Scan:
    """Places of keys and values in a text that :mod:`tomllib` has accepted.

    Attributes:
        keys: Start and end offset of the last key of each path.
        values: Start and end offset of each value.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.keys: dict[KeyPath, tuple[int, int]] = {}
        self.values: dict[KeyPath, tuple[int, int]] = {}
        self.tables: dict[KeyPath, int] = {}
        self.at = 0
        table: KeyPath = ()
        self._blank()
        while self.at < len(text):
            if text.startswith("[[", self.at):
                self.at += 2
                table = self._header(array=True)
                self.at += 2
            elif text[self.at] == "[":
                self.at += 1
                table = self._header(array=False)
                self.at += 1
            else:
                self._entry(table)
            self._blank()

    def _blank(self) -> None:
        match = _BLANK.match(self.text, self.at)
        self.at = match.end() if match else self.at

    def _key(self) -> list[tuple[str, tuple[int, int]]]:
        """The parts of a dotted key, each with its place."""
        parts = []
        while True:
            self._blank()
            match = _STRING.match(self.text, self.at) or _BARE_KEY.match(self.text, self.at)
            assert match is not None
            name = match[0]
            if name[0] in "\"'":
                name = tomllib.loads(f"k = {name}")["k"]
            parts.append((name, match.span()))
            self.at = match.end()
            self._blank()
            if not self.text.startswith(".", self.at):
                return parts
            self.at += 1

    def _header(self, *, array: bool) -> KeyPath:
        path: KeyPath = ()
        parts = self._key()
        for i, (name, span) in enumerate(parts):
            path = (*path, name)
            last = i == len(parts) - 1
            if last and array:
                self.tables[path] = self.tables.get(path, -1) + 1
            self.keys.setdefault(path, span)
            if path in self.tables:
                path = (*path, self.tables[path])
                if last:
                    self.values[path] = span
        return path

    def _entry(self, table: KeyPath) -> None:
        path = table
        for name, span in self._key():
            path = (*path, name)
            self.keys.setdefault(path, span)
        self.at += 1  # the equals sign
        self._value(path)

    def _value(self, path: KeyPath) -> None:
        self._blank()
        start = self.at
        match self.text[self.at]:
            case "[":
                self._items(path)
            case "{":
                self._members(path)
            case _:
                match = _STRING.match(self.text, self.at) or _BARE_VALUE.match(self.text, self.at)
                assert match is not None
                self.at = match.start() + len(match[0].rstrip())
        opened = self.text[start] in "[{"
        self.values[path] = (start, start + 1 if opened else self.at)

    def _items(self, path: KeyPath) -> None:
        self.at += 1
        index = 0
        self._blank()
        while self.text[self.at] != "]":
            self._value((*path, index))
            index += 1
            self._separator()
        self.at += 1

    def _members(self, path: KeyPath) -> None:
        self.at += 1
        self._blank()
        while self.text[self.at] != "}":
            self._entry(path)
            self._separator()
        self.at += 1

    def _separator(self) -> None:
        self._blank()
        if self.text[self.at] == ",":
            self.at += 1
            self._blank()
