"""A scenario at values of its settings near those it has.

Each setting has neighbours of its own, but for values in tables of time under `actuation` and `forces`:
between two rows nothing depends on any others, so that every third row varies at once, and each has the
change in its own span of time.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from ...compose.compose import Composition, compose
from ...errors import ScenarioError
from ...frozen import frozen
from ...model.alike import alike
from ...run.simulation import Simulation
from ...scenario.language.scenario import Scenario
from ...scenario.load import as_path
from ...scenario.values.law import TableLaw
from ...solve.neighbours import ALWAYS, DIFFERENCES, Difference, Neighbours, Span
from ..source import Source
from .setting import Setting

# Values in tables of time; those of motions are remembered by what moves.
_IN_TABLE: Final = re.compile(r"((?:actuation|forces)\[.+\.table)\[(\d+)\]\[1\]")
# Where one row ends another begins: spans of every second one meet.
_APART: Final = 3


@frozen
class Nearby:
    """A scene at neighbouring values of a setting.

    Attributes:
        setting: The setting.
        difference: Says at which values.
        compositions: The scene there.
        span: When the balance depends on the setting.
    """

    setting: Setting
    difference: Difference
    compositions: tuple[Composition, ...]
    span: Span = ALWAYS

    @property
    def simulations(self) -> tuple[Simulation, ...]:
        """What would be run there."""
        return tuple(one.simulation for one in self.compositions)

    @property
    def neighbours(self) -> Neighbours:
        """What the balance wants to know of them."""
        models = tuple(one.model for one in self.simulations)
        starts = tuple(one.start for one in self.simulations)
        return Neighbours(self.setting.step, self.difference, models, starts, self.span)


def nearby(source: Source, settings: Sequence[Setting], composition: Composition) -> list[Nearby]:
    """The scene at neighbouring values of settings, on both sides of each where the language allows.

    Args:
        source: The scenario.
        settings: Some of its values.
        composition: The scene as it is.

    Raises:
        ScenarioError: It cannot be composed on either side.
    """
    kernels, base = composition.plan.kernels, composition.simulation
    found: dict[str, Nearby] = {}
    for rows in _tables(source, settings):
        for first in range(_APART):
            each = {k: one for k, one in rows.items() if k % _APART == first}
            found |= _together(source, each, kernels, base)
    for setting in settings:
        if setting.path not in found:
            found[setting.path] = Nearby(setting, *_around(source, (setting,), kernels))
    return [found[setting.path] for setting in settings]


Rows = Mapping[int, tuple[Setting, Span]]
"""Settings that are values of a table, by row, with the time in which each counts."""


def _tables(source: Source, settings: Sequence[Setting]) -> list[Rows]:
    """Tables of which more rows are settings than could vary at once."""
    among: dict[str, dict[int, Setting]] = {}
    for setting in settings:
        if match := _IN_TABLE.fullmatch(setting.path):
            among.setdefault(match[1], {})[int(match[2])] = setting
    many = {path: rows for path, rows in among.items() if len(rows) > _APART}
    if not many:
        return []
    scenario = source.load().scenario
    tables: list[Rows] = []
    for path, rows in many.items():
        times = _times(scenario, path)
        tables.append({k: (one, _span(times, k)) for k, one in rows.items()} if times else {})
    return tables


def _times(scenario: Scenario, path: str) -> tuple[float, ...]:
    """Times of a table between whose rows nothing but these counts; none where that is not so."""
    node: object = scenario
    for key in as_path(path)[:-1]:
        node = node[key] if isinstance(key, int) else getattr(node, key)  # type: ignore[index]
    if not isinstance(node, TableLaw) or not isinstance(node.table, tuple) or node.interpolation == "cubic":
        return ()
    return tuple(row[0] for row in node.table)


def _span(times: tuple[float, ...], k: int) -> Span:
    ends = (-np.inf, *times, np.inf)
    first, last = k == 0, k == len(times) - 1
    return (-np.inf if first else ends[k], np.inf if last else ends[k + 2])


def _together(source: Source, rows: Rows, kernels: str, base: Simulation) -> dict[str, Nearby]:
    """Rows of a table varied at once, by key path; none where more depends on them than the balance."""
    if not rows:
        return {}
    try:
        difference, near = _around(source, [setting for setting, _ in rows.values()], kernels)
    except ScenarioError:
        return {}
    if not all(_alike_elsewhere(base, one.simulation) for one in near):
        return {}
    return {one.path: Nearby(one, difference, near, span) for one, span in rows.values()}


def _alike_elsewhere(one: Simulation, other: Simulation) -> bool:
    """Whether what two scenes weigh, hold, touch and start from is the same."""
    pairs = (
        (one.model.mass, other.model.mass),
        (one.model.motions, other.model.motions),
        (one.model.changing, other.model.changing),
        (one.start, other.start),
        (one.controls, other.controls),
    )
    return all(alike(*pair) for pair in pairs)


def _around(
    source: Source, settings: Sequence[Setting], kernels: str
) -> tuple[Difference, tuple[Composition, ...]]:
    """The scene where all settings have neighbouring values at once.

    Raises:
        ScenarioError: It cannot be composed on either side.
    """
    refused: ScenarioError | None = None
    for difference in DIFFERENCES:
        near = []
        try:
            for offset in difference.offsets:
                there = [one.to(one.value + offset * one.step) for one in settings]
                near.append(compose(source.load(*there), kernels))
        except ScenarioError as error:
            refused = refused or error
            continue
        return difference, tuple(near)
    assert refused is not None
    raise ScenarioError(f"{settings[0].path} cannot vary: {refused}") from refused
