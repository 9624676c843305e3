"""Pairs of a scene that may touch, by numbers."""

from __future__ import annotations

from dataclasses import dataclass

from ...scenario.language.scenario import Scenario
from ..touching import named_pairs


@dataclass(frozen=True, slots=True)
class Pair:
    """Two that may touch.

    Attributes:
        label: Its number among all pairs of the scene.
        first: Place of a body in the scenario.
        second: Place of a body, not before the first; or of an obstacle.
        friction: Coefficient.
    """

    label: int
    first: int
    second: int
    friction: float


def wall_pairs(scenario: Scenario) -> list[Pair]:
    """Bodies with obstacles."""
    return _pairs(scenario, [one.name for one in scenario.obstacles])


def body_pairs(scenario: Scenario) -> list[Pair]:
    """Bodies with bodies."""
    return _pairs(scenario, [one.name for one in scenario.geometry])


def _pairs(scenario: Scenario, seconds: list[str]) -> list[Pair]:
    bodies = [one.name for one in scenario.geometry]
    return [
        Pair(label, bodies.index(first), seconds.index(second), friction)
        for label, ((first, second), friction) in enumerate(named_pairs(scenario).items())
        if second in seconds
    ]
