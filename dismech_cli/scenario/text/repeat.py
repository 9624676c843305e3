"""``repeat:`` of an entry: how many copies, and where the next one stands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from ...frozen import frozen
from ...quantities import QuantityError
from ...words import hint, listed
from .problems import Problem, ProblemsError
from .tree import KeyPath, Node, describe, point, told
from .turning import Move, Triple, no_move, number_of, triple, turn_by, turn_of_full

KEY: Final = "repeat"
MAX_COPIES: Final = 10_000
LISTS: Final = ("geometry", "joints", "motions", "masses", "forces", "actuation", "initial_velocity")
"""Lists whose entries may be repeated."""
MAPPINGS: Final[tuple[KeyPath, ...]] = (("output", "probes"), ("expect",))
"""Mappings whose entries may be; their names then have to differ."""
PLACED: Final = ("geometry", "joints")
"""Lists whose copies may be turned and moved."""

_NUMBER: Final = {"type": ["number", "string"]}
_THREE: Final = {"type": "array", "items": _NUMBER, "minItems": 3, "maxItems": 3}
ROTATE_SCHEMA: Final[Mapping[str, Mapping[str, Any]]] = {
    "axis": _THREE | {"description": "Direction of the axis; turns are right-handed about it."},
    "center": _THREE | {"default": [0, 0, 0], "description": "A point on the axis."},
    "angle": _NUMBER | {"description": "Turn from one copy to the next; this or `full`."},
    "full": {"const": True, "description": "The copies share a full turn evenly."},
}
SCHEMA: Final[Mapping[str, Mapping[str, Any]]] = {
    "count": {
        "type": ["integer", "string"],
        "minimum": 1,
        "maximum": MAX_COPIES,
        "description": "Number of copies; `$i` counts them from 0.",
    },
    "rotate": {
        "$ref": "#/$defs/RepeatTurn",
        "description": "Turns each copy farther than the one before; of bodies and joints.",
    },
    "translate": _THREE
    | {"description": "Moves each copy, once turned, farther than the one before; of bodies and joints."},
}

_TURN = Callable[[int], tuple[float, float]]


@frozen
class Repeat:
    """How often an entry is copied, and where to.

    Attributes:
        count: Number of copies.
        move: Where a copy stands, by its number.
    """

    count: int
    move: Callable[[int], Move]


def read_repeat(node: Node, path: KeyPath, placed: bool) -> Repeat:
    """What a ``repeat`` says.

    Args:
        node: Its value, computed.
        path: Its key path.
        placed: Whether copies may be turned and moved.

    Raises:
        ProblemsError: It cannot be read.
    """
    if not isinstance(node.value, Mapping):
        return Repeat(_count(node, path), lambda _: no_move())
    _known(node, path, SCHEMA)
    count_node = node.value.get("count")
    if count_node is None:
        raise _problem(node, (*path, "count"), "missing key")
    count = _count(count_node, (*path, "count"))
    for key in ("rotate", "translate"):
        if not placed and (child := node.value.get(key)) is not None:
            message = "turns and moves bodies and joints; here write what changes from copy to copy with $i"
            raise _problem(child, (*path, key), message)
    step: Triple = (0.0, 0.0, 0.0)
    if (translate := node.value.get("translate")) is not None:
        step = _three(translate, (*path, "translate"), "length")
    rotate = node.value.get("rotate")
    if rotate is None:
        return Repeat(count, lambda i: Move(None, step_of(step, i)))
    axis, center, turn = _rotation(rotate, (*path, "rotate"), count)
    return Repeat(count, lambda i: Move((axis, center, turn(i)), step_of(step, i)))


def step_of(step: Triple, i: int) -> Triple:
    """The way of copy ``i``."""
    x, y, z = step
    return (i * x, i * y, i * z)


def _count(node: Node, path: KeyPath) -> int:
    count = node.value
    if isinstance(count, bool) or not isinstance(count, int):
        raise _problem(node, path, f"expected a whole number of copies, got {describe(count)}")
    if not 1 <= count <= MAX_COPIES:
        raise _problem(node, path, f"from 1 to {MAX_COPIES} copies, got {count}")
    return count


def _rotation(node: Node, path: KeyPath, count: int) -> tuple[Triple, Triple, _TURN]:
    if not isinstance(node.value, Mapping):
        raise _problem(node, path, f"expected a mapping with axis and angle, got {describe(node.value)}")
    _known(node, path, ROTATE_SCHEMA)
    axis_node = node.value.get("axis")
    if axis_node is None:
        raise _problem(node, (*path, "axis"), "missing key")
    axis = _three(axis_node, (*path, "axis"), "ratio")
    if not any(axis):
        raise _problem(axis_node, (*path, "axis"), "a direction must not be zero")
    center: Triple = (0.0, 0.0, 0.0)
    if (center_node := node.value.get("center")) is not None:
        center = _three(center_node, (*path, "center"), "length")
    angle, full = node.value.get("angle"), node.value.get("full")
    if (angle is None) == (full is None):
        raise _problem(node, path, "expected exactly one of 'angle' and 'full'")
    if full is not None:
        if full.value is not True:
            raise _problem(full, (*path, "full"), f"expected true, got {describe(full.value)}")
        return axis, center, lambda i: turn_of_full(i, count)
    assert angle is not None
    step = _number(angle, (*path, "angle"), "angle")
    return axis, center, lambda i: turn_by(i * step)


def _three(node: Node, path: KeyPath, kind: str) -> Triple:
    try:
        found = triple(node, kind)
    except QuantityError as error:
        raise _problem(node, path, str(error)) from None
    return found


def _number(node: Node, path: KeyPath, kind: str) -> float:
    try:
        return number_of(node, kind)
    except QuantityError as error:
        raise _problem(node, path, str(error)) from None


def _known(node: Node, path: KeyPath, schema: Mapping[str, object]) -> None:
    assert isinstance(node.value, Mapping)
    problems = [
        Problem(
            child.place,
            (*path, key),
            f"unknown key{hint(key, schema) or '; known: ' + listed(schema, 'and')}",
        )
        for key, child in node.value.items()
        if key not in schema
    ]
    if problems:
        raise ProblemsError(problems)


def _problem(node: Node, path: KeyPath, message: str) -> ProblemsError:
    return ProblemsError([Problem(point(node), path, told(node, message))])
