"""Parameters and ``repeat`` taken out of a tree: what is left is what a user would have written without them.

- A text with ``$`` is a formula, and its place takes the number that it comes to, with its unit.
- Under ``expression``, parameters stand for their values in SI units.
- In the entry of a ``repeat``, a text or key in which ``$`` follows a letter, a digit, ``_`` or ``.`` is a
  name, and takes whole numbers: ``tentacle_$i``, ``tentacle_${i + 1}.start``.
- ``$$`` is a dollar sign. Prose, under ``description`` and ``source``, is left as it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from ...frozen import frozen
from . import repeat
from .filling import Filling, is_name
from .formula import FormulaError
from .parameters import KEY, Parameter
from .problems import Problem, ProblemsError
from .tree import MAX_NODES, TOO_MANY, KeyPath, Node, Scalar, describe, point
from .turning import placed_body, placed_joint

PROSE: Final = frozenset({"description", "source"})
_ARITHMETIC: Final = "expression"
_LATER: Final = "sweep"
"""Section whose values are those of points: a formula in it is computed where the point sets it."""
_CURLING: Final = frozenset({"curvature_1", "curvature_2"})


@frozen
class Substituted:
    """A scenario without parameters.

    Attributes:
        tree: Its text.
        numbers: Key paths at which a formula stood: no place for text.
        used: Names of parameters that it uses.
    """

    tree: Node
    numbers: frozenset[KeyPath]
    used: frozenset[str]


def concerned(node: Node) -> bool:
    """Whether a tree declares or uses parameters or repeats an entry."""
    match node.value:
        case Mapping() as entries:
            return any(
                key in (KEY, repeat.KEY) or "$" in key or (key not in PROSE and concerned(child))
                for key, child in entries.items()
            )
        case tuple() as items:
            return any(concerned(item) for item in items)
        case str() as text:
            return "$" in text
        case _:
            return False


def substitute(root: Node, parameters: Mapping[str, Parameter]) -> Substituted:
    """A scenario with its formulas computed and its repeated entries written out.

    Raises:
        ProblemsError: with every fault found, each at the line of the value.
    """
    assert isinstance(root.value, Mapping)
    body = replace(root, value={k: child for k, child in root.value.items() if k not in (KEY, _LATER)})
    walker = _Walker(parameters, _curls(body))
    tree = walker.node(body, (), None)
    if walker.problems:
        raise ProblemsError(walker.problems)
    if (later := root.child(_LATER)) is not None:
        assert isinstance(tree.value, Mapping)
        tree = replace(tree, value={**tree.value, _LATER: later})
    return Substituted(tree, frozenset(walker.numbers), frozenset(walker.used))


def _curls(root: Node) -> bool:
    """Whether curvatures are driven somewhere."""
    actuation = root.child("actuation")
    entries = actuation.value if actuation is not None and isinstance(actuation.value, tuple) else ()
    kinds = (entry.child("type") for entry in entries)
    return any(kind is not None and kind.value in _CURLING for kind in kinds)


class _Walker:
    """Goes through a tree once; notes faults, parameters met and places of formulas."""

    def __init__(self, parameters: Mapping[str, Parameter], curls: bool) -> None:
        self.parameters = parameters
        self.curls = curls
        self.problems: list[Problem] = []
        self.numbers: set[KeyPath] = set()
        self.used: set[str] = set()
        self.made = 0

    def node(self, node: Node, path: KeyPath, index: int | None) -> Node:
        """A node without parameters; ``index`` counts the copies of the repeated entry that it is in."""
        match node.value:
            case Mapping() as entries:
                if path in repeat.MAPPINGS:
                    entries = self._repeated_keys(entries, path)
                return replace(node, value=self._mapping(entries, path, index))
            case tuple() as items:
                if len(path) == 1 and path[0] in repeat.LISTS and any(map(_repeats, items)):
                    return replace(node, value=self._list(items, path))
                return replace(
                    node, value=tuple(self.node(v, (*path, k), index) for k, v in enumerate(items))
                )
            case str() as text if "$" in text and not (path and path[-1] in PROSE):
                return self._text(node, text, path, index)
            case _:
                return node

    def _mapping(self, entries: Mapping[str, Node], path: KeyPath, index: int | None) -> dict[str, Node]:
        made: dict[str, Node] = {}
        for key, child in entries.items():
            name = (
                self._name(key, replace(child, mark=child.place), (*path, key), index) if "$" in key else key
            )
            made[name] = self.node(child, (*path, name), index)
        return made

    # ------------------------------------------------------------ repeated entries

    def _list(self, items: tuple[Node, ...], path: KeyPath) -> tuple[Node, ...]:
        made: list[Node] = []
        for written, item in enumerate(items):
            here = (*path, written)
            try:
                made += self._copies(item, here, len(made))
            except ProblemsError as error:
                self.problems += error.problems
        return tuple(made)

    def _copies(self, item: Node, written: KeyPath, first: int) -> list[Node]:
        kind, entry = written[0], written[1]
        assert isinstance(entry, int)
        if not _repeats(item):
            return [replace(self._entry(item, (kind, first), None, written), entry=entry)]
        many, body = self._taken(item, written, kind in repeat.PLACED)
        self._named_apart(body, many.count, written)
        copies = []
        for i in range(many.count):
            copy = self._entry(body, (kind, first + i), i, written)
            move = many.move(i)
            if kind == "geometry" and i:
                copy = placed_body(copy, written, move, self.curls)
            elif kind == "joints" and i:
                copy = placed_joint(copy, written, move)
            copies.append(replace(copy, entry=entry))
        return copies

    def _entry(self, item: Node, path: KeyPath, index: int | None, written: KeyPath) -> Node:
        """An item of a list, whose faults are told at its place as written."""
        before = len(self.problems)
        node = self.node(item, path, index)
        self.problems[before:] = (
            replace(one, path=(*written, *one.path[2:])) for one in self.problems[before:]
        )
        return node

    def _taken(self, item: Node, written: KeyPath, placed: bool) -> tuple[repeat.Repeat, Node]:
        """What a repeated entry says of its copies, and the entry without that."""
        assert isinstance(item.value, Mapping)
        before = len(self.problems)
        node = self.node(item.value[repeat.KEY], (*written, repeat.KEY), None)
        if len(self.problems) > before:
            raise ProblemsError([self.problems.pop()])
        many = repeat.read_repeat(node, (*written, repeat.KEY), placed)
        body = replace(item, value={key: v for key, v in item.value.items() if key != repeat.KEY})
        self.made += many.count * _size(body)
        if self.made > MAX_NODES:
            raise ProblemsError(
                [Problem(point(node), (*written, repeat.KEY), f"{many.count} copies: {TOO_MANY}")]
            )
        return many, body

    def _named_apart(self, body: Node, count: int, written: KeyPath) -> None:
        name = body.child("name")
        if count > 1 and name is not None and isinstance(name.value, str) and "$" not in name.value:
            message = f"all {count} copies would be called {name.value!r}: write {name.value}_$i"
            raise ProblemsError([Problem(name.mark, (*written, "name"), message)])

    def _repeated_keys(self, entries: Mapping[str, Node], path: KeyPath) -> Mapping[str, Node]:
        """The entries of a mapping with those that repeat written out."""
        made: dict[str, Node] = {}
        for key, item in entries.items():
            if not _repeats(item):
                made[key] = item
                continue
            here = (*path, key)
            try:
                many, body = self._taken(item, here, False)
                if many.count > 1 and "$" not in key:
                    message = f"all {many.count} copies would be called {key!r}: write {key}_$i"
                    raise ProblemsError([Problem(item.place, here, message)])
                for i in range(many.count):
                    name = self._name(key, replace(item, mark=item.place), here, i)
                    if name in made:
                        raise ProblemsError([Problem(item.place, here, f"two entries are called {name!r}")])
                    made[name] = self.node(body, (*path, name), i)
            except ProblemsError as error:
                self.problems += error.problems
        return made

    # ------------------------------------------------------------ text

    def _text(self, node: Node, text: str, path: KeyPath, index: int | None) -> Node:
        if "$" not in text.replace("$$", ""):
            return replace(node, value=text.replace("$$", "$"))
        filling = Filling(self.parameters, index, self.used)
        try:
            if path and path[-1] == _ARITHMETIC:
                value: Scalar = filling.arithmetic(text)
            elif is_name(text):
                value = filling.name(text)
            else:
                value = filling.amount(text).scalar()
                self.numbers.add(path)
        except FormulaError as error:
            self.problems.append(Problem(node.mark, path, _unreadable(text, str(error))))
            return node
        formula = " with ".join(filter(None, (describe(text), " and ".join(filling.met.values()))))
        return replace(node, value=value, formula=formula)

    def _name(self, key: str, node: Node, path: KeyPath, index: int | None) -> str:
        """A key with the numbers of its copy."""
        try:
            return Filling(self.parameters, index, self.used).name(key)
        except FormulaError as error:
            self.problems.append(Problem(node.mark, path, f"{error}, in the name {key!r}"))
            return key


def _unreadable(text: str, reason: str) -> str:
    """Why a text is no formula; whoever meant none is told how to write it."""
    shown = reason if text in reason else f"{reason}, in {describe(text)}"
    return f"{shown}; a dollar sign is written $$" if reason.startswith("cannot read") else shown


def _repeats(item: Node) -> bool:
    return isinstance(item.value, Mapping) and repeat.KEY in item.value


def _size(node: Node) -> int:
    match node.value:
        case Mapping() as entries:
            return 1 + sum(map(_size, entries.values()))
        case tuple() as items:
            return 1 + sum(map(_size, items))
        case _:
            return 1
