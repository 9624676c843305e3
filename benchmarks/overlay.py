"""Cost of what comes to touch: an extension of the pattern beside a pattern made anew."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from dismech_cli.arrays import IntArray
from dismech_cli.kernels.linearization import Coupling
from dismech_cli.model.model import Model
from dismech_cli.solve.pattern import SparsityPattern

from .clock import in_turns
from .newton_iteration import DT
from .scenes import helix
from .shell_scenes import sheet
from .table import table, verdict


@dataclass(frozen=True, slots=True)
class Case:
    """Pairs of cells that touch in a scene.

    Attributes:
        name: What touches.
        model: The scene.
        nodes: Nodes of each pair, shape (P, 4).
        bar: Time that the extension may take [ms].
    """

    name: str
    model: Model
    nodes: IntArray
    bar: float


def edge_pairs(edges: IntArray, count: int) -> IntArray:
    """Random edges that touch the edges of another part of the body, neighbours the neighbours."""
    rng = np.random.default_rng(0)
    first = np.sort(rng.integers(0, len(edges) // 2, count))
    second = np.clip(len(edges) - 1 - first + rng.integers(-3, 4, count), 0, len(edges) - 1)
    return np.concatenate((edges[first], edges[second]), axis=1)


def cases() -> list[Case]:
    """A rod with its far half on the near one; a sheet folded in two."""
    rod = helix(20_000, dt=DT, t_end=1.0)
    shell = sheet(20_000, bending="midedge", dt=DT, t_end=1.0)
    sides = shell.topology.triangles[:, :2]
    return [
        Case(
            "9 000 pairs of edges, 20 000 nodes of a framed rod",
            rod.model,
            edge_pairs(rod.topology.edges, 9000),
            40.0,
        ),
        Case("45 000 pairs of sides, 20 000 triangles", shell.model, edge_pairs(sides, 45_000), 150.0),
    ]


def extended(base: SparsityPattern, touching: Coupling) -> SparsityPattern:
    """A pattern with the places of what touches besides."""
    return base.extended(base.entries([touching])).pattern


def report(quick: bool) -> str:
    """Milliseconds of the extension, and of a pattern built anew with the same couplings."""
    rows = []
    for case in cases():
        dofs = case.model.dofs
        free = np.ones(dofs.n, dtype=np.bool_)
        couplings = [c for term in case.model.terms for c in term.couplings]
        touching = Coupling(dofs.of_nodes(case.nodes).reshape(len(case.nodes), -1))
        base = SparsityPattern.build(dofs, free, couplings, symmetric=True)
        larger = extended(base, touching)
        actions: list[Callable[[], object]] = [
            partial(extended, base, touching),
            partial(SparsityPattern.build, dofs, free, (*couplings, touching), symmetric=True),
        ]
        spent = 1e3 * in_turns(actions, seconds=1.0 if quick else 5.0).min(axis=0)
        added = (larger.nnz - base.nnz) / base.nnz
        rows.append((case.name, base.m, added, verdict(float(spent[0]), case.bar), float(spent[1])))
    return "\n\n".join(
        (
            "## What comes to touch\n\nExtension of the pattern by pairs of four nodes each [ms], beside "
            "a pattern made anew, whose terms would be bound again besides:",
            table(("scene", "free DOFs", "entries added / before", "extension", "made anew"), rows),
        )
    )
