"""One door to all mesh file formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from ...errors import MeshError
from ..mesh import Mesh
from .gmsh import read_gmsh
from .obj import read_obj
from .stl import read_stl
from .text import read_text

READERS: Mapping[str, Callable[[Path, float], Mesh]] = {
    ".msh": read_gmsh,
    ".obj": read_obj,
    ".txt": read_text,
    ".stl": read_stl,
}
"""Reader of each file suffix."""


def read_mesh(path: Path, weld: float = 0.0) -> Mesh:
    """Read and validate a mesh file; its suffix decides the format.

    Args:
        path: A ``.msh`` (gmsh 2.2 or 4.1), ``.obj``, ``.stl`` or ``.txt`` (DiSMech) file, in metres.
        weld: Nodes up to this distance from each other become one [length unit of the file].

    Returns:
        The mesh, consistently wound, with ``notes`` on everything that was changed.

    Raises:
        MeshError: If the suffix is unknown, the file cannot be read, or the mesh is unusable.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshError(f"{path}: unknown mesh format {path.suffix!r}; expected {', '.join(READERS)}")
    return reader(path, weld)
