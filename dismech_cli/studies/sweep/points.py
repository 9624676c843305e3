"""The points of a sweep: every one a scenario that was read and found sound, named by its content."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from functools import cache, lru_cache
from pathlib import Path

from ...control.plugin import load_plugins
from ...errors import ScenarioError
from ...frozen import frozen
from ...output.jsonable import Json, to_json
from ...output.manifest import FILE_NAME as MANIFEST
from ...output.manifest import installed_versions
from ...output.run_directory import RUN_FILE
from ...scenario.language.probe import quantity_of
from ...scenario.language.sweep import Sweep
from ...scenario.load import LoadedScenario, load
from ...scenario.text.problems import Problem, ProblemsError
from ...scenario.views.walk import leaves
from ...units import KINDS
from .axes import Row, rows

_TOLD = 20


@frozen
class Setting:
    """A value that a point sets.

    Attributes:
        key: Key path.
        text: As written.
        value: In SI units, where it is a number; else the text.
        unit: SI unit; empty if the value is no quantity.
    """

    key: str
    text: str
    value: Json
    unit: str


@frozen
class Point:
    """A run to be made.

    Attributes:
        id: First 16 digits of the hash of what decides its result.
        settings: What it sets.
        units: SI units of its probes, by name.
        doubts: What is doubtful in its scenario.
    """

    id: str
    settings: tuple[Setting, ...]
    units: Mapping[str, str] = field(compare=False)
    doubts: tuple[str, ...] = field(compare=False)

    @property
    def label(self) -> str:
        """What it sets, on one line."""
        return ", ".join(f"{one.key}={one.text}" for one in self.settings)

    @property
    def overrides(self) -> tuple[str, ...]:
        """The same as ``--set`` takes it."""
        return tuple(f"{one.key}={one.text}" for one in self.settings)


@frozen(kw_only=True)
class Base:
    """The scenario that all points change.

    Attributes:
        path: The file.
        overrides: ``KEY=VALUE`` texts that hold for all points.
        profile: ``draft``, ``normal``, ``accurate`` or None.
        allow_outside: Whether files may lie outside the folder of the scenario.
        plugins: Files of controllers.
    """

    path: Path
    overrides: tuple[str, ...] = ()
    profile: str | None = None
    allow_outside: bool = False
    plugins: tuple[Path, ...] = ()

    def load(self, more: Sequence[str] = ()) -> LoadedScenario:
        """The scenario with further overrides.

        Raises:
            ScenarioError: It cannot be read.
        """
        return load(
            self.path,
            overrides=(*self.overrides, *more),
            profile=self.profile,
            allow_outside=self.allow_outside,
        )


def points_of(base: Base, axes: Sweep | None = None) -> tuple[Point, ...]:
    """Every point of a sweep, read and checked.

    Args:
        base: What all points change.
        axes: What is varied; None takes the section ``sweep`` of the scenario.

    Raises:
        ScenarioError: There is no such section; there are too many points; some cannot run, or are the same.
    """
    loaded = base.load()
    sweep = loaded.scenario.sweep if axes is None else axes
    if sweep is None:
        raise ScenarioError(
            f"{base.path}: nothing to vary: add a section 'sweep', or say what with --over KEY=V1,V2,..."
        )
    made = rows(sweep, loaded.directory)
    given = {text.partition("=")[0].strip() for text in base.overrides}
    both = sorted(given & {key for key, _ in made[0]})
    if both:
        raise ScenarioError(f"--set {both[0]}: it is varied: every point sets it anew")
    found = tuple(_read(base, made))
    _refuse_same(found)
    return found


def shard(points: Sequence[Point], index: int, count: int) -> tuple[Point, ...]:
    """Every ``count``-th point by name, from ``index``, counted from 1; in the order of the sweep."""
    mine = set(sorted(point.id for point in points)[index - 1 :: count])
    return tuple(point for point in points if point.id in mine)


def _read(base: Base, made: Sequence[Row]) -> Iterator[Point]:
    problems: list[Problem] = []
    commanding = {name: one.digest for name, one in load_plugins(base.plugins).files.items()}
    for row in made:
        try:
            loaded = base.load([f"{key}={text}" for key, text in row])
        except ProblemsError as error:
            problems += [one for one in error.problems if str(one) not in {str(p) for p in problems}]
            if len(problems) >= _TOLD:
                break
            continue
        yield Point(
            id=_name(loaded, commanding),
            settings=tuple(_setting(loaded, *one) for one in row),
            units={
                name: KINDS[quantity_of(probe)].unit for name, probe in loaded.scenario.output.probes.items()
            },
            doubts=loaded.warnings,
        )
    if problems:
        raise ProblemsError(problems)


def _setting(loaded: LoadedScenario, key: str, text: str) -> Setting:
    found = loaded.provenance.get(key)
    if found is None or isinstance(found.value, str | bool) or found.value is None:
        return Setting(key, text, text, "")
    return Setting(key, text, to_json(found.value), "" if found.unit == "1" else found.unit)


def _name(loaded: LoadedScenario, plugins: Mapping[str, str]) -> str:
    """Of a scenario: the same for the same content of it, of its files and of plugins, in one version."""
    files = {
        str(leaf.value): _digest((loaded.directory / leaf.value).resolve())
        for leaf in leaves(loaded.scenario)
        if leaf.file and leaf.path[0] not in ("include", "sweep")
    }
    whole: Mapping[str, object] = {
        "scenario": loaded.text_hash,
        "files": files,
        "version": _version(),
    }
    if plugins:
        whole = {**whole, "plugins": plugins}
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()[:16]


@cache
def _version() -> str:
    return installed_versions()["dismech"]


@lru_cache(maxsize=1024)
def _digest(file: Path) -> str:
    if file.is_dir():  # another run, from whose end this one starts
        parts = [_digest(file / name) for name in (MANIFEST, RUN_FILE) if (file / name).is_file()]
        return hashlib.sha256("".join(parts).encode()).hexdigest()
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _refuse_same(points: Sequence[Point]) -> None:
    """Refuse points that are one scenario: their rows would be counted twice, or nothing is varied.

    Raises:
        ScenarioError: naming two.
    """
    known: dict[str, Point] = {}
    for point in points:
        if point.id in known:
            raise ScenarioError(
                f"two points are the same scenario: {known[point.id].label} and {point.label}; "
                "does anything use what they set?"
            )
        known[point.id] = point
