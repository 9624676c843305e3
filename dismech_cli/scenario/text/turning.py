"""Copies of bodies and joints turned about an axis and moved, in the tree: coordinates for coordinates."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final, TypeAlias

from ...frozen import frozen
from ...quantities import QuantityError, parse_quantity
from ...units import KINDS
from .problems import Problem, ProblemsError
from .tree import KeyPath, Node, describe, point

Triple: TypeAlias = tuple[float, float, float]
Turn: TypeAlias = tuple[Triple, Triple, tuple[float, float]]
"""Direction of the axis, a point on it, and cosine and sine of the angle."""


@frozen
class Move:
    """A turn and then a way.

    Attributes:
        turn: The turn, if there is one.
        way: The way [m].
    """

    turn: Turn | None
    way: Triple


@frozen
class _Shape:
    """The coordinates of a generated shape.

    Attributes:
        points: Keys of points.
        directions: Keys of directions, and what they are where the text says nothing.
        lists: Keys of lists of points.
    """

    points: tuple[str, ...] = ()
    directions: Mapping[str, tuple[Triple, ...] | None] | None = None
    lists: tuple[str, ...] = ()


_X: Final[Triple] = (1.0, 0.0, 0.0)
_Y: Final[Triple] = (0.0, 1.0, 0.0)
_Z: Final[Triple] = (0.0, 0.0, 1.0)
# Shapes that their coordinates fix altogether; of others the first node is chosen, and would not turn along.
_SHAPES: Final[Mapping[str, _Shape]] = {
    "line": _Shape(("from", "to")),
    "polyline": _Shape(lists=("points",)),
    "arc": _Shape(("center",), {"normal": None, "start": None}),
    "sheet": _Shape(("origin",), {"axes": (_X, _Y)}),
    "cylinder": _Shape(("origin",), {"axis": (_Z,), "start": (_X,)}),
    "sphere": _Shape(("center",), {"axis": (_Z,), "start": (_X,)}),
    "icosphere": _Shape(("center",), {"axis": (_Z,), "start": (_X,)}),
}
_ONLY_MOVED: Final[Mapping[str, _Shape]] = {
    "helix": _Shape(("origin",)),
    "disc": _Shape(("center",)),
    "annulus": _Shape(("center",)),
    "hemisphere": _Shape(("center",)),
}
_ISOTROPIC: Final = frozenset({"round", "tube"})


def no_move() -> Move:
    """Stay."""
    return Move(None, (0.0, 0.0, 0.0))


def turn_of_full(i: int, count: int) -> tuple[float, float]:
    """Cosine and sine of ``i/count`` of a full turn, of all digits: what is symmetric stays so."""
    quarter, rest = divmod(4 * (i % count), count)
    # from the nearer end of the quarter, so that mirrored angles give the same digits
    near = 0.5 * math.pi * min(rest, count - rest) / count
    cosine, sine = math.cos(near), math.sin(near)
    if rest > count - rest:
        cosine, sine = sine, cosine
    for _ in range(quarter):
        cosine, sine = 0.0 - sine, cosine
    return cosine, sine


def turn_by(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle [rad]."""
    return math.cos(angle), math.sin(angle)


def triple(node: Node, kind: str) -> Triple:
    """Three numbers or quantities in SI units.

    Raises:
        QuantityError: They are not.
    """
    if not isinstance(node.value, tuple) or len(node.value) != 3:
        raise QuantityError(f"expected a list of 3, got {describe(node.value)}")
    x, y, z = (number_of(item, kind) for item in node.value)
    return x, y, z


def number_of(node: Node, kind: str) -> float:
    """A number or a quantity in SI units.

    Raises:
        QuantityError: It is none.
    """
    match node.value:
        case bool():
            pass
        case int() | float() as number:
            return float(number)
        case str() as text:
            return parse_quantity(text, KINDS[kind])
        case _:
            pass
    raise QuantityError(f"expected {KINDS[kind].phrase}, got {describe(node.value)}")


def placed_body(body: Node, path: KeyPath, move: Move, curls: bool) -> Node:
    """A body turned and moved.

    Args:
        body: The entry of ``geometry``.
        path: Its key path.
        move: Where to.
        curls: Whether something in the scene drives curvatures, whose directions a director gives.

    Raises:
        ProblemsError: Its place is not given by coordinates alone.
    """
    if not isinstance(body.value, Mapping):
        return body
    entries = dict(body.value)
    if (generate := entries.get("generate")) is not None:
        entries["generate"] = _generated(generate, (*path, "generate"), move)
    if (mesh := entries.get("mesh")) is not None:
        entries["mesh"] = _from_file(mesh, (*path, "mesh"), move)
    if move.turn is not None and "director" in entries:
        entries["director"] = _turned(entries["director"], move)
    elif move.turn is not None and _directed(body, curls):
        message = "turned by 'repeat', this rod needs a 'director': it bends differently in its directions"
        raise ProblemsError([Problem(body.place, (*path, "director"), message)])
    return replace(body, value=entries)


def _directed(body: Node, curls: bool) -> bool:
    """Whether the answer depends on a director that would be chosen."""
    kind, section = body.child("type"), body.child("section")
    if kind is None or kind.value != "rod":
        return False
    shape = None if section is None else section.child("type")
    natural = body.child("natural")
    bent = natural is not None and any(natural.child(f"curvature_{k}") is not None for k in (1, 2))
    return curls or bent or (shape is not None and shape.value not in _ISOTROPIC)


def _generated(node: Node, path: KeyPath, move: Move) -> Node:
    kind = node.child("shape")
    if kind is None or not isinstance(kind.value, str) or not isinstance(node.value, Mapping):
        return node  # the schema will say so
    shape = _SHAPES.get(kind.value)
    if shape is None and move.turn is None:
        shape = _ONLY_MOVED.get(kind.value)
    if shape is None:
        if kind.value not in _ONLY_MOVED and kind.value != "csv":
            return node
        what = "turned" if kind.value in _ONLY_MOVED else "turned or moved"
        message = f"a {kind.value} cannot be {what} by 'repeat'; write its coordinates with $i"
        raise ProblemsError([Problem(point(kind), (*path, "shape"), message)])
    entries = dict(node.value)
    for key in shape.points:
        if key in entries:
            entries[key] = _moved(entries[key], move)
    for key in shape.lists:
        if key in entries and isinstance(entries[key].value, tuple):
            entries[key] = _each(entries[key], lambda item: _moved(item, move))
    for key, default in (shape.directions or {}).items():
        if move.turn is not None and (key in entries or default is not None):
            entries[key] = _directions(entries.get(key) or _written(default or (), node), move)
    return replace(node, value=entries)


def _written(directions: tuple[Triple, ...], near: Node) -> Node:
    """Default directions as a node: one by itself, several as a list."""
    nodes = tuple(
        Node(tuple(Node(part, near.mark) for part in direction), near.mark) for direction in directions
    )
    return nodes[0] if len(nodes) == 1 else Node(nodes, near.mark)


def _directions(node: Node, move: Move) -> Node:
    """A direction, or a list of them, turned."""
    several = isinstance(node.value, tuple) and any(isinstance(item.value, tuple) for item in node.value)
    return _each(node, lambda item: _turned(item, move)) if several else _turned(node, move)


def _from_file(node: Node, path: KeyPath, move: Move) -> Node:
    """A mesh file, which is turned and then moved anyway."""
    if not isinstance(node.value, Mapping):
        return node
    entries = dict(node.value)
    zero = _written(((0.0, 0.0, 0.0),), node)
    way = _turned(entries.get("move", zero), move)
    entries["move"] = _moved(way, Move(None, move.way))
    if move.turn is not None:
        if "rotate" in entries:
            message = "turned already: write its angle with $i, in place of 'repeat'"
            raise ProblemsError([Problem(point(entries["rotate"]), (*path, "rotate"), message)])
        axis, center, (cosine, sine) = move.turn
        about = {
            "axis": _written((axis,), node),
            "angle": Node(math.atan2(sine, cosine), node.mark),
            "about": _written((center,), node),
        }
        entries["rotate"] = Node(about, node.mark)
    return replace(node, value=entries)


def placed_joint(joint: Node, path: KeyPath, move: Move) -> Node:
    """A joint whose selections by place are turned and moved; those by name stay.

    Raises:
        ProblemsError: A box cannot be turned.
    """
    match joint.value:
        case Mapping() as entries:
            return replace(
                joint,
                value={key: _selected(key, child, (*path, key), move) for key, child in entries.items()},
            )
        case tuple() as items:
            placed = (placed_joint(item, (*path, k), move) for k, item in enumerate(items))
            return replace(joint, value=tuple(placed))
        case _:
            return joint


def _selected(key: str, node: Node, path: KeyPath, move: Move) -> Node:
    if key in ("nearest", "center", "point"):
        return _moved(node, move)
    if key == "normal":
        return _turned(node, move)
    if key == "box" and isinstance(node.value, Mapping):
        if move.turn is not None:
            message = "a box lies along the axes and cannot be turned; take a sphere"
            raise ProblemsError([Problem(node.place, path, message)])
        return replace(node, value={name: _moved(corner, move) for name, corner in node.value.items()})
    return placed_joint(node, path, move)


def _each(node: Node, change: Callable[[Node], Node]) -> Node:
    assert isinstance(node.value, tuple)
    return replace(node, value=tuple(change(item) for item in node.value))


def _moved(node: Node, move: Move) -> Node:
    """A point turned and moved; what is none stays, for the schema to say so."""
    try:
        place = triple(node, "length")
    except QuantityError:
        return node
    if move.turn is not None:
        axis, (a, b, c), angle = move.turn
        x, y, z = _rotated((place[0] - a, place[1] - b, place[2] - c), axis, angle)
        place = (x + a, y + b, z + c)
    u, v, w = move.way
    return _numbers(node, (place[0] + u, place[1] + v, place[2] + w))


def _turned(node: Node, move: Move) -> Node:
    """A direction, or the way of a mesh, turned; what is none stays."""
    if move.turn is None:
        return node
    try:
        direction = triple(node, "ratio")
    except QuantityError:
        try:
            direction = triple(node, "length")
        except QuantityError:
            return node
    axis, _, angle = move.turn
    return _numbers(node, _rotated(direction, axis, angle))


def _numbers(node: Node, place: Triple) -> Node:
    assert isinstance(node.value, tuple)
    items = (
        item if item.value == number else replace(item, value=number)
        for item, number in zip(node.value, place, strict=True)
    )
    return replace(node, value=tuple(items))


def _rotated(v: Triple, axis: Triple, angle: tuple[float, float]) -> Triple:
    """V turned about an axis through the origin: what lies along it keeps its digits."""
    cosine, sine = angle
    size = math.hypot(*axis)
    a = tuple(part / size for part in axis)
    along = sum(p * q for p, q in zip(a, v, strict=True))
    held = tuple(along * p for p in a)
    across = tuple(p - q for p, q in zip(v, held, strict=True))
    x, y, z = (
        h + cosine * p + sine * (a[(k + 1) % 3] * v[(k + 2) % 3] - a[(k + 2) % 3] * v[(k + 1) % 3])
        for k, (h, p) in enumerate(zip(held, across, strict=True))
    )
    return x, y, z
