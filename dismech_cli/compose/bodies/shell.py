"""One shell of the scenario: its mesh and its material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Protocol

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...errors import MeshError
from ...frozen import frozen
from ...mesh.allowed import Allowed
from ...mesh.generate import curved as generate_curved
from ...mesh.generate import rings as generate_rings
from ...mesh.generate.icosphere import icosphere
from ...mesh.generate.sheets import Pattern, sheet
from ...mesh.mesh import Mesh
from ...mesh.slivers import refuse_slivers
from ...mesh.topology.closed import inward_surfaces
from ...mesh.topology.orient import reverse
from ...mesh.topology.sides import rim_sides, side_counts
from ...mesh.topology.slits import on_each_other
from ...scenario.language.geometry import Shell, SurfaceFile
from ...scenario.language.material import Material
from ...scenario.language.surface import (
    AnnulusSurface,
    CylinderSurface,
    DiscSurface,
    HemisphereSurface,
    IcosphereSurface,
    SheetSurface,
    SphereSurface,
    Surface,
)
from ...scenario.text.tree import KeyPath
from .mesh import BodyMesh, part_of_file
from .placement import placement_of
from .varying import Sampler


@frozen
class ShellProperties:
    """An isotropic sheet.

    Attributes:
        youngs_modulus: E of each triangle [Pa], shape (T,).
        poisson_ratio: nu [1].
        thickness: h of each triangle [m], shape (T,).
        mass_per_area: rho h of each triangle [kg/m^2], shape (T,).
        model: How its material stretches.
        relaxation_time: tau of its material [s].
    """

    youngs_modulus: FloatArray
    poisson_ratio: float
    thickness: FloatArray
    mass_per_area: FloatArray
    model: str
    relaxation_time: float


def shell_properties(shell: Shell, path: KeyPath, material: Material, sample: Sampler) -> ShellProperties:
    """Stiffness and inertia of the triangles of a shell.

    Args:
        shell: As in the scenario.
        path: Its key path.
        material: Its material.
        sample: Reads values on its triangles.

    Raises:
        ScenarioError: A value that varies is wrong somewhere on the shell.
    """
    mean, of_material = sample.cells.mean, ("materials", shell.material)
    thickness = sample(shell.thickness, (*path, "thickness"), "length")
    density = sample(material.density, (*of_material, "density"), "density")
    modulus = sample(material.youngs_modulus, (*of_material, "youngs_modulus"), "pressure")
    return ShellProperties(
        mean(modulus),
        material.poisson_ratio,
        mean(thickness),
        mean(density * thickness),
        material.model,
        material.relaxation_time,
    )


class Source(Protocol):
    """Where a surface comes from: one of both."""

    @property
    def generate(self) -> Surface | None:
        """It is generated."""

    @property
    def mesh(self) -> SurfaceFile | None:
        """It is read from a file."""


def shell_mesh(shell: Source, directory: Path) -> BodyMesh:
    """Generate or read the surface; its rims are the group ``boundary``, lips of slits the group ``slits``.

    Raises:
        MeshError: The mesh is unusable.
    """
    body = _read(shell.mesh, directory) if shell.mesh is not None else BodyMesh(_generated(shell))
    refuse_slivers(body.mesh.nodes, body.mesh.triangles)
    rim = rim_sides(body.mesh.triangles)
    groups, notes = dict(body.mesh.node_groups), body.mesh.notes
    if shell.mesh is not None and shell.mesh.slits == "open":
        lips = on_each_other(body.mesh.nodes, rim)
        groups.update(_named("slits", rim[lips]))
        rim = rim[~lips]
        if not lips.any():
            notes = (*notes, "No rims lie on each other: there is no slit to open.")
    groups.update(_named("boundary", rim))
    return replace(body, mesh=replace(body.mesh, node_groups=groups, notes=notes))


def _named(name: str, sides: IntArray) -> dict[str, IntArray]:
    """The group of the nodes of sides, if there are any."""
    return {name: distinct(sides)} if sides.size else {}


def _read(source: SurfaceFile, directory: Path) -> BodyMesh:
    from ...mesh.files.read import read_mesh

    path = directory / source.file
    allowed = Allowed(
        weld=source.weld / source.scale, slits=source.slits == "open", branches=source.branches != "refuse"
    )
    mesh = read_mesh(path, allowed)
    if source.group is not None and source.group not in mesh.triangle_groups:
        known = ", ".join(sorted(mesh.triangle_groups)) or "none"
        raise MeshError(f"{source.file} has no group of triangles '{source.group}'; it has: {known}")
    if len(mesh.triangles) == 0:
        raise MeshError(f"{source.file} has no triangles; a shell needs some")
    chosen = np.arange(len(mesh.triangles)) if source.group is None else mesh.triangle_groups[source.group]
    part = part_of_file(mesh, path, placement_of(source), np.empty(0, dtype=np.int64), chosen)
    triangles = part.mesh.triangles
    if source.flip:
        triangles = reverse(triangles, np.ones(len(triangles), dtype=np.bool_))
    notes = part.mesh.notes
    branched = bool((side_counts(triangles) > 2).any())
    if not branched and (inward := inward_surfaces(part.mesh.nodes, triangles)) > 0:
        closed = "closed surface" if inward == 1 else f"{inward} closed surfaces"
        how = "false" if source.flip else "true"
        notes = (
            *notes,
            f"Normals of the {closed} point inward, as pressure acts; 'flip: {how}' turns them.",
        )
    return replace(part, mesh=replace(part.mesh, triangles=triangles, notes=notes))


def _generated(shell: Source) -> Mesh:
    match shell.generate:
        case SheetSurface() as s:
            mesh = sheet(s.length, s.width, s.divisions, Pattern(s.pattern))
            return _placed(mesh, s.origin, _spanned(s.axes))
        case DiscSurface() as s:
            mesh = generate_rings.disc(s.radius, s.rings, counts=s.counts)
            return _placed(mesh, s.center, _about(s.normal))
        case AnnulusSurface() as s:
            mesh = generate_rings.annulus(s.inner_radius, s.outer_radius, s.rings, counts=s.counts)
            return _placed(mesh, s.center, _about(s.normal))
        case HemisphereSurface() as s:
            rings = len(s.polar_angles or ()) or s.rings or 1
            mesh = generate_rings.hemisphere(s.radius, rings, polar_angles=s.polar_angles, counts=s.counts)
            return _placed(mesh, s.center, _about(s.axis))
        case CylinderSurface() as s:
            mesh = generate_curved.cylinder(s.radius, s.length, s.angle, s.divisions, Pattern(s.pattern))
            return _placed(mesh, s.origin, _started(s.axis, s.start))
        case SphereSurface() as s:
            first, last = s.polar
            pattern = Pattern(s.pattern)
            mesh = generate_curved.sphere(s.radius, (first, last), s.angle, s.divisions, pattern)
            return _placed(mesh, s.center, _started(s.axis, s.start))
        case IcosphereSurface() as s:
            return _placed(icosphere(s.radius, s.divisions), s.center, _started(s.axis, s.start))
        case None:
            raise AssertionError("the schema asks for generate or mesh")


def _placed(mesh: Mesh, origin: Sequence[float], axes: FloatArray) -> Mesh:
    """Turn a mesh from the space axes to ``axes`` (rows) and move it."""
    return replace(mesh, nodes=mesh.nodes @ axes + np.array(origin))


def _spanned(axes: Sequence[Sequence[float]]) -> FloatArray:
    """Right-handed axes: the first given, the second made normal to it."""
    first, second = (np.array(axis, dtype=np.float64) for axis in axes)
    first /= np.linalg.norm(first)
    second -= (second @ first) * first
    second /= np.linalg.norm(second)
    return np.stack((first, second, np.cross(first, second)))


def _started(axis: Sequence[float], start: Sequence[float]) -> FloatArray:
    """Right-handed axes: the third given, the first made normal to it."""
    third, first, second = _spanned((axis, start))
    return np.stack((first, second, third))


def _about(normal: Sequence[float]) -> FloatArray:
    """Axes with a given third one: x and y turned by the shortest way, half a turn about x for -z."""
    n = np.array(normal, dtype=np.float64)
    n /= np.linalg.norm(n)
    if n[2] < -1.0 + 1e-12:
        return np.diag((1.0, -1.0, -1.0))
    x, y, z = n
    w = 1.0 / (1.0 + z)
    return np.array([[1.0 - x * x * w, -x * y * w, -x], [-x * y * w, 1.0 - y * y * w, -y], [x, y, z]])
