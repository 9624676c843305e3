"""Profiles price speed against accuracy: ``draft``, ``normal``, ``accurate``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from ...errors import ScenarioError
from ...frozen import frozen
from ...quantities import QuantityError, parse_quantity
from ...solve.integrators import INTEGRATORS, TrBdf2
from ...units import KINDS
from ...words import hint
from .merge import merge
from .parameters import refuse_new, spelled_out
from .problems import Problem, ProblemsError
from .tree import Mark, Node, Source, describe


@frozen
class Profile:
    """What a built-in profile does.

    Attributes:
        dt_factor: Factor of dt.
        tolerance: Newton tolerance.
        instead: Integrator that takes the place of one without damping. Those ring at large steps:
            fast waves that they do not resolve stay as they are excited, and the cuts that Newton's
            method then needs make a draft dearer than the scene as written.
    """

    dt_factor: float
    tolerance: float
    instead: str | None = None


NAMES: Final = ("draft", "normal", "accurate")
_BUILT_IN: Final = {"draft": Profile(4.0, 1e-5, TrBdf2.name), "accurate": Profile(0.25, 1e-10)}
_UNDAMPED: Final = frozenset(scheme.name for scheme in INTEGRATORS if scheme.order and not scheme.damping)


def apply_profile(root: Node, name: str | None, profiles: Node | None) -> Node:
    """``root`` under a profile: the one that the scenario declares, else the built-in one.

    Args:
        root: The scenario, includes merged.
        name: Profile asked for, or None.
        profiles: The ``profiles`` of the scenario: partial mappings by name. One that is declared
            replaces the built-in one of that name.

    Raises:
        ScenarioError: for an unknown name, or a declaration that is no mapping.
    """
    declared = _declared(profiles)
    if name is None:
        return root
    if name not in NAMES:
        raise ScenarioError(f"unknown profile {name!r}{hint(name, NAMES)} (there are {', '.join(NAMES)})")
    if name in declared:
        over = spelled_out(_noted(declared[name], f"profile {name}"))
        refuse_new(root, over, f"profile {name}")
        return merge(root, over)
    return _built_in(root, name) if name in _BUILT_IN else root


def _declared(profiles: Node | None) -> Mapping[str, Node]:
    if profiles is None:
        return {}
    if not isinstance(profiles.value, Mapping):
        message = f"expected a mapping, got {describe(profiles.value)}"
        raise ProblemsError([Problem(profiles.mark, ("profiles",), message)])
    problems = []
    for name, node in profiles.value.items():
        path = ("profiles", name)
        if name not in NAMES:
            problems.append(Problem(node.place, path, f"unknown profile{hint(name, NAMES)}"))
        elif not isinstance(node.value, Mapping):
            problems.append(Problem(node.mark, path, f"expected a mapping, got {describe(node.value)}"))
        else:
            for key in ("include", "profiles", "schema_version"):
                if (child := node.child(key)) is not None:
                    problems.append(Problem(child.place, (*path, key), "has no place in a profile"))
    if problems:
        raise ProblemsError(problems)
    return profiles.value


def _noted(node: Node, note: str) -> Node:
    match node.value:
        case Mapping() as entries:
            return replace(node, value={k: _noted(v, note) for k, v in entries.items()}, note=note)
        case tuple() as items:
            return replace(node, value=tuple(_noted(v, note) for v in items), note=note)
        case _:
            return replace(node, note=note)


def _built_in(root: Node, name: str) -> Node:
    profile, note = _BUILT_IN[name], f"profile {name}"
    numerics = root.child("numerics")
    if numerics is None or not isinstance(numerics.value, Mapping):
        return root  # the schema will say so
    mark = Mark(Source(note, "", positions=False), 1, 1)
    entries: dict[str, Node] = {"newton": Node({"tolerance": Node(profile.tolerance, mark)}, mark)}
    dt = numerics.child("dt")
    if dt is not None and (value := _times(dt, profile.dt_factor)) is not None:
        entries["dt"] = replace(dt, value=value, note=f"{note}, dt x {profile.dt_factor:g}")
    if profile.instead is not None and _undamped(numerics.child("integrator")):
        entries["integrator"] = Node({"type": Node(profile.instead, mark)}, mark, note=note)
        numerics = _without(numerics, "integrator")
    changed = merge(numerics, Node(entries, numerics.mark, numerics.key_mark))
    assert isinstance(root.value, Mapping)
    return replace(root, value={**root.value, "numerics": changed})


def _undamped(integrator: Node | None) -> bool:
    kind = integrator.child("type") if integrator is not None else None
    return kind is not None and isinstance(kind.value, str) and kind.value in _UNDAMPED


def _without(node: Node, key: str) -> Node:
    assert isinstance(node.value, Mapping)
    return replace(node, value={name: child for name, child in node.value.items() if name != key})


def _times(dt: Node, factor: float) -> float | str | None:
    """``dt`` by a factor: a number [s] or a formula; None if it makes no sense: the schema will say so."""
    match dt.value:
        case bool():
            return None
        case int() | float() as number:
            return number * factor
        case str() as text if "$" in text:
            return f"{factor:g} * ({text})"
        case str() as text:
            try:
                return parse_quantity(text, KINDS["time"]) * factor
            except QuantityError:
                return None
        case _:
            return None
