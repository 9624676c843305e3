"""Rods as DOFs, frames and elastic energies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray, IntArray
from ...energies.bend_isotropic import BEND_ISOTROPIC
from ...energies.bend_planar import BEND_PLANAR
from ...energies.bend_twist import BEND_TWIST
from ...energies.stretch import STRETCH, STRETCH_PLANAR
from ...kernels.driver import Driver
from ...kinematics.directors import space_parallel
from ...kinematics.dofs import DofMap
from ...kinematics.rod_frames import Frames, NoFrames, RodFrames
from ...kinematics.strains import material_curvatures, planar_curvature
from ...model.stencil import StencilEnergy, no_auxiliaries
from ...scenario.load import LoadedScenario
from ..bodies.geometry import Geometry
from ..structure.numbering import Numbering
from ..structure.plan import Bending, Plan
from ..structure.skeleton import Joints, Skeleton

PLANAR_AXIS: dict[tuple[int, ...], tuple[float, float, float]] = {
    (0, 2): (0.0, -1.0, 0.0),
    (0, 1): (0.0, 0.0, 1.0),
    (1, 2): (1.0, 0.0, 0.0),
}


@dataclass(frozen=True, slots=True)
class RodSystem:
    """What the rods give to the model.

    Attributes:
        frames: Frames, or their absence.
        stretch: Stretching energy of the geometry's edges, or None without rods.
        bending: Bending energy of the joints, with that of twisting where rods are framed; None
            without joints.
        bending_stiffness: EI1 and EI2 of each joint [N m^2], shape (2, J).
        in_plane: Planar scenes: which natural curvature (0 or 1) lies in the plane, and its sign,
            per rod, shape (rods, 2).
        auxiliary_indices: Framed scenes: places of the directors, shape (J, 12).
    """

    frames: Frames
    stretch: StencilEnergy | None
    bending: StencilEnergy | None
    bending_stiffness: FloatArray
    in_plane: IntArray
    auxiliary_indices: IntArray


def build_rods(
    loaded: LoadedScenario,
    geometry: Geometry,
    plan: Plan,
    skeleton: Skeleton,
    numbering: Numbering,
    driver: Driver,
) -> RodSystem:
    """Make the frames and energies of all rods.

    Raises:
        ScenarioError: A section or a list of natural strains does not fit.
    """
    if plan.bending is Bending.NONE:
        return RodSystem(
            NoFrames(),
            None,
            None,
            np.empty((2, 0)),
            np.empty((0, 2), dtype=np.int64),
            np.empty((0, 12), dtype=np.int64),
        )
    dofs, rest = numbering.dofs, numbering.rest
    joints = skeleton.joints
    given = _given_directors(loaded, geometry, skeleton)
    in_plane = np.zeros((len(geometry.rods), 2), dtype=np.int64)
    stiffness = np.stack([_in_series(geometry, skeleton, name) for name in ("bending_1", "bending_2")])
    frames: Frames = NoFrames()
    bending, places = None, np.empty((0, 12), dtype=np.int64)
    if plan.bending is Bending.FRAMED:
        frames = turning = _rod_frames(skeleton, dofs, _directors(skeleton, given), driver)
        if len(joints.triples):
            bending, places = _framed(loaded, geometry, skeleton, dofs, rest, stiffness, turning)
    elif plan.bending is Bending.PLANAR:
        in_plane = _in_plane(loaded, geometry, plan, _directors(skeleton, given))
        if len(joints.triples):
            bending = _planar(loaded, geometry, skeleton, dofs, rest, stiffness, in_plane)
    elif len(joints.triples):
        bending = StencilEnergy(
            "bending",
            BEND_ISOTROPIC,
            _node_dofs(dofs, joints.triples),
            np.stack((stiffness[0], joints.voronoi)),
            no_auxiliaries(len(joints.triples)),
        )
    return RodSystem(
        frames,
        _stretch(loaded, geometry, skeleton, dofs),
        bending,
        stiffness,
        in_plane,
        places,
    )


def natural_density(
    loaded: LoadedScenario, geometry: Geometry, index: int, name: str, joints: Joints
) -> FloatArray | None:
    """Natural strain per length that the user gives the joints of a rod, or None; shape (J_rod,)."""
    value = getattr(geometry.rods[index].natural, name)
    if value is None:
        return None
    members = np.flatnonzero(joints.rod == index)
    if isinstance(value, float):
        return np.full(len(members), value)
    count = int(joints.number[members].max(initial=-1)) + 1
    if len(value) != count:
        raise loaded.error(
            ("geometry", geometry.rod_keys[index], "natural", name),
            f"{len(value)} values for {count} joints; expected one per joint",
        )
    return np.array(value)[joints.number[members]]


def _node_dofs(dofs: DofMap, nodes: IntArray) -> IntArray:
    return dofs.of_nodes(nodes).reshape(len(nodes), -1)


def _in_series(geometry: Geometry, skeleton: Skeleton, name: str) -> FloatArray:
    """Stiffness of each joint: the two half edges bend or twist in series; 0 where it is released."""
    j = skeleton.joints
    per_edge = geometry.per_edge(name)
    per_edge = np.concatenate((per_edge, per_edge[skeleton.owners]))
    k = per_edge[j.pairs]
    same = k[:, 0] == k[:, 1]
    half = 0.5 * skeleton.rest_lengths[j.pairs]
    series = half.sum(axis=1) / (half / k).sum(axis=1)
    what = "twist" if name == "torsional" else "bending"
    loose = (j.rod < 0) & np.isin(j.triples[:, 1], geometry.released[what])
    loose |= np.isin(j.triples[:, 1], geometry.loosened[what])
    return np.where(loose, 0.0, np.where(same, k[:, 0], series))


def _stretch(loaded: LoadedScenario, geometry: Geometry, skeleton: Skeleton, dofs: DofMap) -> StencilEnergy:
    edges = geometry.edges
    natural = np.zeros(len(edges))
    for rod in geometry.rods:
        if rod.natural.stretch is not None:
            natural[geometry.rod_edges[rod.name]] = rod.natural.stretch
    rest = skeleton.rest_lengths[: len(edges)]
    kernel = STRETCH_PLANAR if dofs.dimension == 2 else STRETCH
    return StencilEnergy(
        "stretch",
        kernel,
        _node_dofs(dofs, edges),
        np.stack((natural, geometry.per_edge("axial"), rest)),
        no_auxiliaries(len(edges)),
    )


def _rod_frames(skeleton: Skeleton, dofs: DofMap, directors: FloatArray, driver: Driver) -> RodFrames:
    """Frames of all edges: a wall has the director of its rod."""
    return RodFrames(
        np.ascontiguousarray(dofs.of_nodes(skeleton.edges[:, 0]).T),
        np.ascontiguousarray(dofs.of_nodes(skeleton.edges[:, 1]).T),
        dofs.of_angles(np.arange(len(skeleton.edges))),
        skeleton.joints.pairs,
        skeleton.joints.signs,
        np.concatenate((directors, directors[:, skeleton.owners]), axis=1),
        driver,
    )


def _given_directors(loaded: LoadedScenario, geometry: Geometry, skeleton: Skeleton) -> FloatArray:
    """First material directors that the user gives, NaN elsewhere, shape (3, E)."""
    tangents = _tangents(skeleton)
    given = np.full((3, len(geometry.edges)), np.nan)
    for rod, key in zip(geometry.rods, geometry.rod_keys, strict=True):
        if rod.director is not None:
            first = geometry.rod_edges[rod.name][0]
            across = np.linalg.norm(np.cross(tangents[:, first], rod.director))
            if across < 1e-6 * np.linalg.norm(rod.director):
                raise loaded.error(
                    ("geometry", key, "director"),
                    "lies along the first edge of the rod; expected a direction across it",
                )
            given[:, first] = rod.director
    return given


def _directors(skeleton: Skeleton, given: FloatArray) -> FloatArray:
    """First material directors of the geometry's edges at rest, shape (3, E)."""
    return space_parallel(_tangents(skeleton)[:, : given.shape[1]], given)


def _tangents(skeleton: Skeleton) -> FloatArray:
    e = skeleton.positions[skeleton.edges[:, 1]] - skeleton.positions[skeleton.edges[:, 0]]
    return np.ascontiguousarray((e / skeleton.rest_lengths[:, None]).T)


def _in_plane(loaded: LoadedScenario, geometry: Geometry, plan: Plan, directors: FloatArray) -> IntArray:
    """For each rod of a planar scene, the material curvature that lies in the plane, and its sign.

    With kappa b = kappa n for the plane's normal n, kappa_1 = kappa n.m2 and kappa_2 = -kappa n.m1.
    """
    out = np.zeros((len(geometry.rods), 2), dtype=np.int64)
    normal = np.array(PLANAR_AXIS[plan.axes])
    for index, rod in enumerate(geometry.rods):
        edges = geometry.rod_edges[rod.name]
        e = geometry.nodes[geometry.edges[edges, 1]] - geometry.nodes[geometry.edges[edges, 0]]
        t = e / np.linalg.norm(e, axis=1)[:, None]
        m1 = directors[:, edges].T
        one, two = np.cross(t, m1) @ normal, -(m1 @ normal)
        for which, values in enumerate((one, two)):
            if np.all(np.abs(np.abs(values) - 1.0) < 1e-9) and np.all(values * values[0] > 0.0):
                out[index] = which, int(np.sign(values[0]))
        if out[index, 1] == 0 and not geometry.properties[index].isotropic:
            raise loaded.error(
                ("geometry", geometry.rod_keys[index], "director"),
                "in a planar scene a director must lie in the plane or normal to it",
            )
        if out[index, 1] == 0:
            out[index] = 0, 1
    return out


def _planar(
    loaded: LoadedScenario,
    geometry: Geometry,
    skeleton: Skeleton,
    dofs: DofMap,
    rest: FloatArray,
    stiffness: FloatArray,
    in_plane: IntArray,
) -> StencilEnergy:
    joints = skeleton.joints
    which = in_plane[np.maximum(joints.rod, 0), 0]
    natural = planar_curvature(dofs.positions(rest), joints.triples)
    for index in range(len(geometry.rods)):
        component, sign = in_plane[index]
        density = natural_density(loaded, geometry, index, f"curvature_{component + 1}", joints)
        if density is not None:
            members = joints.rod == index
            natural[members] = sign * density * joints.voronoi[members]
        hidden = f"curvature_{2 - component}"
        if getattr(geometry.rods[index].natural, hidden) is not None:
            raise loaded.error(
                ("geometry", geometry.rod_keys[index], "natural", hidden),
                "bends out of the plane of the scene",
            )
    parameters = np.stack((natural, stiffness[which, np.arange(len(which))], joints.voronoi))
    return StencilEnergy(
        "bending", BEND_PLANAR, _node_dofs(dofs, joints.triples), parameters, no_auxiliaries(len(natural))
    )


def _framed(
    loaded: LoadedScenario,
    geometry: Geometry,
    skeleton: Skeleton,
    dofs: DofMap,
    rest: FloatArray,
    stiffness: FloatArray,
    frames: RodFrames,
) -> tuple[StencilEnergy, IntArray]:
    j = skeleton.joints
    places = frames.director_places(j.pairs).reshape(-1, 12)
    trial = frames.transport(frames.rest(rest), rest)
    rest_twist = trial.state.reference_twist
    curvature = material_curvatures(
        skeleton.positions, j.triples, trial.auxiliary, places, j.signs, rest_twist
    )
    torsion = rest_twist.copy()
    for index in range(len(geometry.rods)):
        members = j.rod == index
        for row, name in ((curvature[0], "curvature_1"), (curvature[1], "curvature_2"), (torsion, "twist")):
            density = natural_density(loaded, geometry, index, name, j)
            if density is not None:
                row[members] = density * j.voronoi[members]
    stencil = np.concatenate((_node_dofs(dofs, j.triples), dofs.of_angles(j.pairs)), axis=1)
    torsional = _in_series(geometry, skeleton, "torsional")
    energy = StencilEnergy(
        "bending and twist",
        BEND_TWIST,
        stencil,
        np.stack(
            (
                *curvature,
                torsion,
                *stiffness,
                torsional,
                j.voronoi,
                *j.signs.T,
                np.cos(rest_twist),
                np.sin(rest_twist),
            )
        ),
        np.column_stack((places, frames.twist_places(np.arange(len(j.pairs))))),
    )
    return energy, places
