"""A scenario text as a tree that remembers where each value was written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, Final, TypeAlias

from ...frozen import frozen

Scalar: TypeAlias = str | int | float | bool | None
KeyPath: TypeAlias = tuple[str | int, ...]

MAX_BYTES: Final = 4 * 1024 * 1024
MAX_DEPTH: Final = 64
# What is read in some five seconds; curves and tables of more rows are files.
MAX_NODES: Final = 100_000
TOO_MANY: Final = f"more than {MAX_NODES} values: give long curves and tables as CSV files"


@frozen
class Source:
    """A text that sets values.

    Attributes:
        name: As messages name it: a path, or ``--set a=b``.
        text: The text itself, for excerpts.
        note: Role beside the scenario, such as ``include``; empty for the scenario itself.
        positions: False if a line and column mean nothing to the user.
    """

    name: str
    text: str = field(repr=False)
    note: str = ""
    positions: bool = True


@frozen
class Mark:
    """A place in a text: line and column counted from 1, and how many characters it covers."""

    source: Source
    line: int
    column: int
    width: int = 1

    def __str__(self) -> str:
        if not self.source.positions:
            return self.source.name
        return f"{self.source.name}:{self.line}:{self.column}"


@frozen
class Node:
    """A value with its place.

    Attributes:
        value: Mapping or tuple of nodes, or a scalar.
        mark: Where the value starts.
        key_mark: Where its key stands, if it has one.
        note: Who changed the value since it was written, such as ``profile draft``.
        formula: What it was computed from, with the places of its parameters; empty if it was written.
        entry: Its place in a list as written, where a ``repeat`` made or moved it.
    """

    value: Mapping[str, Node] | tuple[Node, ...] | Scalar
    mark: Mark
    key_mark: Mark | None = None
    note: str = ""
    formula: str = ""
    entry: int | None = None

    @property
    def place(self) -> Mark:
        """The key if there is one, else the value."""
        return self.key_mark or self.mark

    @property
    def origin(self) -> str:
        """Who set the value: ``scene.yaml:12:3``, ``base.yaml:3:1 (include)``, ``--set a=b``."""
        note = "; ".join(filter(None, (self.note or self.mark.source.note, self.formula)))
        return f"{self.mark} ({note})" if note else str(self.mark)

    def plain(self) -> Any:
        """The value as dicts, tuples and scalars."""
        match self.value:
            case Mapping():
                return {key: child.plain() for key, child in self.value.items()}
            case tuple():
                return tuple(child.plain() for child in self.value)
            case scalar:
                return scalar

    def child(self, key: str | int) -> Node | None:
        """The node under a key or an index, or None."""
        if isinstance(self.value, Mapping):
            return self.value.get(key) if isinstance(key, str) else None
        if isinstance(self.value, tuple) and isinstance(key, int) and 0 <= key < len(self.value):
            return self.value[key]
        return None


def describe(value: object) -> str:
    """A value as messages show it."""
    match value:
        case None:
            return "nothing"
        case bool():
            return str(value).lower()
        case str():
            return repr(value if len(value) <= 40 else value[:40] + "...")
        case Mapping():
            return "a mapping"
        case tuple() | list():
            return f"a list of {len(value)}"
        case _:
            return str(value)


def format_path(path: KeyPath) -> str:
    """``('geometry', 0, 'radius')`` as ``geometry[0].radius``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else (f".{part}" if text else part)
    return text


def place(root: Node, path: KeyPath) -> tuple[KeyPath, Node]:
    """The node nearest to a key path, and the path as the text has it.

    Text may be short for a mapping, as ``beam.start`` is for ``{group: beam.start}``: then the
    path ends at the text. The path of a key that is not there stays whole.
    """
    node = root
    for i, part in enumerate(path):
        child = node.child(part)
        if child is None:
            return (path, node) if isinstance(node.value, Mapping | tuple) else (path[:i], node)
        node = child
    return path, node


def as_written(root: Node, path: KeyPath) -> KeyPath:
    """A key path with the places of list items as the text has them, before any ``repeat``."""
    written: list[str | int] = []
    node: Node | None = root
    for part in path:
        node = None if node is None else node.child(part)
        written.append(part if node is None or node.entry is None else node.entry)
    return tuple(written)


def told(node: Node, message: str) -> str:
    """A message about a value, with the formula that it was computed from."""
    return f"{message} (from {node.formula})" if node.formula else message


def point(node: Node) -> Mark:
    """Where a message about ``node`` points: a scalar itself, else the key of the collection."""
    return node.place if isinstance(node.value, Mapping | tuple) else node.mark
