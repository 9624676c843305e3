"""Pairs of a scene that may touch, by numbers."""

from __future__ import annotations

from collections.abc import Container, Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...scenario.language.scenario import Scenario
from ..touching import named_pairs


@frozen
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


@frozen
class Tables:
    """Who may touch whom, by the places of two bodies.

    Attributes:
        labels: Number of their pair, -1 if they may not touch, shape (bodies, bodies).
        signs: 1 where the first is the first of the pair, else -1, same shape.
        friction: Coefficients, same shape.
    """

    labels: IntArray
    signs: FloatArray
    friction: FloatArray

    @classmethod
    def of(cls, count: int, pairs: Sequence[Pair], faced: Container[int]) -> Tables:
        """Of pairs of ``count`` bodies, whose second index is among those that are faced."""
        labels = np.full((count, count), -1, dtype=np.int64)
        signs, friction = np.ones((count, count)), np.zeros((count, count))
        for pair in pairs:
            for a, b in ((pair.first, pair.second), (pair.second, pair.first)):
                if b in faced:
                    labels[a, b], friction[a, b] = pair.label, pair.friction
            if pair.first != pair.second:
                signs[pair.second, pair.first] = -1.0
        return cls(labels, signs, friction)


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
