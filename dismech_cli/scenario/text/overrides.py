"""``--set a.b[2].c=VALUE``: one value of the scenario replaced from the command line."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Final, TypeAlias

from .parameters import KEY as PARAMETERS
from .parameters import refuse_new, spelled_out
from .problems import Problem, ProblemsError
from .tree import KeyPath, Mark, Node, Source, describe, format_path
from .yaml_text import parse_yaml

_PART: Final = re.compile(r"(?P<dot>\.?)(?P<key>[A-Za-z_][A-Za-z0-9_-]*)|\[(?P<index>\d{1,6})\]")
_LOADER_KEYS: Final = ("include", "profiles")


Kinds: TypeAlias = Mapping[KeyPath, Mapping[str, str]]
"""What tells the kind of a mapping, such as its ``type``, as its default has it, by key path."""


def apply_override(root: Node, argument: str, kinds: Kinds) -> Node:
    """``root`` with the value that ``argument`` sets; missing mappings on the way are made.

    The value is read as in the file, so ``numerics.dt=5 ms`` and ``forces=[]`` both work.

    Args:
        root: The scenario.
        argument: ``KEY=VALUE``.
        kinds: Kinds of the mappings that may have to be made.

    Raises:
        ProblemsError: pointing into the argument if it cannot be applied.
    """
    source = Source(f"--set {argument!r}", argument, positions=False)
    left, equals, _ = argument.partition("=")
    if not equals:
        raise _problem(source, 1, len(argument), "expected KEY=VALUE such as numerics.dt=5ms")
    path, columns = _parse_path(source, left)
    if path[0] in _LOADER_KEYS:
        raise _problem(source, 1, len(left), f"{path[0]!r} belongs to the file and cannot be set here")
    value = _value(source, len(left) + 1)
    if path[0] == PARAMETERS and len(path) > 1:
        name = str(path[1])
        mark = Mark(source, 1, columns[1], len(name))
        given = Node({PARAMETERS: Node({name: Node(value.value, mark)}, mark)}, mark)
        refuse_new(root, given, "--set")
        if len(path) == 2 and not isinstance(value.value, Mapping):
            path, columns = (*path, "default"), [*columns, columns[1]]
    return spelled_out(_put(root, path, columns, 0, value, kinds))


def _parse_path(source: Source, text: str) -> tuple[KeyPath, list[int]]:
    parts: list[str | int] = []
    columns: list[int] = []
    position = 0
    while position < len(text):
        match = _PART.match(text, position)
        if match is None or (match["key"] is not None and bool(match["dot"]) == (position == 0)):
            break
        parts.append(match["key"] if match["index"] is None else int(match["index"]))
        columns.append(position + len(match["dot"] or "") + 1)
        position = match.end()
    if position < len(text) or not parts or isinstance(parts[0], int):
        raise _problem(
            source, position + 1, 1, "cannot read the key; write it as numerics.dt or geometry[0].radius"
        )
    return tuple(parts), columns


def _value(source: Source, start: int) -> Node:
    """The value node: the text is blanked up to the value so that columns stay true."""
    text = source.text[start:]
    if not text.strip():
        raise _problem(source, start + 1, 1, "expected a value after '='")
    if "\n" in text or "\r" in text:
        raise _problem(source, start + 1, 1, "a value is one line")
    try:
        node = parse_yaml(Source(source.name, text, positions=False))
    except ProblemsError as error:
        raise ProblemsError([_shifted(problem, source, start) for problem in error.problems]) from None
    return _moved(node, source, start)


def _moved(node: Node, source: Source, start: int) -> Node:
    match node.value:
        case Mapping() as entries:
            value: object = {key: _moved(child, source, start) for key, child in entries.items()}
        case tuple() as items:
            value = tuple(_moved(child, source, start) for child in items)
        case scalar:
            value = scalar
    key_mark = node.key_mark and _shift(node.key_mark, source, start)
    return Node(value, _shift(node.mark, source, start), key_mark)  # type: ignore[arg-type]


def _shift(mark: Mark, source: Source, start: int) -> Mark:
    return Mark(source, 1, mark.column + start, mark.width)


def _shifted(problem: Problem, source: Source, start: int) -> Problem:
    return replace(problem, mark=_shift(problem.mark, source, start))


def _put(node: Node, path: KeyPath, columns: list[int], depth: int, value: Node, kinds: Kinds) -> Node:
    """``node`` with ``value`` at ``path[depth:]``."""
    source, here = value.mark.source, path[depth]
    mark = Mark(source, 1, columns[depth], len(str(here)))
    last = depth == len(path) - 1
    if isinstance(here, int):
        if not isinstance(node.value, tuple):
            raise _at(mark, path[:depth], f"not a list but {describe(node.value)}")
        if here >= len(node.value):
            raise _at(mark, path[:depth], f"has no item {here}: it holds {len(node.value)}, counted from 0")
        items = list(node.value)
        items[here] = value if last else _put(items[here], path, columns, depth + 1, value, kinds)
        return replace(node, value=tuple(items))
    if not isinstance(node.value, Mapping):
        raise _at(mark, path[:depth], f"not a mapping but {describe(node.value)}")
    if last:
        child = replace(value, key_mark=mark)
    else:
        made = {key: Node(tag, mark, mark) for key, tag in kinds.get(path[: depth + 1], {}).items()}
        below = node.value.get(here) or Node(made, mark, mark)
        child = _put(below, path, columns, depth + 1, value, kinds)
    return replace(node, value={**node.value, here: child})


def _at(mark: Mark, path: KeyPath, message: str) -> ProblemsError:
    return ProblemsError([Problem(mark, (), f"{format_path(path)} {message}" if path else message)])


def _problem(source: Source, column: int, width: int, message: str) -> ProblemsError:
    return ProblemsError([Problem(Mark(source, 1, column, width), (), message)])
