"""What a run predicts for a table of samples, and how that changes with the parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Protocol

import numpy as np
from scipy.sparse import csr_matrix

from ...arrays import FloatArray, IntArray
from ...compose.compose import Composition
from ...errors import ScenarioError
from ...frozen import frozen
from ...model.state import State
from ...scenario.language.calibrate import Markers
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from ...solve.neighbours import Variation
from ...words import hint
from ..gradient.nearby import Nearby
from ..gradient.reading import Readings
from ..gradient.run import TapedRun

Seen = tuple[State, FloatArray]
"""An accepted state, and the residual of the step to it."""


class Channel(Protocol):
    """Numbers that are read from a state, one for each column of a table."""

    @property
    def of_forces(self) -> bool:
        """Whether any is read from the residual."""

    def values(self, seen: Seen) -> FloatArray:
        """The numbers, shape (C,)."""

    def slopes(self, seen: Seen, d: Variation) -> FloatArray:
        """Their derivatives, shape (C, P)."""


@frozen
class Points:
    """Coordinates of points of a body, marker by marker.

    Attributes:
        weights: What they are of the DOFs, shape (C, n).
        moved: Change of the weights with each parameter, where the mesh changes with it.
    """

    weights: csr_matrix
    moved: tuple[csr_matrix, ...]
    of_forces: ClassVar[bool] = False

    def values(self, seen: Seen) -> FloatArray:
        """The coordinates [m]."""
        return np.asarray(self.weights @ seen[0].q)

    def slopes(self, seen: Seen, d: Variation) -> FloatArray:
        """Their derivatives."""
        slopes = np.asarray(self.weights @ d.q)
        for k, weights in enumerate(self.moved):
            slopes[:, k] += weights @ seen[0].q
        return slopes


@frozen
class Probed:
    """Probes of the output.

    Attributes:
        readings: One for each.
    """

    readings: tuple[Readings, ...]

    @property
    def of_forces(self) -> bool:
        """Whether any does."""
        return any(one.of_forces for one in self.readings)

    def values(self, seen: Seen) -> FloatArray:
        """What they read."""
        return np.array([one.value(*seen) for one in self.readings])

    def slopes(self, seen: Seen, d: Variation) -> FloatArray:
        """Their derivatives."""
        return np.stack([one.slopes(*seen, d) for one in self.readings])


def points(
    loaded: LoadedScenario,
    path: KeyPath,
    markers: Markers,
    composition: Composition,
    near: Sequence[Nearby],
) -> Points:
    """The markers of a body.

    Raises:
        ScenarioError: There is no such body, node, length or coordinate.
    """
    weights = _weights(loaded, path, markers, composition)
    known: dict[int, csr_matrix] = {}
    moved = []
    for one in near:
        for there in one.compositions:
            if id(there) not in known:  # values of one table share them
                known[id(there)] = _weights(loaded, path, markers, there)
        others = [known[id(there)] for there in one.compositions]
        change = 0.0 * weights
        for part, other in zip(one.difference.weights, others, strict=True):
            change = change + part * other
        moved.append(csr_matrix(change / one.setting.step))
    return Points(weights, tuple(moved))


def _weights(loaded: LoadedScenario, path: KeyPath, markers: Markers, composition: Composition) -> csr_matrix:
    geometry, dofs = composition.geometry, composition.simulation.model.dofs
    if markers.of not in geometry.body_nodes:
        near = hint(markers.of, geometry.body_nodes)
        raise loaded.error((*path, "of"), f"no body is named {markers.of!r}{near}")
    nodes = geometry.body_nodes[markers.of]
    axes = ["xyz".index(letter) for letter in markers.columns]
    for letter, axis in zip(markers.columns, axes, strict=True):
        if axis not in dofs.axes:
            raise loaded.error((*path, "columns", letter), f"{letter} is out of the plane of the scene")
    if markers.nodes is not None:
        for k, node in enumerate(markers.nodes):
            if node >= len(nodes):
                message = f"{markers.of!r} has {len(nodes)} nodes, counted from 0; there is no {node}"
                raise loaded.error((*path, "nodes", k), message)
        first = second = nodes[list(markers.nodes)]
        share = np.zeros(len(first))
    else:
        assert markers.arc is not None
        first, second, share = _along(loaded, path, np.array(markers.arc), geometry.nodes, nodes)
    rows, columns, values = [], [], []
    for ends, part in ((first, 1.0 - share), (second, share)):
        for k, axis in enumerate(axes):
            rows.append(np.arange(len(ends)) * len(axes) + k)
            columns.append(dofs.of_nodes(ends)[:, dofs.axes.index(axis)])
            values.append(part)
    shape = (len(first) * len(axes), dofs.n)
    entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return csr_matrix(entries, shape=shape)


def _along(
    loaded: LoadedScenario, path: KeyPath, arcs: FloatArray, x: FloatArray, nodes: IntArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Nodes before and after lengths along a rod, and the share of the second."""
    length = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(x[nodes], axis=0), axis=1))))
    slack = 1e-9 * length[-1]
    for k, arc in enumerate(arcs):
        if not -slack <= arc <= length[-1] + slack:
            raise loaded.error((*path, "arc", k), f"the rod is {length[-1]:.6g} m long")
    after = np.clip(np.searchsorted(length, arcs), 1, len(nodes) - 1)
    share = (arcs - length[after - 1]) / (length[after] - length[after - 1])
    return nodes[after - 1], nodes[after], share


@frozen
class Sampling:
    """Which states count for the samples of a table, and by how much: four around each time.

    Attributes:
        states: Numbers of states, ascending, shape (K,).
        weights: Of these at each sample, shape (R, K).
    """

    states: IntArray
    weights: csr_matrix


def sampling(times: FloatArray | None, run: TapedRun, *, still: bool) -> Sampling:
    """Interpolation between the states of a run; linear in statics, whose states jump.

    Raises:
        ScenarioError: A time is not within the run.
    """
    known = np.array([run.simulation.start.t, *(one.result.state.t for one in run.steps)])
    if times is None:
        return Sampling(np.array([len(known) - 1]), csr_matrix(np.ones((1, 1))))
    slack = 1e-9 * known[-1]
    if times[0] < known[0] - slack or times[-1] > known[-1] + slack:
        raise ScenarioError(
            f"samples from {times[0]:.6g} s to {times[-1]:.6g} s, but the run goes to {known[-1]:.6g} s: "
            "let it go on, or leave them out by 'before'"
        )
    around = 2 if still else min(4, len(known))
    begin = np.clip(np.searchsorted(known, times - slack) - around // 2, 0, len(known) - around)
    places = begin[:, None] + np.arange(around)
    nodes = known[places]
    weights = np.ones_like(nodes)
    for i in range(around):
        for j in range(around):
            if i != j:
                weights[:, i] *= (times - nodes[:, j]) / (nodes[:, i] - nodes[:, j])
    weights[np.abs(weights) < 1e-12] = 0.0
    states, columns = np.unique(places, return_inverse=True)
    rows = np.repeat(np.arange(len(times)), around)
    entries = (weights.ravel(), (rows, columns.ravel()))
    return Sampling(states, csr_matrix(entries, shape=(len(times), len(states))))
