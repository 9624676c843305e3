"""Output fields of the scenario, and the topology that writers need."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias, get_args

import numpy as np

from ...arrays import FloatArray, IntArray
from ...kinematics.rod_frames import RodFrames
from ...output.frame import Topology
from ...run.observables.corners import CornerStrains, NoCorners
from ...run.observables.rod_fields import (
    AxialForceField,
    AxialStrainField,
    BinormalCurvatures,
    CurvatureField,
    Curvatures,
    DirectorField,
    DisplacementField,
    Field,
    MaterialCurvatures,
    MomentField,
    NoCurvatures,
    TwistField,
    VelocityField,
)
from ...run.observables.shell_fields import AmongCells, AreaStrainField, BendingEnergyField
from ...run.observables.touch_fields import ContactForceField, LineLoadField, PressureField
from ...scenario.language.render import ShellField
from ..elastic.planar import PLANAR_AXIS
from ..elastic.rods import RodEnergies
from ..elastic.seams import SEAMS
from ..scene import Scene
from ..shells.bending import bending_of
from ..structure.plan import Bending
from ..structure.structure import Structure

Maker: TypeAlias = Callable[[Scene, Structure, RodEnergies], Field]


def make_fields(scene: Scene, structure: Structure, rods: RodEnergies) -> tuple[Field, ...]:
    """The fields asked for; positions are part of every frame anyway."""
    names = [name for name in scene.scenario.output.fields if name != "positions"]
    return tuple(_everywhere(scene, FIELDS[name](scene, structure, rods), name) for name in names)


def _everywhere(scene: Scene, field: Field, name: str) -> Field:
    """The field with zeros on the cells that it does not know."""
    edges, triangles = len(scene.geometry.edges), len(scene.geometry.triangles)
    if field.spec.location == "node":
        return field
    if name in get_args(ShellField):
        return AmongCells(field, edges, 0) if edges else field
    return AmongCells(field, 0, triangles) if triangles else field


def make_topology(
    scene: Scene, structure: Structure, fields: tuple[Field, ...], scalars: dict[str, str]
) -> Topology:
    """What writers need to know once."""
    geometry = scene.geometry
    n = structure.dofs.n
    return Topology(
        rest_positions=geometry.nodes,
        edges=geometry.edges,
        triangles=geometry.triangles,
        edge_radius=geometry.per_edge("radius"),
        triangle_thickness=geometry.per_triangle("thickness"),
        bodies=tuple(geometry.body_nodes),
        edge_body=np.array(geometry.rod_keys, dtype=np.int64)[geometry.edge_rod],
        triangle_body=np.array(geometry.shell_keys, dtype=np.int64)[geometry.triangle_shell],
        fields=tuple(field.spec for field in fields),
        state={"q": ((n,), "m, rad"), "v": ((n,), "m/s, rad/s")},
        scalars=scalars,
    )


def _velocity(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    return VelocityField(len(scene.geometry.nodes))


def _displacement(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    return DisplacementField(scene.geometry.nodes)


def _curvature(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    joints = structure.skeleton.joints
    return CurvatureField(len(scene.geometry.nodes), joints.triples, joints.voronoi, _corners(rods))


def _twist(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    joints, dofs = structure.skeleton.joints, structure.dofs
    if structure.plan.bending is not Bending.FRAMED:
        # a planar rod has no twist: an empty list of joints reports zero everywhere
        empty = np.empty((0, 2), dtype=np.int64)
        nothing = (empty[:, 0], np.empty(0), empty, np.empty((0, 2)), NoCorners())
        return TwistField(len(scene.geometry.nodes), *nothing)
    return TwistField(
        len(scene.geometry.nodes),
        joints.triples[:, 1],
        joints.voronoi,
        dofs.of_angles(joints.pairs),
        joints.signs,
        _corners(rods),
    )


def _axial_strain(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    edges = scene.geometry.edges
    return AxialStrainField(edges, structure.skeleton.rest_lengths[: len(edges)])


def _axial_force(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    assert rods.stretch is not None
    constants = rods.stretch.parameters[len(rods.stretch.kernel.naturals) :]
    return AxialForceField(scene.geometry.edges, rods.axial, constants, rods.stretch.name)


def _bending_moment(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    joints = structure.skeleton.joints
    measure = _curvatures(structure, rods)
    return MomentField(len(scene.geometry.nodes), joints.triples, joints.voronoi, measure, _corners(rods))


def _corners(rods: RodEnergies) -> CornerStrains:
    return NoCorners() if rods.corners is None else rods.corners.strains


def _curvatures(structure: Structure, rods: RodEnergies) -> Curvatures:
    triples, bending = structure.skeleton.joints.triples, rods.bending
    if bending is None:
        return NoCurvatures()
    if structure.plan.bending is Bending.FRAMED:
        return MaterialCurvatures(
            triples,
            rods.bending_stiffness,
            bending.name,
            rods.directors,
            structure.dofs.of_angles(structure.skeleton.joints.pairs),
            structure.skeleton.joints.signs,
            bending.parameter("psi"),
        )
    normal = np.array(PLANAR_AXIS[structure.plan.axes]) if structure.plan.bending is Bending.PLANAR else None
    return BinormalCurvatures(triples, bending.parameter("EI"), bending.name, normal)


def _director(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    frames = structure.rod_frames
    assert isinstance(frames, RodFrames)
    return DirectorField(frames.director_places(np.arange(len(scene.geometry.edges)))[:, :3])


def _area_strain(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    return AreaStrainField(scene.geometry.triangles, scene.geometry.areas)


def _bending_energy_density(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    geometry = scene.geometry
    shares = []
    for name, body in structure.shell_edges.bodies.items():
        own = geometry.triangles_of(name)
        at_hinges = bending_of(body.shell).at_hinges
        faces = own[body.topology.hinge_faces] if at_hinges else own[:, None]
        shares.append((f"{name}.bending", _shared(faces, geometry.areas)))
    if len(structure.shell_edges.seams.faces):
        shares.append((SEAMS, _shared(structure.shell_edges.seams.faces, geometry.areas)))
    return BendingEnergyField(tuple(shares))


def _contact_force(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    return ContactForceField(len(scene.geometry.nodes))


def _contact_line_load(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    geometry = scene.geometry
    return LineLoadField(geometry.edges, _dealt(geometry.edges, geometry.lengths, len(geometry.nodes)))


def _contact_pressure(scene: Scene, structure: Structure, rods: RodEnergies) -> Field:
    geometry = scene.geometry
    return PressureField(_dealt(geometry.triangles, geometry.areas, len(geometry.nodes)))


def _dealt(cells: IntArray, sizes: FloatArray, count: int) -> FloatArray:
    """Sizes of cells in equal parts to their nodes, shape (count,)."""
    out = np.zeros(count)
    np.add.at(out, cells, sizes[:, None] / cells.shape[1])
    return out


def _shared(faces: IntArray, areas: FloatArray) -> Any:
    """Sparse matrix (T, S) from energies of stencils to energies per area, in equal parts.

    Args:
        faces: Triangles of each stencil, shape (S, m).
        areas: Of all triangles [m^2], shape (T,).
    """
    from scipy.sparse import csr_array

    count, parts = faces.shape
    rows, stencils = faces.reshape(-1), np.repeat(np.arange(count), parts)
    return csr_array((1.0 / parts / areas[rows], (rows, stencils)), shape=(len(areas), count))


FIELDS: dict[str, Maker] = {
    "velocity": _velocity,
    "displacement": _displacement,
    "curvature": _curvature,
    "twist": _twist,
    "axial_strain": _axial_strain,
    "axial_force": _axial_force,
    "bending_moment": _bending_moment,
    "director": _director,
    "area_strain": _area_strain,
    "bending_energy_density": _bending_energy_density,
    "contact_force": _contact_force,
    "contact_line_load": _contact_line_load,
    "contact_pressure": _contact_pressure,
}
