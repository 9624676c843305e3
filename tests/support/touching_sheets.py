"""Sheets that touch, without a scenario: nodes and triangles with a thickness."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from dismech_cli.arrays import FloatArray, IntArray
from dismech_cli.contact.drivers.batches import Batches
from dismech_cli.contact.nearby.exclusion import near_along
from dismech_cli.contact.nearby.faces import Faces
from dismech_cli.contact.nearby.surface_exclusion import with_exclusions
from dismech_cli.contact.pairs.surface_pairs import SurfacePairs
from dismech_cli.contact.pairs.surface_search import FaceSearch
from dismech_cli.contact.pieces.lines import Lines
from dismech_cli.contact.pieces.surface import Surface
from dismech_cli.kinematics.dofs import DofMap

Sheet: TypeAlias = tuple[FloatArray, IntArray]
"""Nodes (n, 3) and triangles (m, 3)."""


def flat(length: float, edge: float, *, turn: float = 0.0, jitter: float = 0.0) -> Sheet:
    """A square about the origin in two triangles per cell, turned by an angle [deg]."""
    rng = np.random.default_rng(8)
    count = max(round(length / edge), 1)
    s = np.linspace(-0.5 * length, 0.5 * length, count + 1)
    x, y = (grid.reshape(-1) for grid in np.meshgrid(s, s, indexing="ij"))
    inner = (np.abs(x) < 0.499 * length) & (np.abs(y) < 0.499 * length)
    off = jitter * length / count * rng.uniform(-1.0, 1.0, size=(2, len(x))) * inner
    x, y = x + off[0], y + off[1]
    a = np.radians(turn)
    nodes = np.stack((np.cos(a) * x - np.sin(a) * y, np.sin(a) * x + np.cos(a) * y, 0.0 * x), axis=1)
    i, j = (grid.reshape(-1) for grid in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    corner = i * (count + 1) + j
    one = np.stack((corner, corner + count + 1, corner + count + 2), axis=1)
    return nodes, np.concatenate((one, np.stack((corner, corner + count + 2, corner + 1), axis=1)))


def faces(
    sheets: Sequence[Sheet], thickness: float, chains: Sequence[FloatArray] = (), *, own: bool = False
) -> tuple[Faces, FloatArray]:
    """Sheets and rods of one thickness that may touch each other at stiffness one, and all nodes."""
    parts = [*(sheet[0] for sheet in sheets), *chains]
    starts = np.cumsum([0, *(len(part) for part in parts)])
    x = np.concatenate(parts)
    triangles = np.concatenate([sheet[1] + start for sheet, start in zip(sheets, starts, strict=False)])
    of = np.repeat(np.arange(len(sheets)), [len(sheet[1]) for sheet in sheets])
    halves = np.sort(np.stack((triangles, np.roll(triangles, -1, axis=1)), axis=-1), axis=-1)
    sides, numbers = np.unique(halves.reshape(-1, 2), axis=0, return_inverse=True)
    numbers = numbers.reshape(-1, 3)
    u, v = x[triangles[:, 1]] - x[triangles[:, 0]], x[triangles[:, 2]] - x[triangles[:, 0]]
    areas = 0.5 * np.linalg.norm(np.cross(u, v), axis=1)
    lengths = np.linalg.norm(x[sides[:, 1]] - x[sides[:, 0]], axis=1)
    widths = np.bincount(numbers.reshape(-1), weights=np.repeat(areas / 3.0, 3)) / lengths
    body_of_node = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    rods = [
        np.stack((np.arange(len(c) - 1), np.arange(1, len(c))), axis=1) + start
        for c, start in zip(chains, starts[len(sheets) :], strict=False)
    ]
    nodes = np.concatenate((sides, *rods))
    rest = np.linalg.norm(x[nodes[:, 1]] - x[nodes[:, 0]], axis=1)
    one = np.ones(len(nodes))
    lines = Lines(
        nodes=nodes,
        lengths=rest,
        radii=0.5 * thickness * one,
        weights=np.concatenate((widths, np.ones(len(nodes) - len(sides)))),
        masses=one,
        loads=one,
        bodies=body_of_node[nodes[:, 0]],
        names=tuple("abcdef"[: len(parts)]),
    )
    count = len(parts)
    labels = np.zeros((count, count), dtype=np.int64)
    labels[:, len(sheets) :] = -1
    labels[np.arange(len(sheets)), np.arange(len(sheets))] = 0 if own else -1
    found = Faces(
        lines=lines,
        numbers=np.arange(len(nodes)),
        surface=Surface(triangles, np.full(len(triangles), 0.5 * thickness), np.ones(len(triangles)), of),
        masses=one,
        stiffness=np.where(np.arange(count)[:, None] < len(sheets), 0.5, 1.0) * np.ones((count, count)),
        labels=labels,
        signs=np.where(np.triu(np.ones((count, count))) > 0, 1.0, -1.0),
        friction=np.zeros((count, count)),
        excluded=np.empty(0, dtype=np.int64),
        own_reach=np.full(len(nodes), np.inf),
        map=DofMap(len(x), 0, (0, 1, 2), len(x)),
    )
    near = near_along(nodes, rest, lines.radii, len(x))
    return with_exclusions(found, x, np.stack(np.divmod(near, len(nodes)), axis=1), numbers), x


def energy(found: Faces, x: FloatArray) -> float:
    """Energy of contact [J]."""
    pairs = SurfacePairs(FaceSearch(found, Batches()))
    pairs.detect(x)
    return sum(float(t.points.energy.sum()) for t in pairs.touching(x, 0.0 * x, 0.0, 1.0))


def gradient(found: Faces, x: FloatArray) -> FloatArray:
    """Its derivative to the nodes [N], shape (N, 3)."""
    pairs = SurfacePairs(FaceSearch(found, Batches()))
    pairs.detect(x)
    r = np.zeros(x.size)
    for touching in pairs.touching(x, 0.0 * x, 0.0, 1.0):
        touching.stencils.add(touching.points.item, touching.points.gradients(), r)
    return r.reshape(x.shape)
