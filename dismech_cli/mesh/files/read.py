"""One door to all mesh file formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from ...errors import MeshError
from ..allowed import PLAIN, Allowed
from ..mesh import Mesh
from .gmsh import read_gmsh
from .obj import read_obj
from .stl import read_stl
from .text import read_text

READERS: Mapping[str, Callable[[Path, Allowed], Mesh]] = {
    ".msh": read_gmsh,
    ".obj": read_obj,
    ".txt": read_text,
    ".stl": read_stl,
}
"""Reader of each file suffix."""


def read_mesh(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read and validate a mesh file; its suffix decides the format.

    Args:
        path: A ``.msh`` (gmsh 2.2 or 4.1), ``.obj``, ``.stl`` or ``.txt`` (DiSMech) file, in metres.
        allowed: What the mesh may be beyond a plain surface.

    Returns:
        The mesh, consistently wound, with ``notes`` on everything that was changed.

    Raises:
        MeshError: If the suffix is unknown, the file cannot be read, or the mesh is unusable.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshError(f"{path}: unknown mesh format {path.suffix!r}; expected {', '.join(READERS)}")
    return reader(path, allowed)
