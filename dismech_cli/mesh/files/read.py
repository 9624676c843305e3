"""One door to all mesh file formats."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from ...errors import MeshError
from ..allowed import PLAIN, Allowed
from ..mesh import Mesh
from .gmsh import read_gmsh
from .obj import read_obj
from .off import read_off
from .ply import read_ply
from .stl import read_stl
from .text import read_text
from .vtk_legacy import read_vtk_legacy
from .vtk_xml import read_vtk_xml

READERS: Mapping[str, Callable[[Path, Allowed], Mesh]] = {
    ".msh": read_gmsh,
    ".obj": read_obj,
    ".txt": read_text,
    ".stl": read_stl,
    ".ply": read_ply,
    ".off": read_off,
    ".vtk": read_vtk_legacy,
    ".vtu": read_vtk_xml,
    ".vtp": read_vtk_xml,
}
"""Reader of each file suffix."""


def read_mesh(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read and validate a mesh file; its suffix decides the format.

    Args:
        path: A mesh file, in metres.
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
