"""What a scene would hold in memory, estimated before anything large is made of it."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Final

from ..errors import ScenarioError
from ..scenario.load import LoadedScenario
from .bodies.geometry import Geometry

# Peaks of whole runs over that of a tiny one, by the edge and the triangle: matrix, factors, slot tables.
_PROGRAM: Final = 100e6  # bytes of Python with its libraries
_PLANAR_EDGE, _EDGE = 4e3, 10e3  # bytes; framed bending, the dearest
_TRIANGLE: Final = 22e3  # bytes; hinges, the dearest
_CGROUP_LIMIT: Final = Path("/sys/fs/cgroup/memory.max")


def memory(edges: int, triangles: int, dimension: int) -> float:
    """Rough peak of a run [byte].

    Args:
        edges: Number of rod edges.
        triangles: Number of triangles.
        dimension: 2 for a planar scene.
    """
    return _PROGRAM + edges * (_PLANAR_EDGE if dimension == 2 else _EDGE) + triangles * _TRIANGLE


def refuse_oversized(loaded: LoadedScenario, geometry: Geometry) -> None:
    """Refuse a scene that this machine cannot hold.

    Raises:
        ScenarioError: pointing to the body with the most elements.
    """
    edges, triangles = len(geometry.edges), len(geometry.triangles)
    needed, present = memory(edges, triangles, loaded.scenario.dimension), machine_memory()
    if needed > present:
        raise _oversized(loaded, geometry, f"{edges} edges and {triangles} triangles", needed, present)


def _oversized(
    loaded: LoadedScenario, geometry: Geometry, what: str, needed: float, present: float
) -> ScenarioError:
    sizes = [len(geometry.body_nodes[body.name]) for body in loaded.scenario.geometry]
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
