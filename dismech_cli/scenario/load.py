"""A scenario file, text or mapping to a validated scenario that remembers where each value was written."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any, Literal

from ..errors import ScenarioError
from ..frozen import frozen
from ..words import listed
from .checking.checks import findings
from .checking.default_kinds import default_kinds
from .checking.plausibility import doubts
from .checking.validation import check_version
from .expansion import Expanded, expand, unused, validated
from .language.scenario import Scenario
from .text.files import parse_source, read_source, resolve_file
from .text.merge import Includes, without
from .text.overrides import apply_override
from .text.parameters import Parameter
from .text.plain import parse_mapping
from .text.problems import Problem, ProblemsError, excerpt
from .text.profiles import NAMES, apply_profile
from .text.tree import KeyPath, Node, Source, as_written, place, point, told
from .values.law import TableFile, TableLaw
from .values.runtime_law import to_law
from .views.dump import dump_resolved, text_hash
from .views.provenance import Provenance, trace, trace_parameters
from .views.reference import json_schema, markdown_reference
from .views.walk import leaves, walk

__all__ = [
    "LoadedScenario",
    "Provenance",
    "dump_resolved",
    "json_schema",
    "load",
    "load_mapping",
    "load_text",
    "markdown_reference",
]

_TEXT, _MAPPING = "<text>", "<mapping>"
_FORMATS = ("yaml", "toml")


@frozen(kw_only=True)
class LoadedScenario:
    """A scenario and where it came from.

    Attributes:
        scenario: Validated, all numbers in SI units.
        path: The file, resolved; for a text or a mapping, a name in ``directory`` that no file has.
        directory: Its folder: names of files in the scenario start here.
        profile: Profile asked for, or None.
        overrides: ``KEY=VALUE`` texts that were applied.
        parameters: What values were computed from, by name.
        provenance: Value, unit and origin of each leaf by key path, such as ``numerics.dt``.
        warnings: Implausible values, each with its place.
        text_hash: SHA-256 of the resolved content.
        tree: The merged text with the places of its values.
    """

    scenario: Scenario
    path: Path
    directory: Path
    profile: str | None
    overrides: tuple[str, ...]
    parameters: Mapping[str, Parameter]
    provenance: Mapping[str, Provenance]
    warnings: tuple[str, ...]
    text_hash: str
    tree: Node = field(repr=False)

    def locate(self, path: str | KeyPath) -> str:
        """Where the value of a key path was written, such as ``scene.yaml:12:13``."""
        return str(point(place(self.tree, as_path(path))[1]))

    def excerpt(self, path: str | KeyPath) -> str:
        """The line that sets a key path, with a caret under the value."""
        return excerpt(point(place(self.tree, as_path(path))[1]))

    def error(self, path: str | KeyPath, message: str) -> ScenarioError:
        """An error that points to a key path, for the caller to raise."""
        return ProblemsError([_problem(self.tree, as_path(path), message)])

    def errors(self, findings: Iterable[tuple[KeyPath, str]]) -> ScenarioError:
        """One error that tells several faults, each at its key path."""
        return ProblemsError([_problem(self.tree, *finding) for finding in findings])

    def warning(self, path: str | KeyPath, message: str) -> str:
        """A doubt that points to a key path, as one line."""
        return _problem(self.tree, as_path(path), message).line()


def load(
    path: str | Path,
    *,
    overrides: Sequence[str] = (),
    profile: str | None = None,
    allow_outside: bool = False,
) -> LoadedScenario:
    """Read, merge and validate a scenario.

    Later settings win: defaults, include files, the file, the profile, overrides.

    Args:
        path: YAML or TOML file.
        overrides: Arguments such as ``numerics.dt=5 ms``, applied in order.
        profile: ``draft``, ``normal`` or ``accurate``.
        allow_outside: Permits files outside the folder of the scenario.

    Raises:
        ScenarioError: with every fault found, each with file, line, column and key.
    """
    return read_file(path, allow_outside=allow_outside).load(overrides, profile)


def read_file(path: str | Path, *, allow_outside: bool = False) -> Written:
    """Read a scenario file, to be loaded under several overrides.

    Args:
        path: YAML or TOML file.
        allow_outside: Permits files outside the folder of the scenario.

    Raises:
        ScenarioError: It cannot be read.
    """
    shown = Path(path)
    source = read_source(shown, str(shown))
    origin = _Origin(shown.resolve(), shown, allow_outside)
    return Written(parse_source(source, shown.suffix), origin)


def load_text(
    text: str,
    *,
    directory: str | Path = ".",
    format: Literal["yaml", "toml"] = "yaml",
    overrides: Sequence[str] = (),
    profile: str | None = None,
    allow_outside: bool = False,
) -> LoadedScenario:
    """Validate a scenario that is a text, as :func:`load` does with a file; messages call it ``<text>``.

    Args:
        text: The scenario.
        directory: Where names of files in it start.
        format: ``yaml`` or ``toml``.
        overrides: Arguments such as ``numerics.dt=5 ms``, applied in order.
        profile: ``draft``, ``normal`` or ``accurate``.
        allow_outside: Permits files outside ``directory``.

    Raises:
        ScenarioError: with every fault found, each with line, column and key.
    """
    if format not in _FORMATS:
        raise ScenarioError(f"unknown format {format!r}: a scenario is {listed(_FORMATS)}")
    tree = parse_source(Source(_TEXT, text), f".{format}")
    return _load(tree, _unnamed(_TEXT, directory, allow_outside), overrides, profile)


def load_mapping(
    mapping: Mapping[str, Any],
    *,
    directory: str | Path = ".",
    overrides: Sequence[str] = (),
    profile: str | None = None,
    allow_outside: bool = False,
) -> LoadedScenario:
    """Validate a scenario made in Python, as :func:`load` does with a file; messages call it ``<mapping>``.

    Args:
        mapping: The keys of a scenario file; values are numbers in SI units, texts such as ``"5 mm"``,
            sequences, NumPy arrays, mappings and paths.
        directory: Where names of files in it start.
        overrides: Arguments such as ``numerics.dt=5 ms``, applied in order.
        profile: ``draft``, ``normal`` or ``accurate``.
        allow_outside: Permits files outside ``directory``.

    Raises:
        ScenarioError: with every fault found, each with its key.
    """
    tree = parse_mapping(mapping, _MAPPING)
    return _load(tree, _unnamed(_MAPPING, directory, allow_outside), overrides, profile)


@frozen
class _Origin:
    """Where a scenario comes from.

    Attributes:
        path: The file, resolved.
        shown: The file as the user named it.
        allow_outside: Permits files outside its folder.
    """

    path: Path
    shown: Path
    allow_outside: bool


@frozen
class Written:
    """The text of a scenario file, before anything is merged into it."""

    _tree: Node
    _origin: _Origin

    def load(self, overrides: Sequence[str] = (), profile: str | None = None) -> LoadedScenario:
        """Merge and validate, as :func:`load` does.

        Raises:
            ScenarioError: with every fault found, each with file, line, column and key.
        """
        return _load(self._tree, self._origin, overrides, profile)


def _unnamed(name: str, directory: str | Path, allow_outside: bool) -> _Origin:
    folder = Path(directory)
    return _Origin(folder.resolve() / name, folder / name, allow_outside)


def _load(written: Node, origin: _Origin, overrides: Sequence[str], profile: str | None) -> LoadedScenario:
    """Merge and validate a scenario as written."""
    directory = origin.path.parent
    inside = None if origin.allow_outside else directory
    root = Includes(inside).expand(written, origin.path, origin.shown)
    check_version(root)
    profiles, body = root.child("profiles"), without(root, "profiles")
    expanded = _expanded(body, profiles, profile, overrides)
    merged = expanded.tree
    scenario = validated(expanded)
    problems = [_problem(merged, *finding) for finding in findings(scenario)]
    problems += _file_problems(scenario, merged, directory, inside)
    if problems:
        raise ProblemsError(problems)
    _check_other_profiles(body, profiles, profile, overrides)
    doubtful = [_problem(merged, *doubt).line() for doubt in doubts(scenario)]
    return LoadedScenario(
        scenario=scenario,
        path=origin.path,
        directory=directory,
        profile=profile,
        overrides=tuple(overrides),
        parameters=expanded.parameters,
        provenance={**trace_parameters(expanded.parameters), **trace(scenario, merged)},
        warnings=(*unused(expanded, profiles), *doubtful),
        text_hash=text_hash(scenario),
        tree=merged,
    )


def as_path(path: str | KeyPath) -> KeyPath:
    """``geometry[0].radius`` as ``('geometry', 0, 'radius')``; tuples pass through."""
    if isinstance(path, tuple):
        return path
    parts = re.findall(r"\[(\d+)\]|([^.\[\]]+)", path)
    return tuple(int(index) if index else key for index, key in parts)


def _problem(tree: Node, path: KeyPath, message: str) -> Problem:
    written, node = place(tree, path)
    return Problem(point(node), as_written(tree, written), told(node, message))


def _expanded(body: Node, profiles: Node | None, name: str | None, overrides: Sequence[str]) -> Expanded:
    """A scenario under a profile and overrides, its parameters and repeated entries written out."""
    return expand(body, _overridden(apply_profile(body, name, profiles), overrides))


def _overridden(root: Node, overrides: Sequence[str]) -> Node:
    problems: list[Problem] = []
    for argument in overrides:
        try:
            root = apply_override(root, argument, default_kinds())
        except ProblemsError as error:
            problems += error.problems
    if problems:
        raise ProblemsError(problems)
    return root


def _file_problems(scenario: Scenario, root: Node, directory: Path, tree: Path | None) -> Iterator[Problem]:
    """Files that cannot be used, and table files that are no tables."""
    unusable = set()
    for leaf in leaves(scenario):
        if leaf.file:
            try:
                resolve_file(leaf.value, directory, tree, folders=leaf.folder)
            except ScenarioError as error:
                unusable.add(leaf.value)
                yield _problem(root, leaf.path, str(error))
    for path, value in walk(scenario):
        if (
            isinstance(value, TableLaw)
            and isinstance(value.table, TableFile)
            and value.table.file not in unusable
        ):
            try:
                to_law(value, directory)
            except ScenarioError as error:
                yield _problem(root, (*path, "table", "file"), str(error))


def _check_other_profiles(
    body: Node, profiles: Node | None, chosen: str | None, overrides: Sequence[str]
) -> None:
    """Faults in declared profiles that are not asked for now would bite later."""
    for name in NAMES:
        if name != chosen and profiles is not None and profiles.child(name) is not None:
            expanded = _expanded(body, profiles, name, overrides)
            found = findings(validated(expanded))
            problems = [_problem(expanded.tree, *finding) for finding in found]
            if problems:
                raise ProblemsError(problems)
