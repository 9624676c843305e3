"""Parameters and repeated entries of a merged scenario, written out before it is validated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..frozen import frozen
from .checking.validation import validate
from .language.scenario import Scenario
from .text.parameters import KEY, Parameter, measures, mentions, resolve
from .text.problems import Problem, ProblemsError
from .text.substitution import concerned, substitute
from .text.tree import KeyPath, Node, as_written, place, told
from .views.walk import leaves


@frozen
class Expanded:
    """A merged scenario without parameters.

    Attributes:
        tree: Its text.
        parameters: What its values were computed from.
        numbers: Key paths at which a formula stood.
        used: Names of the parameters that it uses.
    """

    tree: Node
    parameters: Mapping[str, Parameter]
    numbers: frozenset[KeyPath]
    used: frozenset[str]


def expand(declared: Node, merged: Node) -> Expanded:
    """A scenario with its formulas computed and its repeated entries written out.

    Args:
        declared: The scenario before a profile and arguments changed it: what its parameters measure stays.
        merged: The scenario after that.

    Raises:
        ProblemsError: with every fault of its parameters, or of the formulas.
    """
    if not concerned(merged):
        return Expanded(merged, {}, frozenset(), frozenset())
    parameters = resolve(merged, measures(declared))
    found = substitute(merged, parameters)
    return Expanded(found.tree, parameters, found.numbers, found.used)


def validated(expanded: Expanded) -> Scenario:
    """The scenario of a tree whose formulas stand where numbers do.

    Raises:
        ProblemsError: with every fault of the schema, or every formula where text belongs.
    """
    scenario = validate(expanded.tree)
    if not expanded.numbers:
        return scenario
    message = "is text, and parameters stand for numbers; a dollar sign is written $$"
    problems = []
    for leaf in leaves(scenario):
        if leaf.path in expanded.numbers and isinstance(leaf.value, str):
            _, node = place(expanded.tree, leaf.path)
            problems.append(Problem(node.mark, as_written(expanded.tree, leaf.path), told(node, message)))
    if problems:
        raise ProblemsError(problems)
    return scenario


def unused(expanded: Expanded, profiles: Node | None) -> Iterator[str]:
    """Parameters that nothing uses, no other parameter and no profile either, one line each."""
    used = set(expanded.used)
    used.update(name for text in _texts(profiles) for name in mentions(text))
    for parameter in expanded.parameters.values():
        used.update(parameter.of)
    for name, parameter in expanded.parameters.items():
        if name not in used:
            yield Problem(parameter.declared, (KEY, name), "no value uses this parameter").line()


def _texts(node: Node | None) -> Iterator[str]:
    match None if node is None else node.value:
        case Mapping() as entries:
            for child in entries.values():
                yield from _texts(child)
        case tuple() as items:
            for item in items:
                yield from _texts(item)
        case str() as text if "$" in text:
            yield text
        case _:
            pass
