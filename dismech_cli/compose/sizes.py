"""What a run holds in memory: roughly before anything large is made of a scene, well once it is made."""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import suppress
from math import pi
from pathlib import Path
from typing import Final

import numpy as np

from ..errors import ScenarioError
from ..model.model import Model
from ..scenario.language.geometry import Rod, Shell
from ..scenario.language.scenario import Scenario
from ..scenario.language.shape import Arc, Helix, Line
from ..scenario.load import LoadedScenario
from .bodies.geometry import Geometry
from .touching import named_pairs

# Peaks of whole runs, measured (benchmarks/memory.py), pictures aside, which another process draws.
_PROGRAM: Final = 117e6  # bytes of Python with its libraries
_MKL, _NUMBA = 24e6, 109e6  # bytes of those
# Before a scene is composed, by the edge and the triangle; framed bending and hinges are the dearest.
_PLANAR_EDGE, _EDGE, _TRIANGLE = 4e3, 10e3, 22e3  # bytes
# Afterwards, by the pair of DOFs that a stencil couples (tables of slots; NumPy keeps all Hessians too) and
# by the entry of the matrix (values, factors).
_PER_PAIR: Final = {"numpy": 69.0, "numba": 12.0}  # bytes
_PER_ENTRY: Final = {"numpy": 0.0, "numba": 155.0}  # bytes
# What contact sorts out of lines of a body nearer along it than half a circle of its thickness, by their pair
# [byte]: those of shells are put together with triangles too.
_PER_ROD_NEIGHBOUR, _PER_SHELL_NEIGHBOUR = 170.0, 700.0
_CGROUP_LIMIT: Final = Path("/sys/fs/cgroup/memory.max")


def memory(model: Model, kernels: str, solver: str, entries: int) -> float:
    """Peak of a run [byte], within a factor of 1.5.

    Args:
        model: What it steps.
        kernels: ``numpy`` or ``numba``.
        solver: Its linear solver.
        entries: Stored entries of the matrix.
    """
    couplings = [coupling.dofs for term in model.terms for coupling in term.couplings]
    pairs = float(sum(dofs.size * dofs.shape[1] for dofs in couplings))
    libraries = _PROGRAM + (_MKL if solver == "pardiso" else 0.0) + (_NUMBA if kernels == "numba" else 0.0)
    return libraries + _PER_PAIR[kernels] * pairs + _PER_ENTRY[kernels] * entries


def contact_memory(scenario: Scenario, geometry: Geometry) -> dict[str, float]:
    """Roughly what neighbours within each body that may touch take [byte]: many where it is cut finely."""
    touching = {name for pair in named_pairs(scenario) for name in pair}
    found = {}
    for rod, properties in zip(geometry.rods, geometry.properties, strict=True):
        if rod.name in touching:
            edges = geometry.rod_edges[rod.name]
            reach = pi * float(np.mean(properties.radius))
            each = min(reach / float(geometry.lengths[edges].mean()), float(len(edges)))
            found[rod.name] = _PER_ROD_NEIGHBOUR * len(edges) * each
    for shell in geometry.shells:
        if shell.name in touching:
            triangles = geometry.triangles_of(shell.name)
            reach = 0.5 * pi * float(geometry.per_triangle("thickness")[triangles].mean())
            # half of the lines around each, three to two triangles
            each = 0.75 * min(pi * reach**2 / float(geometry.areas[triangles].mean()), float(len(triangles)))
            found[shell.name] = _PER_SHELL_NEIGHBOUR * 1.5 * len(triangles) * each
    return found


def rough_memory(edges: int, triangles: int, dimension: int) -> float:
    """Peak of a run [byte], within a factor of 3, from what is known before it is composed.

    Args:
        edges: Number of rod edges.
        triangles: Number of triangles.
        dimension: 2 for a planar scene.
    """
    return _PROGRAM + edges * (_PLANAR_EDGE if dimension == 2 else _EDGE) + triangles * _TRIANGLE


def refuse_too_many(loaded: LoadedScenario) -> None:
    """Refuse rods that this machine cannot hold before they are made.

    Raises:
        ScenarioError: pointing to the rod with the most nodes.
    """
    counts = [_declared(body) for body in loaded.scenario.geometry]
    needed, present = rough_memory(sum(counts), 0, loaded.scenario.dimension), machine_memory()
    if needed - _PROGRAM > present:  # the rods alone
        raise _too_large(loaded, counts, f"{sum(counts)} nodes of rods", needed, present)


def _declared(body: Rod | Shell) -> int:
    """Nodes that a rod is made with, 0 where that is not known yet."""
    match body:
        case Rod(generate=Line() | Arc() | Helix() as shape):
            return shape.nodes
        case _:
            return 0


def refuse_oversized(loaded: LoadedScenario, geometry: Geometry) -> None:
    """Refuse a scene that this machine cannot hold.

    Raises:
        ScenarioError: pointing to the body with the most elements, or with the most neighbours within it.
    """
    edges, triangles = len(geometry.edges), len(geometry.triangles)
    needed, present = rough_memory(edges, triangles, loaded.scenario.dimension), machine_memory()
    if needed > present:
        sizes = [len(geometry.body_nodes[body.name]) for body in loaded.scenario.geometry]
        raise _too_large(loaded, sizes, f"{edges} edges and {triangles} triangles", needed, present)
    neighbours = contact_memory(loaded.scenario, geometry)
    needed += sum(neighbours.values())
    if needed > present:
        shares = [neighbours.get(body.name, 0.0) for body in loaded.scenario.geometry]
        fine = loaded.scenario.geometry[shares.index(max(shares))].name
        what = f"contact of '{fine}', which is cut far finer than it is thick"
        raise _too_large(loaded, shares, what, needed, present)


def _too_large(
    loaded: LoadedScenario, sizes: Sequence[float], what: str, needed: float, present: float
) -> ScenarioError:
    return loaded.error(
        ("geometry", sizes.index(max(sizes))),
        f"the scene has {what}: a run takes about {needed / 1e9:.2g} GB of memory, "
        f"and this machine has {present / 1e9:.2g} GB; make the mesh coarser",
    )


def machine_memory() -> float:
    """Memory that this process may have [byte]; infinite if the system does not say."""
    limits = [float("inf")]
    with suppress(OSError, ValueError, AttributeError):
        limits.append(float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")))
    with suppress(OSError, ValueError):  # "max" where a container has no limit
        limits.append(float(_CGROUP_LIMIT.read_text(encoding="ascii")))
    return min(limits)
