"""Rods that touch, without a scenario: chains of nodes with a radius."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dismech_cli.arrays import FloatArray
from dismech_cli.contact.drivers.batches import Batches
from dismech_cli.contact.nearby.neighbours import Neighbours
from dismech_cli.contact.pairs.rod_pairs import RodPairs
from dismech_cli.contact.pairs.search import Search
from dismech_cli.contact.pieces.lines import Lines
from dismech_cli.kinematics.dofs import DofMap


def neighbours(chains: Sequence[FloatArray], radius: float) -> tuple[Neighbours, FloatArray]:
    """Chains of nodes (n, 3) that may touch each other, not themselves, at stiffness one; and all nodes."""
    x = np.concatenate(chains)
    starts = np.cumsum([0, *(len(chain) for chain in chains)])
    nodes = np.concatenate(
        [
            np.stack((np.arange(len(chain) - 1), np.arange(1, len(chain))), axis=1) + start
            for chain, start in zip(chains, starts, strict=False)
        ]
    )
    count, bodies = len(nodes), len(chains)
    one, none = np.ones(count), np.empty(0, dtype=np.int64)
    lines = Lines(
        nodes,
        np.linalg.norm(x[nodes[:, 1]] - x[nodes[:, 0]], axis=1),
        radius * one,
        one,
        one,
        one,
        np.repeat(np.arange(bodies), [len(chain) - 1 for chain in chains]),
        tuple("abcdef"[:bodies]),
    )
    labels = np.where(np.eye(bodies, dtype=bool), -1, 0)
    signs = np.where(np.triu(np.ones((bodies, bodies))) > 0, 1.0, -1.0)
    none_x = np.empty(0)
    found = Neighbours(
        lines=lines,
        numbers=np.arange(count),
        stiffness=one,
        labels=labels,
        signs=signs,
        friction=np.zeros((bodies, bodies)),
        excluded=none,
        tight=none,
        tight_reach=none_x,
        map=DofMap(len(x), 0, (0, 1, 2), len(x)),
    )
    return found, x


def energy(found: Neighbours, x: FloatArray) -> float:
    """Energy of contact [J]."""
    pairs = RodPairs(Search(found, Batches()))
    pairs.detect(x)
    return sum(float(t.points.energy.sum()) for t in pairs.touching(x, 0.0 * x, 0.0, 1.0))


def gradient(found: Neighbours, x: FloatArray) -> FloatArray:
    """Its derivative to the nodes [N], shape (N, 3)."""
    pairs = RodPairs(Search(found, Batches()))
    pairs.detect(x)
    r = np.zeros(x.size)
    for touching in pairs.touching(x, 0.0 * x, 0.0, 1.0):
        touching.stencils.add(touching.points.item, touching.points.gradients(), r)
    return r.reshape(x.shape)


def stiffness(found: Neighbours, x: FloatArray) -> FloatArray:
    """Its second derivative, shape (3 N, 3 N)."""
    pairs = RodPairs(Search(found, Batches()))
    pairs.detect(x)
    full = np.zeros((x.size, x.size))
    for touching in pairs.touching(x, 0.0 * x, 0.0, 1.0):
        dofs = touching.stencils.dofs[touching.points.item]
        local = touching.stencils.local(touching.points.hessians())
        np.add.at(full, (dofs[:, :, None], dofs[:, None, :]), local)
    return full
