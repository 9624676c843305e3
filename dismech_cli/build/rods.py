"""Rods as DOFs, frames and elastic energies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..energies.bend_framed import BEND_FRAMED
from ..energies.bend_isotropic import BEND_ISOTROPIC
from ..energies.bend_planar import BEND_PLANAR
from ..energies.stretch import STRETCH, STRETCH_PLANAR
from ..energies.twist import TWIST
from ..mesh.topology import chains, rod_stencils
from ..model.dofs import DofMap
from ..model.driver import Driver
from ..model.frames import Frames, NoFrames, RodFrames, space_parallel
from ..model.stencil import StencilEnergy, no_auxiliaries
from ..model.strains import lengths, material_curvatures, planar_curvature
from ..scenario.load import LoadedScenario
from .geometry import Geometry
from .holds import Hold
from .plan import Bending, Plan, free_joints

PLANAR_AXIS: dict[tuple[int, ...], tuple[float, float, float]] = {
    (0, 2): (0.0, -1.0, 0.0),
    (0, 1): (0.0, 0.0, 1.0),
    (1, 2): (1.0, 0.0, 0.0),
}


@dataclass(frozen=True, slots=True)
class Joints:
    """Bend-twist stencils of all rods, walls of clamps included.

    Attributes:
        triples: Nodes, shape (J, 3).
        pairs: Edges, shape (J, 2).
        signs: Walking directions, shape (J, 2).
        voronoi: Length over which each joint bends [m], shape (J,).
        rod: Rod of each joint, -1 between rods, shape (J,).
        number: Number of the joint along its rod, shape (J,); a wall has that of its neighbour.
    """

    triples: IntArray
    pairs: IntArray
    signs: FloatArray
    voronoi: FloatArray
    rod: IntArray
    number: IntArray


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Nodes and edges of the model: the geometry's first, then one of each per wall.

    Attributes:
        positions: Rest positions [m], shape (N + W, 3).
        edges: All edges, shape (E + W, 2).
        owners: Edge of the geometry that each wall continues, shape (W,).
        wall_nodes: Node of the geometry at each wall, shape (W,).
        rest_lengths: Edge lengths [m], shape (E + W,).
        joints: Bend-twist stencils.
    """

    positions: FloatArray
    edges: IntArray
    owners: IntArray
    wall_nodes: IntArray
    rest_lengths: FloatArray
    joints: Joints


def make_skeleton(geometry: Geometry, holds: tuple[Hold, ...]) -> Skeleton:
    """Add a wall edge behind every rod end that is clamped at its node.

    The wall continues the rod by one edge that never moves relative to the clamp; the joint
    between them bends over the half edge on the free side only. So the clamp acts at the node,
    with second-order accuracy, where a clamp of two nodes acts half an edge inside.
    """
    n, e = len(geometry.nodes), len(geometry.edges)
    wall_nodes = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *(h.walls for h in holds)]))
    touching = np.isin(geometry.edges, wall_nodes)
    owner_of = {
        int(geometry.edges[k, i]): (int(k), int(i)) for k, i in zip(*np.nonzero(touching), strict=True)
    }
    owners = np.array([owner_of[int(w)][0] for w in wall_nodes], dtype=np.int64)
    positions, edges = [geometry.nodes], [geometry.edges]
    for k, node in enumerate(wall_nodes):
        owner, side = owner_of[int(node)]
        other = geometry.nodes[geometry.edges[owner, 1 - side]]
        positions.append((2.0 * geometry.nodes[node] - other)[None])
        edges.append(np.array([[n + k, node] if side == 0 else [node, n + k]]))
    all_positions, all_edges = np.concatenate(positions), np.concatenate(edges)
    rest = lengths(all_positions, all_edges)
    rigid = np.zeros(len(all_edges), dtype=bool)
    rigid[e:] = True
    for hold in holds:
        rigid[hold.rigid] = True
    edge_rod = np.concatenate((geometry.edge_rod, geometry.edge_rod[owners]))
    return Skeleton(
        all_positions,
        all_edges,
        owners,
        wall_nodes,
        rest,
        _joints(geometry, all_edges, rest, rigid, edge_rod),
    )


def _joints(
    geometry: Geometry, edges: IntArray, rest: FloatArray, rigid: FloatArray, edge_rod: IntArray
) -> Joints:
    n_nodes = int(edges.max()) + 1
    triples, pairs, signs = rod_stencils(n_nodes, edges)
    rods = edge_rod[pairs]
    kept = free_joints(geometry, triples, rods)
    triples, pairs, signs, rods = triples[kept], pairs[kept], signs[kept], rods[kept]
    half = np.where(rigid, 0.0, 0.5 * rest)
    voronoi = half[pairs].sum(axis=1)
    # between two held edges nothing can bend; any length will do
    voronoi = np.where(voronoi > 0.0, voronoi, 0.5 * rest[pairs].sum(axis=1))
    rod = np.where(rods[:, 0] == rods[:, 1], rods[:, 0], -1)
    return Joints(triples, pairs, signs.astype(np.float64), voronoi, rod, _numbers(geometry, triples, rod))


def _numbers(geometry: Geometry, triples: IntArray, rod: IntArray) -> IntArray:
    """Number each joint along its rod from the start of the rod."""
    number = np.zeros(len(triples), dtype=np.int64)
    for index, one in enumerate(geometry.rods):
        members = np.flatnonzero(rod == index)
        place = np.full(int(triples.max(initial=0)) + 1, -1)
        count = 0
        for chain in chains(len(geometry.nodes), geometry.edges[geometry.rod_edges[one.name]]):
            inner = chain.nodes[1:-1] if chain.kind.value == "open" else chain.nodes
            place[inner] = count + np.arange(len(inner))
            if chain.kind.value == "open":
                # the joints at walls count as their inner neighbours
                place[chain.nodes[0]] = count
                place[chain.nodes[-1]] = count + max(len(inner) - 1, 0)
            count += len(inner)
        number[members] = place[triples[members, 1]]
    return number


@dataclass(frozen=True, slots=True)
class RodSystem:
    """What the rods give to the model.

    Attributes:
        dofs: Numbering.
        rest: Rest configuration q, shape (n,).
        frames: Frames, or their absence.
        stretch: Stretching energy of the geometry's edges.
        bending: Bending energy of the joints, or None without joints.
        twist: Twisting energy of the joints of framed rods, else None.
        bending_stiffness: EI1 and EI2 of each joint [N m^2], shape (2, J).
        in_plane: Planar scenes: which natural curvature (0 or 1) lies in the plane, and its sign,
            per rod, shape (rods, 2).
        auxiliary_indices: Framed scenes: places of the directors, shape (J, 12).
    """

    dofs: DofMap
    rest: FloatArray
    frames: Frames
    stretch: StencilEnergy
    bending: StencilEnergy | None
    twist: StencilEnergy | None
    bending_stiffness: FloatArray
    in_plane: IntArray
    auxiliary_indices: IntArray


def build_rods(
    loaded: LoadedScenario, geometry: Geometry, plan: Plan, skeleton: Skeleton, driver: Driver
) -> RodSystem:
    """Number the DOFs and make the energies of all rods.

    Raises:
        ScenarioError: A section or a list of natural strains does not fit.
    """
    framed = plan.bending is Bending.FRAMED
    n_edges = len(skeleton.edges) if framed else 0
    hidden = [axis for axis in range(3) if axis not in plan.axes]
    level = float(geometry.nodes[0, hidden[0]]) if hidden else 0.0
    dofs = DofMap(len(skeleton.positions), n_edges, plan.axes, len(geometry.nodes), level)
    rest = np.zeros(dofs.n)
    rest[: dofs.n_positions] = dofs.project(skeleton.positions).reshape(-1)
    directors = _directors(geometry, skeleton)
    in_plane = _in_plane(loaded, geometry, plan, directors)
    joints = skeleton.joints
    frames: Frames = NoFrames()
    if framed:
        frames = RodFrames(
            np.ascontiguousarray(dofs.of_nodes(skeleton.edges[:, 0]).T),
            np.ascontiguousarray(dofs.of_nodes(skeleton.edges[:, 1]).T),
            dofs.of_angles(np.arange(n_edges)),
            joints.pairs,
            joints.signs,
            directors,
            driver,
        )
    stiffness = np.stack([_in_series(geometry, skeleton, name) for name in ("bending_1", "bending_2")])
    bending, twist, places = None, None, np.empty((0, 12), dtype=np.int64)
    if len(joints.triples):
        if plan.bending is Bending.PLANAR:
            bending = _planar(loaded, geometry, skeleton, dofs, rest, stiffness, in_plane)
        elif plan.bending is Bending.ISOTROPIC:
            bending = StencilEnergy(
                "bending",
                BEND_ISOTROPIC,
                _node_dofs(dofs, joints.triples),
                np.stack((stiffness[0], joints.voronoi)),
                no_auxiliaries(len(joints.triples)),
            )
        else:
            bending, twist, places = _framed(
                loaded, geometry, skeleton, dofs, rest, stiffness, frames, n_edges
            )
    return RodSystem(
        dofs,
        rest,
        frames,
        _stretch(loaded, geometry, skeleton, dofs),
        bending,
        twist,
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
            ("geometry", index, "natural", name),
            f"{len(value)} values for {count} joints; expected one per joint",
        )
    return np.array(value)[joints.number[members]]


def _node_dofs(dofs: DofMap, nodes: IntArray) -> IntArray:
    return dofs.of_nodes(nodes).reshape(len(nodes), -1)


def _in_series(geometry: Geometry, skeleton: Skeleton, name: str) -> FloatArray:
    """Stiffness of each joint: the two half edges bend or twist in series."""
    j = skeleton.joints
    per_edge = geometry.per_edge(name)
    per_edge = np.concatenate((per_edge, per_edge[skeleton.owners]))
    k = per_edge[j.pairs]
    same = k[:, 0] == k[:, 1]
    half = 0.5 * skeleton.rest_lengths[j.pairs]
    series = half.sum(axis=1) / (half / k).sum(axis=1)
    return np.where(same, k[:, 0], series)


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


def _directors(geometry: Geometry, skeleton: Skeleton) -> FloatArray:
    """First material directors at rest, shape (E + W, 3): a wall has that of its rod."""
    e = skeleton.positions[skeleton.edges[:, 1]] - skeleton.positions[skeleton.edges[:, 0]]
    tangents = e / skeleton.rest_lengths[:, None]
    given = np.full(tangents.shape, np.nan)
    for rod in geometry.rods:
        if rod.director is not None:
            given[geometry.rod_edges[rod.name][0]] = rod.director
    count = len(geometry.edges)
    directors = space_parallel(tangents[:count], given[:count])
    return np.concatenate((directors, directors[skeleton.owners]))


def _in_plane(loaded: LoadedScenario, geometry: Geometry, plan: Plan, directors: FloatArray) -> IntArray:
    """For each rod of a planar scene, the material curvature that lies in the plane, and its sign.

    With kappa b = kappa n for the plane's normal n, kappa_1 = kappa n.m2 and kappa_2 = -kappa n.m1.
    """
    out = np.zeros((len(geometry.rods), 2), dtype=np.int64)
    if plan.bending is not Bending.PLANAR:
        return out
    normal = np.array(PLANAR_AXIS[plan.axes])
    for index, rod in enumerate(geometry.rods):
        edges = geometry.rod_edges[rod.name]
        e = geometry.nodes[geometry.edges[edges, 1]] - geometry.nodes[geometry.edges[edges, 0]]
        t = e / np.linalg.norm(e, axis=1)[:, None]
        m1 = directors[edges]
        one, two = np.cross(t, m1) @ normal, -(m1 @ normal)
        for which, values in enumerate((one, two)):
            if np.all(np.abs(np.abs(values) - 1.0) < 1e-9) and np.all(values * values[0] > 0.0):
                out[index] = which, int(np.sign(values[0]))
        if out[index, 1] == 0 and not geometry.properties[index].isotropic:
            raise loaded.error(
                ("geometry", index, "director"),
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
            raise loaded.error(("geometry", index, "natural", hidden), "bends out of the plane of the scene")
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
    frames: Frames,
    n_edges: int,
) -> tuple[StencilEnergy, StencilEnergy, IntArray]:
    j = skeleton.joints
    places = np.stack(
        [
            k * 3 * n_edges + c * n_edges + j.pairs[:, side]
            for side in (0, 1)
            for k in (0, 1)
            for c in range(3)
        ],
        axis=1,
    )
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
    bending = StencilEnergy(
        "bending",
        BEND_FRAMED,
        stencil,
        np.stack((*curvature, *stiffness, j.voronoi, *j.signs.T, np.cos(rest_twist), np.sin(rest_twist))),
        places,
    )
    twist = StencilEnergy(
        "twist",
        TWIST,
        stencil,
        np.stack(
            (torsion, _in_series(geometry, skeleton, "torsional"), j.voronoi, j.signs[:, 0], j.signs[:, 1])
        ),
        (6 * n_edges + np.arange(len(j.pairs)))[:, None],
    )
    return bending, twist, places
