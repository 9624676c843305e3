"""YAML to a tree with positions: YAML 1.2 scalars, no tags, bounded depth and aliases.

PyYAML's C parser overflows its stack on nested brackets, so the Python one is used.
"""

from __future__ import annotations

import math
import re
from typing import Any, Final, NoReturn

import yaml
from yaml.error import MarkedYAMLError
from yaml.reader import ReaderError

from .problems import Problem, ProblemsError
from .tree import MAX_DEPTH, MAX_NODES, TOO_MANY, KeyPath, Mark, Node, Scalar, Source

_NULL: Final = re.compile(r"(?:null|Null|NULL|~|)\Z")
_BOOL: Final = re.compile(r"(?:true|True|TRUE|false|False|FALSE)\Z")
_INT: Final = re.compile(r"(?:[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+)\Z")
_FLOAT: Final = re.compile(
    r"(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))\Z"
)
_DECIMALS: Final = re.compile(r"[0-9]+(?:[eE][-+]?[0-9]+)?(?:\s*[A-Za-z%].*)?\Z")
# Order matters: an int also looks like a float.
SCALARS: Final = (
    ("tag:yaml.org,2002:null", _NULL),
    ("tag:yaml.org,2002:bool", _BOOL),
    ("tag:yaml.org,2002:int", _INT),
    ("tag:yaml.org,2002:float", _FLOAT),
)
_LARGEST_INT: Final = 2**63 - 1


class _RefusedError(MarkedYAMLError):
    """Valid YAML that has no place in a scenario."""


class _Loader(yaml.SafeLoader):
    """Composes nodes only: every plain scalar stays text until :func:`resolve` reads it."""

    yaml_implicit_resolvers: dict[Any, Any] = {}  # noqa: RUF012  PyYAML's own protocol
    depth = 0
    count = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        event = self.peek_event()  # type: ignore[no-untyped-call]
        if getattr(event, "tag", None) is not None:
            raise _RefusedError(
                problem=f"tags such as {event.tag} are not allowed", problem_mark=event.start_mark
            )
        self.count += 1
        if self.count > MAX_NODES:
            raise _RefusedError(problem=TOO_MANY, problem_mark=event.start_mark)
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise _RefusedError(
                problem=f"nested deeper than {MAX_DEPTH} levels", problem_mark=event.start_mark
            )
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node


def resolve(text: str) -> Scalar:
    """A plain scalar by the core schema of YAML 1.2: ``2e6`` is a number, ``no`` is text, ``010`` is 10.

    Raises:
        ValueError: if the number is not finite or an integer is too large.
    """
    if _NULL.match(text):
        return None
    if _BOOL.match(text):
        return text[0] in "tT"
    if _INT.match(text):
        if len(text) > 24:
            raise ValueError("integer too large")
        base = {"0o": 8, "0x": 16}.get(text[:2], 10)
        integer = int(text[2:] if base != 10 else text, base)
        if abs(integer) > _LARGEST_INT:
            raise ValueError("integer too large")
        return integer
    if _FLOAT.match(text):
        number = math.inf if text[-1] in "fFnN" else float(text)
        if not math.isfinite(number):
            raise ValueError("expected a finite number")
        return number
    return text


def parse_yaml(source: Source) -> Node:
    """The tree of a YAML text.

    Raises:
        ProblemsError: with every fault found, each at its place.
    """
    try:
        root = _Loader(source.text).get_single_node()
    except MarkedYAMLError as error:
        raise ProblemsError([Problem(_mark_of(source, error), (), _message(error))]) from None
    except (ReaderError, ValueError, OverflowError, RecursionError) as error:
        # Forbidden characters, and escapes of characters that do not exist.
        position = getattr(error, "position", 0)
        line = source.text.count("\n", 0, position) + 1
        raise ProblemsError([Problem(Mark(source, line, 1), (), "not a readable YAML text")]) from None
    if root is None:
        raise ProblemsError([Problem(Mark(source, 1, 1), (), "the text is empty")])
    _Measure(source).node(root)
    converter = _Converter(source)
    tree = converter.node(root, None, ())
    if converter.problems:
        raise ProblemsError(converter.problems)
    return tree


class _Measure:
    """Counts what aliases expand to before anything is expanded: a short text can mean 1e9 values."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.known: dict[int, tuple[int, int]] = {}
        self.open: set[int] = set()

    def node(self, raw: yaml.Node) -> tuple[int, int]:
        """Number of values below ``raw`` with itself, and levels.

        Aliases follow their anchors, so that in document order each is known when it is met.
        """
        if isinstance(raw, yaml.ScalarNode):
            return 1, 1
        if id(raw) in self.known:
            return self.known[id(raw)]
        if id(raw) in self.open:
            self._stop(raw, "an alias refers to the value that contains it")
        self.open.add(id(raw))
        count, height = 1, 0
        for child in raw.value:
            value = child[1] if isinstance(child, tuple) else child
            more, levels = self.node(value)
            count, height = count + more, max(height, levels)
        if count > MAX_NODES:
            self._stop(raw, f"{TOO_MANY}, once aliases are expanded")
        if height >= MAX_DEPTH:
            self._stop(raw, f"nested deeper than {MAX_DEPTH} levels once aliases are expanded")
        self.open.discard(id(raw))
        self.known[id(raw)] = count, height + 1
        return self.known[id(raw)]

    def _stop(self, raw: yaml.Node, message: str) -> NoReturn:
        raise ProblemsError([Problem(_mark(self.source, raw), (), message)])


class _Converter:
    """PyYAML nodes to ours, noting every fault on the way."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems: list[Problem] = []

    def node(self, raw: yaml.Node, key_mark: Mark | None, path: KeyPath) -> Node:
        mark = _mark(self.source, raw)
        if isinstance(raw, yaml.ScalarNode):
            return Node(self._scalar(raw, mark, path), mark, key_mark)
        if isinstance(raw, yaml.SequenceNode):
            items = tuple(self.node(item, None, (*path, i)) for i, item in enumerate(raw.value))
            return Node(items, mark, key_mark)
        return Node(self._mapping(raw, path), mark, key_mark)

    def _mapping(self, raw: yaml.Node, path: KeyPath) -> dict[str, Node]:
        entries: dict[str, Node] = {}
        before: yaml.Node | None = None
        for key, value in raw.value:
            mark = _mark(self.source, key)
            if (number := _decimal_comma(before, key, value)) is not None:
                assert before is not None
                place = _mark(self.source, before)
                self.problems.append(
                    Problem(place, (*path, *list(entries)[-1:]), f"a comma parts keys; write {number}")
                )
                continue
            before = value
            if not isinstance(key, yaml.ScalarNode):
                self.problems.append(Problem(mark, (), "a key must be plain text"))
                continue
            if key.value == "<<" and key.style is None:
                self.problems.append(
                    Problem(mark, (), "merge keys (<<) are not part of YAML 1.2; use include")
                )
                continue
            if key.value in entries:
                first = entries[key.value].place
                self.problems.append(
                    Problem(mark, (), f"key {key.value!r} appears twice, first on line {first.line}")
                )
                continue
            entries[key.value] = self.node(value, mark, (*path, key.value))
        return entries

    def _scalar(self, raw: yaml.ScalarNode, mark: Mark, path: KeyPath) -> Scalar:
        text = str(raw.value)
        if raw.style is not None:
            return text
        try:
            return resolve(text)
        except ValueError as error:
            shown = text if len(text) <= 24 else text[:24] + "..."
            self.problems.append(Problem(mark, path, f"{error}, got {shown}"))
            return 0


def _decimal_comma(before: yaml.Node | None, key: yaml.Node, value: yaml.Node) -> str | None:
    """What ``{a: 0,3}`` should say, which YAML reads as the value 0 and a key 3 without one; else None."""
    scalars = [n for n in (before, key, value) if isinstance(n, yaml.ScalarNode) and n.style is None]
    if before is None or len(scalars) < 3:
        return None
    whole, decimals, nothing = (scalar.value for scalar in scalars)
    if nothing or not (_INT.match(whole) and _DECIMALS.match(decimals)):
        return None
    # Blanks after a comma speak for a list of keys.
    if before.end_mark.index + 1 != key.start_mark.index:
        return None
    return f"{whole}.{decimals}"


def _mark(source: Source, raw: yaml.Node) -> Mark:
    start, end = raw.start_mark, raw.end_mark
    scalar = isinstance(raw, yaml.ScalarNode) and start.line == end.line
    return Mark(source, start.line + 1, start.column + 1, max(end.column - start.column, 1) if scalar else 1)


def _mark_of(source: Source, error: MarkedYAMLError) -> Mark:
    at = error.problem_mark or error.context_mark
    return Mark(source, at.line + 1, at.column + 1) if at else Mark(source, 1, 1)


def _message(error: MarkedYAMLError) -> str:
    problem = error.problem or "not a readable YAML text"
    if isinstance(error, _RefusedError):
        return problem
    if "\\t" in problem:
        return "a tab cannot indent YAML; use blanks"
    context = f" {error.context}" if error.context else ""
    return f"not valid YAML: {problem}{context}"
