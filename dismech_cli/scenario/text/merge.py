"""Later settings over earlier ones, and the ``include:`` files of a scenario."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

from ...errors import ScenarioError
from .files import parse_source, read_source, resolve_file
from .parameters import spelled_out
from .problems import Problem, ProblemsError
from .tree import Node, describe

MAX_INCLUDES: Final = 100
_VARIANT_KEYS: Final = ("type", "shape")


def merge(base: Node, over: Node) -> Node:
    """``over`` laid on ``base``: mappings merge key by key, anything else replaces.

    Mappings of different ``type`` or ``shape`` replace each other: the keys of one mean nothing
    to the other.
    """
    if not isinstance(base.value, Mapping) or not isinstance(over.value, Mapping):
        return over
    if any(_differ(base, over, key) for key in _VARIANT_KEYS):
        return over
    entries = dict(base.value)
    for key, node in over.value.items():
        entries[key] = merge(entries[key], node) if key in entries else node
    return replace(over, value=entries)


def _differ(base: Node, over: Node, key: str) -> bool:
    old, new = base.child(key), over.child(key)
    return old is not None and new is not None and old.value != new.value


def without(node: Node, *keys: str) -> Node:
    """A mapping node less some keys."""
    assert isinstance(node.value, Mapping)
    return replace(node, value={key: child for key, child in node.value.items() if key not in keys})


class Includes:
    """Merges the include files of a scenario beneath it, depth first, later over earlier."""

    def __init__(self, tree: Path | None) -> None:
        self.tree = tree
        self.count = 0

    def expand(self, node: Node, path: Path, shown: Path, opened: tuple[Path, ...] = ()) -> Node:
        """``node`` of the file ``path`` over all that it includes, without the ``include`` key.

        Args:
            node: Tree of the file.
            path: The file, resolved; names in it are relative to its folder.
            shown: The file as the user named it.
            opened: Files being expanded, to notice a cycle.

        Raises:
            ScenarioError: for a missing file, a cycle, or faults inside an included file.
        """
        listed = node.child("include")
        body = spelled_out(without(node, "include"))
        if listed is None:
            return body
        if not isinstance(listed.value, tuple):
            raise self._problem(listed, f"expected a list of files, got {describe(listed.value)}")
        below: Node | None = None
        for item in listed.value:
            part = self._read(item, path, shown, (*opened, path))
            below = part if below is None else merge(below, part)
        return body if below is None else merge(below, body)

    def _read(self, item: Node, path: Path, shown: Path, opened: tuple[Path, ...]) -> Node:
        if not isinstance(item.value, str):
            raise self._problem(item, f"expected the name of a file, got {describe(item.value)}")
        self.count += 1
        if self.count > MAX_INCLUDES:
            raise self._problem(item, f"more than {MAX_INCLUDES} files included")
        try:
            target = resolve_file(item.value, path.parent, self.tree)
        except ScenarioError as error:
            raise self._problem(item, str(error)) from None
        if target in opened:
            chain = " -> ".join(p.name for p in (*opened[opened.index(target) :], target))
            raise self._problem(item, f"files include each other: {chain}")
        name = shown.parent / item.value
        source = read_source(target, str(name), "include")
        return self.expand(parse_source(source, target.suffix), target, name, opened)

    def _problem(self, node: Node, message: str) -> ProblemsError:
        return ProblemsError([Problem(node.mark, ("include",), message)])
