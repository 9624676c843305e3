"""Output fields of the scenario, and the topology that writers need."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import get_args

import numpy as np

from ...kinematics.dofs import DofMap
from ...kinematics.rod_frames import RodFrames
from ...output.frame import Topology
from ...run.observables import rod_fields as made
from ...run.observables.shell_fields import AmongCells, AreaStrainField, BendingEnergyField
from ...scenario.language.output import ShellField
from ...scenario.load import LoadedScenario
from ..bodies.geometry import Geometry
from ..elastic.rods import PLANAR_AXIS, RodSystem
from ..shells.bending import bending_of
from ..shells.topology import ShellEdges
from ..structure.plan import Bending, Plan
from ..structure.skeleton import Skeleton


@dataclass(frozen=True, slots=True)
class Scene:
    """What field makers may look at."""

    geometry: Geometry
    plan: Plan
    skeleton: Skeleton
    dofs: DofMap
    rods: RodSystem
    free: ShellEdges


def build_fields(loaded: LoadedScenario, scene: Scene) -> tuple[made.Field, ...]:
    """The fields asked for; positions are part of every frame anyway."""
    names = [name for name in loaded.scenario.output.fields if name != "positions"]
    return tuple(_everywhere(scene, FIELDS[name](scene), name) for name in names)


def _everywhere(scene: Scene, field: made.Field, name: str) -> made.Field:
    """The field with zeros on the cells that it does not know."""
    edges, triangles = len(scene.geometry.edges), len(scene.geometry.triangles)
    if field.spec.location == "node":
        return field
    if name in get_args(ShellField):
        return AmongCells(field, edges, 0) if edges else field
    return AmongCells(field, 0, triangles) if triangles else field


def build_topology(scene: Scene, fields: tuple[made.Field, ...], scalars: dict[str, str]) -> Topology:
    """What writers need to know once."""
    geometry = scene.geometry
    n = scene.dofs.n
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


def _velocity(scene: Scene) -> made.Field:
    return made.VelocityField(len(scene.geometry.nodes))


def _curvature(scene: Scene) -> made.Field:
    joints = scene.skeleton.joints
    return made.CurvatureField(len(scene.geometry.nodes), joints.triples, joints.voronoi)


def _twist(scene: Scene) -> made.Field:
    joints, dofs = scene.skeleton.joints, scene.dofs
    if scene.plan.bending is not Bending.FRAMED:
        # a planar rod has no twist: an empty list of joints reports zero everywhere
        empty = np.empty((0, 2), dtype=np.int64)
        return made.TwistField(len(scene.geometry.nodes), empty[:, 0], np.empty(0), empty, np.empty((0, 2)))
    return made.TwistField(
        len(scene.geometry.nodes),
        joints.triples[:, 1],
        joints.voronoi,
        dofs.of_angles(joints.pairs),
        joints.signs,
    )


def _axial_strain(scene: Scene) -> made.Field:
    edges = scene.geometry.edges
    return made.AxialStrainField(edges, scene.skeleton.rest_lengths[: len(edges)])


def _axial_force(scene: Scene) -> made.Field:
    assert scene.rods.stretch is not None
    _, stiffness, rest = scene.rods.stretch.parameters
    return made.AxialForceField(scene.geometry.edges, rest, stiffness, scene.rods.stretch.name)


def _bending_moment(scene: Scene) -> made.Field:
    joints = scene.skeleton.joints
    measure = _curvatures(scene)
    return made.MomentField(len(scene.geometry.nodes), joints.triples, joints.voronoi, measure)


def _curvatures(scene: Scene) -> made.Curvatures:
    triples, bending = scene.skeleton.joints.triples, scene.rods.bending
    if bending is None:
        return made.NoCurvatures()
    if scene.plan.bending is Bending.FRAMED:
        *_, cosine, sine = bending.parameters
        return made.MaterialCurvatures(
            triples,
            scene.rods.bending_stiffness,
            bending.name,
            scene.rods.auxiliary_indices,
            scene.skeleton.joints.signs,
            np.arctan2(sine, cosine),
        )
    normal = np.array(PLANAR_AXIS[scene.plan.axes]) if scene.plan.bending is Bending.PLANAR else None
    *_, stiffness, _ = bending.parameters
    return made.BinormalCurvatures(triples, stiffness, bending.name, normal)


def _director(scene: Scene) -> made.Field:
    frames = scene.rods.frames
    assert isinstance(frames, RodFrames)
    return made.DirectorField(frames.director_places(np.arange(len(scene.geometry.edges)))[:, :3])


def _area_strain(scene: Scene) -> made.Field:
    return AreaStrainField(scene.geometry.triangles, scene.geometry.areas)


def _bending_energy_density(scene: Scene) -> made.Field:
    from scipy.sparse import csr_array

    geometry = scene.geometry
    areas = geometry.areas
    shares = []
    for shell in geometry.shells:
        own = geometry.triangles_of(shell.name)
        if bending_of(shell).at_hinges:
            faces = own[scene.free.topologies[shell.name].hinge_faces]
            stencils, weight = np.repeat(np.arange(len(faces)), 2), 0.5
        else:
            faces, stencils, weight = own, np.arange(len(own)), 1.0
        rows = faces.reshape(-1)
        matrix = csr_array(
            (weight / areas[rows], (rows, stencils)), shape=(len(areas), int(stencils.max(initial=-1)) + 1)
        )
        shares.append((f"{shell.name}.bending", matrix))
    return BendingEnergyField(tuple(shares))


FIELDS: dict[str, Callable[[Scene], made.Field]] = {
    "velocity": _velocity,
    "curvature": _curvature,
    "twist": _twist,
    "axial_strain": _axial_strain,
    "axial_force": _axial_force,
    "bending_moment": _bending_moment,
    "director": _director,
    "area_strain": _area_strain,
    "bending_energy_density": _bending_energy_density,
}
