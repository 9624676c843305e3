"""``parameters:`` of a scenario: named numbers with units and bounds, which its values are computed from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Final, TypeAlias

from ...frozen import frozen
from ...quantities import QuantityError, name_of, read_quantity
from ...units import KINDS, Dimension
from ...words import hint, listed
from .amount import Amount
from .formula import CONSTANTS, FUNCTIONS, FormulaError, evaluate
from .problems import Problem, ProblemsError
from .tree import Mark, Node, describe

KEY: Final = "parameters"
INDEX: Final = "i"
"""Name that counts the copies of a ``repeat``."""

SCHEMA: Final[Mapping[str, Mapping[str, Any]]] = {
    "default": {
        "type": ["number", "string"],
        "description": "Its value: a number, a quantity, or a formula of other parameters; "
        "without one `--set` or a profile must give it.",
    },
    "unit": {
        "type": "string",
        "description": "Its unit; numbers without one are in it. Default: that of `default`.",
    },
    "kind": {
        "enum": list(KINDS),
        "description": "What it measures, in place of `unit`; numbers without a unit are in SI.",
    },
    "min": {"type": ["number", "string"], "description": "Smallest value allowed."},
    "max": {"type": ["number", "string"], "description": "Greatest value allowed."},
    "description": {"type": "string", "description": "What it is."},
}
"""JSON Schema of the keys of a declaration."""

_MAX_LENGTH: Final = 64
_TOLD: Final = ""
"""Reason of a parameter that has no value for a fault that is told where it lies."""
_TAKEN: Final = frozenset({INDEX, *CONSTANTS, *FUNCTIONS})


@frozen
class Parameter:
    """A parameter and where its value was written.

    Attributes:
        name: Its name.
        amount: Its value.
        mark: Where the value was written.
        origin: The same, in words, such as ``scene.yaml:3:6`` or ``--set 'parameters.E=2 MPa'``.
        declared: Where its name was.
        of: Names of parameters in its formula.
    """

    name: str
    amount: Amount
    mark: Mark
    origin: str
    declared: Mark
    of: tuple[str, ...] = ()


Parameters: TypeAlias = Mapping[str, Parameter]
Measured: TypeAlias = Mapping[str, tuple[Dimension, str]]
"""What parameters measure, and where that was written."""


def spelled_out(root: Node) -> Node:
    """A scenario, or a part of one, whose parameters are mappings: ``E: 2 MPa`` is ``E: {default: 2 MPa}``.

    So a value laid over a declaration, by a file that includes it, a profile or an argument, keeps its
    bounds.
    """
    node = root.child(KEY)
    if node is None or not isinstance(node.value, Mapping):
        return root
    entries = {
        name: entry
        if isinstance(entry.value, Mapping)
        else Node({"default": entry}, entry.mark, entry.key_mark, entry.note)
        for name, entry in node.value.items()
    }
    assert isinstance(root.value, Mapping)
    return replace(root, value={**root.value, KEY: replace(node, value=entries)})


def refuse_new(root: Node, over: Node, where: str) -> None:
    """Refuse parameters that a setting gives and the scenario does not declare.

    Args:
        root: The scenario.
        over: The setting.
        where: What it is, for the message.

    Raises:
        ProblemsError: naming each.
    """
    given, known = over.child(KEY), root.child(KEY)
    names = known.value if known is not None and isinstance(known.value, Mapping) else {}
    if given is None or not isinstance(given.value, Mapping):
        return
    problems = [
        Problem(entry.place, (KEY, name), f"{where} sets an unknown parameter{_known(name, names)}")
        for name, entry in given.value.items()
        if name not in names
    ]
    if problems:
        raise ProblemsError(problems)


def _known(name: str, names: Mapping[str, object]) -> str:
    if not names:
        return "; the scenario declares none"
    return hint(name, names) or f"; declared: {listed(names, 'and')}"


def unknown(name: str, names: Mapping[str, object]) -> str:
    """What to say about a name that is no parameter."""
    if name == INDEX:
        return f"${INDEX} counts the copies of a 'repeat', and none is here"
    return f"unknown parameter ${name}{_known(name, names)}"


def measures(root: Node) -> Measured:
    """What each parameter measures as declared, before settings change its value; without those in doubt."""
    found: dict[str, tuple[Dimension, str]] = {}
    resolver = _Resolver(root, {})
    for name, node in resolver.nodes.items():
        try:
            dimension = resolver.amount(name).dimension
        except KeyError:
            continue
        if dimension is not None:
            default = node.child("default")
            found[name] = dimension, str((default or node).mark)
    return found


def resolve(root: Node, measured: Measured) -> Parameters:
    """The parameters of a scenario.

    Args:
        root: The scenario, all settings merged.
        measured: What they measured before settings changed them.

    Raises:
        ProblemsError: with every fault of their declarations.
    """
    resolver = _Resolver(root, measured)
    found = {}
    for name, node in resolver.nodes.items():
        try:
            amount = resolver.amount(name)
        except KeyError:
            continue
        written = node.child("default")
        assert written is not None
        text = written.value if isinstance(written.value, str) else ""
        of = tuple(name for name in mentions(text) if name in resolver.nodes)
        found[name] = Parameter(name, amount, written.mark, written.origin, node.place, of)
    if resolver.problems:
        raise ProblemsError(resolver.problems)
    return found


def mentions(text: str) -> Iterator[str]:
    """Names that a text may take for parameters."""
    for part in text.split("$")[1:]:
        end = part.find("}") if part.startswith("{") else len(part)
        yield from _words(part[1:end] if part.startswith("{") else part)


def _words(text: str) -> Iterator[str]:
    word = ""
    for letter in f"{text} ":
        if letter.isalnum() or letter == "_":
            word += letter
        elif word:
            yield word
            word = ""


class _Resolver:
    """Values of parameters, those that they depend on first; notes faults, each once."""

    def __init__(self, root: Node, measured: Measured) -> None:
        self.problems: list[Problem] = []
        self.measured = measured
        self.known: dict[str, Amount | None] = {}
        self.open: list[str] = []
        self.nodes: dict[str, Node] = {}
        node = root.child(KEY)
        if node is None:
            return
        if not isinstance(node.value, Mapping):
            self._fault(node, (), f"expected a mapping of names, got {describe(node.value)}")
            return
        for name, entry in node.value.items():
            if self._named(name, entry):
                self.nodes[name] = entry

    def amount(self, name: str) -> Amount:
        """The value of a parameter.

        Raises:
            KeyError: saying why there is none.
        """
        if name not in self.nodes:
            raise KeyError(unknown(name, self.nodes))
        if name in self.open:
            chain = " -> ".join(f"${one}" for one in (*self.open[self.open.index(name) :], name))
            raise KeyError(f"parameters depend on each other: {chain}")
        if name not in self.known:
            self.open.append(name)
            self.known[name] = self._computed(name, self.nodes[name])
            self.open.pop()
        found = self.known[name]
        if found is None:
            raise KeyError(_TOLD)
        return found

    def _named(self, name: str, node: Node) -> bool:
        """Whether a declaration has a usable name and keys."""
        if not (name.isascii() and name.isidentifier() and len(name) <= _MAX_LENGTH):
            self._fault(node, (name,), "not a usable name: letters, digits and '_', no digit first")
            return False
        if name in _TAKEN:
            self._fault(node, (name,), f"{name!r} has a meaning in formulas already; take another name")
            return False
        assert isinstance(node.value, Mapping)
        bad = [key for key in node.value if key not in SCHEMA]
        for key in bad:
            child = node.value[key]
            near = hint(key, SCHEMA) or f"; known: {listed(SCHEMA, 'and')}"
            self._fault(replace(child, mark=child.place), (name, key), f"unknown key{near}")
        return not bad

    def _computed(self, name: str, node: Node) -> Amount | None:
        default = node.child("default")
        if default is None or default.value is None:
            message = f"has no default: give its value by --set {KEY}.{name}=VALUE"
            self._fault(replace(node, mark=node.place), (name,), message)
            return None
        try:
            unit = self._unit(name, node)
            amount = self._in(default, unit)
            for key, sign, words in (("min", 1, "at least"), ("max", -1, "at most")):
                bound = node.child(key)
                if bound is not None:
                    self._bounded(amount, bound, self._literal(bound, unit), sign, words)
        except _FaultError as error:
            if str(error) != _TOLD:
                self._fault(error.node, (name, *error.key), str(error))
            return None
        return amount

    def _unit(self, name: str, node: Node) -> _Unit | None:
        """What numbers without a unit are in, and what all must measure; None if that is left open."""
        unit, kind = node.child("unit"), node.child("kind")
        if unit is not None and kind is not None:
            raise _FaultError(kind, "give 'unit' or 'kind', not both", "kind")
        if kind is not None:
            if not isinstance(kind.value, str) or kind.value not in KINDS:
                given = kind.value if isinstance(kind.value, str) else ""
                near = hint(given, KINDS) or f"; known: {', '.join(KINDS)}"
                raise _FaultError(kind, f"unknown kind{near}", "kind")
            known = KINDS[kind.value]
            return _Unit(1.0, known.dimension, known.also, str(kind.mark))
        if unit is not None:
            if not isinstance(unit.value, str | int):
                raise _FaultError(unit, f"expected a unit such as MPa, got {describe(unit.value)}", "unit")
            try:
                factor, dimension = read_quantity(f"1 {unit.value}")
            except QuantityError as error:
                raise _FaultError(unit, str(error), "unit") from None
            return _Unit(factor, dimension or Dimension(), (), str(unit.mark))
        if name in self.measured:
            dimension, where = self.measured[name]
            return _Unit(1.0, dimension, (), where)
        return None

    def _in(self, node: Node, unit: _Unit | None) -> Amount:
        if isinstance(node.value, str) and "$" in node.value:
            try:
                amount = evaluate(node.value, self.amount)
            except FormulaError as error:
                reason = str(error)
                shown = reason and f"{reason}, in {describe(node.value)}"
                raise _FaultError(node, shown, "default") from None
            return self._measuring(node, amount, unit)
        return self._literal(node, unit)

    def _literal(self, node: Node, unit: _Unit | None) -> Amount:
        match node.value:
            case bool():
                pass
            case int() | float() as number:
                return self._measuring(node, Amount(number), unit)
            case str() as text:
                try:
                    return self._measuring(node, Amount(*read_quantity(text)), unit)
                except QuantityError as error:
                    raise _FaultError(node, str(error)) from None
            case _:
                pass
        raise _FaultError(node, f"a parameter is a number or a quantity, got {describe(node.value)}")

    def _measuring(self, node: Node, amount: Amount, unit: _Unit | None) -> Amount:
        if unit is None:
            return amount
        if amount.dimension is None:
            value = amount.value if unit.factor == 1.0 else amount.value * unit.factor
            return Amount(value, unit.dimension)
        if amount.dimension not in (unit.dimension, *unit.also):
            message = (
                f"expected {name_of(unit.dimension)}, as {unit.where} says, got {name_of(amount.dimension)}"
            )
            raise _FaultError(node, message)
        return amount

    def _bounded(self, amount: Amount, node: Node, bound: Amount, sign: int, words: str) -> None:
        if bound.dimension != amount.dimension and not (bound.plain and amount.plain):
            message = f"a bound must measure what the value does: {amount} is the value"
            raise _FaultError(node, message)
        if sign * amount.value < sign * bound.value:
            raise _FaultError(None, f"must be {words} {describe(node.value)} ({node.mark}), got {amount}")

    def _fault(self, node: Node | None, path: tuple[str, ...], message: str) -> None:
        place = self.nodes[path[0]].child("default") if node is None else node
        assert place is not None
        self.problems.append(Problem(place.mark, (KEY, *path), message))


@frozen
class _Unit:
    """What a parameter measures.

    Attributes:
        factor: SI value of its unit.
        dimension: Its dimension.
        also: Others taken for it.
        where: Who says so.
    """

    factor: float
    dimension: Dimension
    also: tuple[Dimension, ...]
    where: str


class _FaultError(Exception):
    """A fault of a declaration at a node, or at its default."""

    def __init__(self, node: Node | None, message: str, *key: str) -> None:
        super().__init__(message)
        self.node = node
        self.key = key
