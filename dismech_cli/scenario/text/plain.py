"""A scenario made in Python as a tree: no text, so that messages name key paths alone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any, Final

import numpy as np

from .problems import Problem, ProblemsError
from .tree import MAX_DEPTH, KeyPath, Mark, Node, Scalar, Source

_LARGEST_INT: Final = 2**63 - 1


def parse_mapping(mapping: Mapping[str, Any], name: str) -> Node:
    """The tree of a mapping of mappings, sequences, arrays and scalars; paths are taken as text.

    Args:
        mapping: Keys and values as a text would have them.
        name: As messages name it.

    Raises:
        ProblemsError: with every value that no text could hold, by its key path.
    """
    converter = _Converter(Mark(Source(name, "", positions=False), 1, 1))
    tree = converter.node(mapping, ())
    if converter.problems:
        raise ProblemsError(converter.problems)
    return tree


class _Converter:
    """Python values to nodes, noting every fault on the way."""

    def __init__(self, mark: Mark) -> None:
        self.mark = mark
        self.problems: list[Problem] = []

    def node(self, value: object, path: KeyPath) -> Node:
        if len(path) > MAX_DEPTH:
            return self._fault(path[:4], f"nested deeper than {MAX_DEPTH} levels")
        match value:
            case Mapping():
                return self._mapping(value, path)
            case np.ndarray() | np.generic():
                return self.node(value.tolist(), path)
            case PurePath():
                return self._made(str(value))
            case None | bool() | str():
                return self._made(value)
            case int() if abs(value) > _LARGEST_INT:
                return self._fault(path, "integer too large")
            case float() if not math.isfinite(value):
                return self._fault(path, f"expected a finite number, got {value}")
            case int() | float():
                return self._made(value)
            case Sequence() if not isinstance(value, bytes | bytearray | memoryview):
                return self._made(tuple(self.node(item, (*path, i)) for i, item in enumerate(value)))
            case _:
                kind = type(value).__name__
                return self._fault(path, f"expected a number, text, a list or a mapping, got {kind}")

    def _mapping(self, value: Mapping[Any, Any], path: KeyPath) -> Node:
        for key in value:
            if not isinstance(key, str):
                self._fault(path, f"a key must be text, got {key!r}")
        return self._made(
            {key: self.node(v, (*path, key)) for key, v in value.items() if isinstance(key, str)}
        )

    def _made(self, value: Mapping[str, Node] | tuple[Node, ...] | Scalar) -> Node:
        return Node(value, self.mark, self.mark)

    def _fault(self, path: KeyPath, message: str) -> Node:
        self.problems.append(Problem(self.mark, path, message))
        return self._made(None)
