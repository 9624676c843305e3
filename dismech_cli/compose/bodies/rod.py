"""One rod of the scenario: its mesh and its section."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ...arrays import IntArray
from ...csv_columns import read_columns
from ...errors import MeshError
from ...mesh.allowed import Allowed
from ...mesh.generate import curves as generate
from ...mesh.generate.polyline import polyline
from ...mesh.mesh import Mesh
from ...mesh.validate import validate
from ...scenario.language.geometry import MeshFile, Rod
from ...scenario.language.shape import Arc, CsvCurve, Helix, Line, Polyline
from .mesh import BodyMesh, part_of_file
from .placement import placement_of


def rod_mesh(rod: Rod, directory: Path) -> BodyMesh:
    """Generate or read the centreline.

    Raises:
        MeshError: The mesh is unusable.
    """
    if rod.mesh is not None:
        return _read(rod.mesh, directory)
    return BodyMesh(_generated(rod, directory))


def with_ends(mesh: Mesh) -> dict[str, IntArray]:
    """Node groups, with ``start`` and ``end`` of a single open chain from a file too."""
    groups = dict(mesh.node_groups)
    degree = np.bincount(mesh.edges.reshape(-1), minlength=len(mesh.nodes))
    ends = np.flatnonzero(degree == 1)
    if len(ends) == 2 and degree.max() == 2:
        groups.setdefault("start", ends[:1])
        groups.setdefault("end", ends[1:])
    return groups


def _read(source: MeshFile, directory: Path) -> BodyMesh:
    from ...mesh.files.read import read_mesh

    path = directory / source.file
    # What its shells are is theirs to say.
    allowed = Allowed(weld=source.weld / source.scale, slits=source.slits == "open", branches=True)
    mesh = read_mesh(path, allowed)
    if source.group is not None and source.group not in mesh.edge_groups:
        known = ", ".join(sorted(mesh.edge_groups)) or "none"
        raise MeshError(f"{source.file} has no group of lines '{source.group}'; it has: {known}")
    if len(mesh.edges) == 0:
        raise MeshError(f"{source.file} has no lines; a rod needs some")
    chosen = np.arange(len(mesh.edges)) if source.group is None else mesh.edge_groups[source.group]
    none = np.empty(0, dtype=np.int64)
    part = part_of_file(mesh, path, placement_of(source), chosen, none)
    return replace(part, mesh=validate(part.mesh, source.file))


def _generated(rod: Rod, directory: Path) -> Mesh:
    match rod.generate:
        case Line() as s:
            return generate.line(s.start, s.end, s.nodes)
        case Arc() as s:
            return generate.arc(s.center, s.radius, s.normal, s.start, s.angle, s.nodes, closed=s.closed)
        case Helix() as s:
            return generate.helix(
                s.origin, s.axis, s.radius, s.pitch, s.turns, s.nodes, handedness=s.handedness, phase=s.phase
            )
        case Polyline() as s:
            return polyline(s.points, nodes=s.nodes, spacing=s.spacing, closed=s.closed)
        case CsvCurve() as s:
            path = directory / s.file
            points = np.stack(read_columns(path, s.columns), axis=1)
            return polyline(points, closed=s.closed, where=str(path))
        case None:
            raise AssertionError("the schema asks for generate or mesh")
