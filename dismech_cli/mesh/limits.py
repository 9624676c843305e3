"""How large a mesh may be."""

from __future__ import annotations

from ..errors import MeshError

MAX_COUNT = 2_000_000
"""Largest number of nodes, edges or triangles of one mesh."""

MAX_GENERATED = 500_000
"""Largest number of triangles of a generated surface; a run of more takes over 10 GB."""

MAX_COORDINATE = 1e12
"""Largest coordinate [m]; beyond it, products of coordinates lose all meaning."""


def check_count(count: int, what: str, where: str) -> int:
    """Return ``count`` if a mesh may have that many, before anything is allocated for it.

    Raises:
        MeshError: If the count is negative or above :data:`MAX_COUNT`.
    """
    if not 0 <= count <= MAX_COUNT:
        raise MeshError(f"{where}: {count} {what}; a mesh may have 0 to {MAX_COUNT}")
    return count
