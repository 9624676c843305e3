"""The tree of a scenario to a :class:`Scenario`, every fault at its place and in plain words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from ...words import did_you_mean
from ..language.scenario import SCHEMA_VERSION, Scenario
from ..text.problems import Problem, ProblemsError
from ..text.tree import KeyPath, Mark, Node, as_written, point, told
from .known_keys import TAG_KEYS, known_keys
from .messages import is_wrong_type, message

# How pydantic calls the members of a union that no key tells apart.
_MEMBERS: Final = ("function-before", "tuple", "str", "int", "constrained-int")
# What is wrong with the first is looked at; nobody reads on, and words take time to compare.
_TOLD: Final = 1000


def validate(root: Node) -> Scenario:
    """The scenario of a merged tree.

    Raises:
        ProblemsError: with every fault of the schema.
    """
    check_version(root)
    data = root.plain()
    try:
        return Scenario.model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
    located = [(*_locate(root, detail), detail) for detail in _without_other_branches(root, details)]
    located.sort(key=lambda fault: (fault[1].place.source.name, fault[1].place.line, fault[1].place.column))
    faults = located[:_TOLD]
    misspelt = {
        (path[:-1], near)
        for path, _, detail in faults
        if detail["type"] == "extra_forbidden"
        and (near := did_you_mean(str(path[-1]), known_keys(data, path[:-1])))
    }
    raise ProblemsError(
        [
            Problem(_mark(node, detail), as_written(root, path), told(node, message(detail, data, path)))
            for path, node, detail in faults
            # A misspelt key is one fault, not an unknown and a missing one.
            if not (detail["type"] == "missing" and (path[:-1], path[-1]) in misspelt) and not _echo(detail)
        ],
        more=len(located) - len(faults),
    )


def check_version(root: Node) -> None:
    """Refuse a scenario of another schema version before anything else is said about it.

    Raises:
        ProblemsError: saying whether the file or the program is too old.
    """
    node = root.child("schema_version")
    if node is None or isinstance(node.value, bool) or not isinstance(node.value, int):
        return
    if node.value > SCHEMA_VERSION:
        advice = "newer than this program, which reads"
    elif node.value < SCHEMA_VERSION:
        advice = "no longer read: this program reads"
    else:
        return
    text = f"schema version {node.value} is {advice} version {SCHEMA_VERSION}"
    raise ProblemsError([Problem(node.mark, ("schema_version",), text)])


def _without_other_branches(root: Node, details: list[ErrorDetails]) -> Iterator[ErrorDetails]:
    """One fault for each value of a union whose members no key tells apart, such as a number or a list.

    Every member complains; the one that came furthest is the one that was meant.
    """
    furthest: dict[KeyPath, ErrorDetails] = {}
    for detail in details:
        union = _union(root, detail)
        if union is None:
            yield detail
        elif union not in furthest or _reach(root, furthest[union]) < _reach(root, detail):
            furthest[union] = detail
    yield from furthest.values()


def _reach(root: Node, detail: ErrorDetails) -> tuple[int, bool]:
    """How far a member of a union read a value: into it, or at least past its type."""
    return len(_locate(root, detail)[0]), not is_wrong_type(detail)


def _union(root: Node, detail: ErrorDetails) -> KeyPath | None:
    """The value at which a location goes on with the name of a member that no key tells; or None."""
    node = root
    path: KeyPath = ()
    for part in detail["loc"]:
        child = node.child(part)
        if child is not None:
            node, path = child, (*path, part)
        elif isinstance(part, str) and part.partition("[")[0] in _MEMBERS:
            return path
    return None


def _locate(root: Node, detail: ErrorDetails) -> tuple[KeyPath, Node]:
    """The key path of a pydantic location without the tags of unions, and the nearest node."""
    loc, named = detail["loc"], detail["type"] in ("missing", "extra_forbidden")
    node, tagged = root, False
    path: KeyPath = ()
    for i, part in enumerate(loc):
        written = named and i == len(loc) - 1
        if part == "[key]" or (isinstance(part, str) and part.startswith("<") and not written):
            continue
        if isinstance(part, str) and not tagged and any(_is(node, key, part) for key in TAG_KEYS):
            tagged = True
            continue
        child = node.child(part)
        if child is not None:
            node, path, tagged = child, (*path, part), False
        elif written:
            return (*path, part), node
    return path, node


def _mark(node: Node, detail: ErrorDetails) -> Mark:
    if detail["type"] in ("missing", "extra_forbidden") or detail["loc"][-1] == "[key]":
        return node.place
    if detail["type"] == "union_tag_invalid":
        tag = node.child(str(detail["ctx"]["discriminator"]).strip("'"))
        return tag.mark if tag else point(node)
    return point(node)


def _echo(detail: ErrorDetails) -> bool:
    """True for a list that pydantic calls too short only because its items are wrong."""
    if detail["type"] != "too_short" or not isinstance(detail["input"], tuple):
        return False
    return len(detail["input"]) >= int(detail["ctx"]["min_length"])


def _is(node: Node, key: str, tag: str) -> bool:
    child = node.child(key)
    return child is not None and child.value == tag
