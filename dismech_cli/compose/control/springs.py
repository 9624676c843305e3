"""The places at which a strain is commanded or read: joints, edges, hinges, triangles."""

from __future__ import annotations

from dataclasses import field, replace
from typing import TypeAlias, assert_never

import numpy as np

from ...arrays import FloatArray, IntArray
from ...control.sensor import Reading
from ...energies.hinge import hinge_term
from ...frozen import frozen
from ...model.measure import StrainReading
from ...model.stencil import StencilEnergy
from ...scenario.language.actuation import (
    CurvatureActuation,
    DihedralActuation,
    StretchActuation,
    SurfaceCurvatureActuation,
    TwistActuation,
)
from ...scenario.language.sensor import (
    CurvatureSensor,
    DihedralSensor,
    StretchSensor,
    SurfaceCurvatureSensor,
    TwistSensor,
)
from ...scenario.text.tree import KeyPath
from ..elastic.curvature_drives import chosen_triangles
from ..elastic.elastic import Passive
from ..elastic.hinge_drives import chosen_hinges
from ..elastic.rod_drives import ROWS
from ..laws import NOWHERE, Coordinates
from ..scene import Scene
from ..shells.body import ShellBody
from ..structure.plan import Bending
from ..structure.structure import Structure

RodPlaces: TypeAlias = (
    StretchActuation | CurvatureActuation | TwistActuation | StretchSensor | CurvatureSensor | TwistSensor
)
Places: TypeAlias = (
    RodPlaces | DihedralActuation | DihedralSensor | SurfaceCurvatureActuation | SurfaceCurvatureSensor
)


@frozen(kw_only=True)
class Springs:
    """Places of one strain, in the order in which commands and readings count them.

    Attributes:
        body: Name of the body.
        what: The strain and the numbers of its places: the same where two act on the same.
        reading: The strain there is, beyond the natural one.
        s: Place along the rod, 0 to 1, shape (n,).
        links: Neighbours, shape (L, 2).
        spans: Their distances [m], shape (L,).
        at: Where they are at rest, for laws of shells.
    """

    body: str
    what: tuple[str, tuple[int, ...]]
    reading: Reading
    s: FloatArray
    links: IntArray
    spans: FloatArray
    at: Coordinates = field(default_factory=lambda: NOWHERE)

    @property
    def n(self) -> int:
        """Number of places."""
        return len(self.s)

    def shares(self, other: Springs) -> bool:
        """Whether both have a place of the same strain in common."""
        same = self.body == other.body and self.what[0] == other.what[0]
        return same and not set(self.what[1]).isdisjoint(other.what[1])

    def alike(self, other: Springs) -> bool:
        """Whether both are the same strain at the same places."""
        return self.body == other.body and self.what == other.what


def find_springs(
    scene: Scene, structure: Structure, passive: Passive, spec: Places, path: KeyPath
) -> Springs:
    """The places of an actuation or a sensor.

    Raises:
        ScenarioError: There are none, or their strain has no meaning there.
    """
    match spec:
        case StretchActuation() | StretchSensor():
            return _edges(scene, structure, passive, spec, path)
        case CurvatureActuation() | CurvatureSensor() | TwistActuation() | TwistSensor():
            return _joints(scene, structure, passive, spec, path)
        case DihedralActuation() | DihedralSensor():
            return _hinges(scene, structure, spec, path)
        case SurfaceCurvatureActuation() | SurfaceCurvatureSensor():
            return _triangles(scene, structure, passive, spec, path)
        case _:
            assert_never(spec)


def strain_of(spec: Places) -> str:
    """Name of the strain."""
    match spec:
        case (
            StretchActuation()
            | CurvatureActuation()
            | TwistActuation()
            | DihedralActuation()
            | SurfaceCurvatureActuation()
        ):
            return spec.type
        case _:
            return spec.strain


def _edges(
    scene: Scene,
    structure: Structure,
    passive: Passive,
    spec: StretchActuation | StretchSensor,
    path: KeyPath,
) -> Springs:
    geometry, stretch = scene.geometry, passive.rods.stretch
    assert stretch is not None
    edges = geometry.rod_edges[spec.rod]
    numbers = _range(scene, spec, len(edges), path)
    mine = edges[numbers]
    # springs of unit stiffness: a strain does not ask how stiff the edge is
    stiff = {name: 1.0 if name == "EA" else 0.0 for name in stretch.kernel.scales[0]}
    energy = _some(stretch, mine).having(stiff)
    place = np.full(len(geometry.edges), -1)
    place[mine] = np.arange(len(mine))
    joints = structure.skeleton.joints
    inner = joints.pairs[(joints.pairs < len(place)).all(axis=1)]
    links = place[inner]
    near = (links >= 0).all(axis=1)
    spans = 0.5 * structure.skeleton.rest_lengths[inner].sum(axis=1)
    return Springs(
        body=spec.rod,
        what=("stretch", tuple(numbers.tolist())),
        reading=_reading(structure, energy, np.ones((1, 1, len(mine)))),
        s=numbers / max(len(edges) - 1, 1),
        links=links[near],
        spans=spans[near],
    )


def _joints(
    scene: Scene,
    structure: Structure,
    passive: Passive,
    spec: CurvatureActuation | CurvatureSensor | TwistActuation | TwistSensor,
    path: KeyPath,
) -> Springs:
    geometry, rods, joints = scene.geometry, passive.rods, structure.skeleton.joints
    strain, rod = strain_of(spec), [r.name for r in geometry.rods].index(spec.rod)
    count = int(joints.counts[rod])
    numbers = _range(scene, spec, count, path)
    # those behind clamps are numbered as their neighbours, which stand for them
    inner = (joints.rod == rod) & (joints.triples < structure.skeleton.visible).all(axis=1)
    stencil = np.full(max(count, 1), -1)
    stencil[joints.number[inner]] = np.flatnonzero(inner)
    mine = stencil[numbers]
    assert rods.bending is not None
    row, sign = ROWS[strain], 1.0
    if structure.plan.bending is Bending.PLANAR:
        component, sign = rods.in_plane[rod]
        if strain == "twist" or row != component:
            raise scene.error(path, f"{strain} lies out of the plane of the scene")
        row = 0
    kernel = rods.bending.kernel
    unit = dict.fromkeys((name for names in kernel.scales for name in names), 1.0)
    energy = _some(rods.bending, mine).having(unit)
    modes = np.zeros((1, len(kernel.naturals), len(mine)))
    modes[0, row] = sign * joints.voronoi[mine]
    links, spans = _linked(joints.pairs[mine], structure.skeleton.rest_lengths)
    return Springs(
        body=spec.rod,
        what=(strain, tuple(numbers.tolist())),
        reading=_reading(structure, energy, modes),
        s=numbers / max(count - 1, 1),
        links=links,
        spans=spans,
    )


def _hinges(
    scene: Scene, structure: Structure, spec: DihedralActuation | DihedralSensor, path: KeyPath
) -> Springs:
    body, nodes = _shell(structure, spec.shell), scene.geometry.nodes
    chosen = chosen_hinges(scene, body.topology, path, spec)
    topology = body.topology
    hinges = topology.hinges[chosen]
    energy = hinge_term("angles", structure.dofs, structure.positions, hinges, np.ones(len(chosen)))
    middle = nodes[hinges[:, :2]].mean(axis=1)
    links, spans = _adjacent(topology.hinge_faces[chosen], middle)
    x, y, z = middle.T
    return Springs(
        body=spec.shell,
        what=("dihedral", tuple(chosen.tolist())),
        reading=_reading(structure, energy, np.ones((1, 1, len(chosen)))),
        s=np.arange(len(chosen)) / max(len(chosen) - 1, 1),
        links=links,
        spans=spans,
        at={"x": x, "y": y, "z": z, "r": np.hypot(x, y)},
    )


def _triangles(
    scene: Scene,
    structure: Structure,
    passive: Passive,
    spec: SurfaceCurvatureActuation | SurfaceCurvatureSensor,
    path: KeyPath,
) -> Springs:
    body, nodes = _shell(structure, spec.shell), scene.geometry.nodes
    chosen = chosen_triangles(scene, body, path, spec)
    one, two = chosen.along, chosen.across
    # angles of a triangle by its three curvatures: along, across, and the twist of both
    modes = np.stack(
        [chosen.angles(nodes, body.triangles, a, b) for a, b in ((one, one), (two, two), (one, two))]
    )
    middle = nodes[body.triangles[chosen.stencils]].mean(axis=1)
    sides = np.full((len(body.triangles), 3), -1)
    faces = body.topology.edge_faces[body.topology.face_edges]
    own = np.arange(len(body.triangles))[:, None]
    sides = np.where(faces[..., 0] == own, faces[..., 1], faces[..., 0])[chosen.stencils]
    place = np.full(len(body.triangles) + 1, -1)
    place[chosen.stencils] = np.arange(len(chosen.stencils))
    other = place[sides]
    here = np.broadcast_to(np.arange(len(other))[:, None], other.shape)
    pairs = np.stack((here[other > here], other[other > here]), axis=1)
    x, y, z = middle.T
    return Springs(
        body=spec.shell,
        what=("surface_curvature", tuple(chosen.stencils.tolist())),
        reading=_reading(structure, _some(passive.shells.bending[spec.shell], chosen.stencils), modes),
        s=np.arange(len(middle)) / max(len(middle) - 1, 1),
        links=pairs,
        spans=np.linalg.norm(middle[pairs[:, 0]] - middle[pairs[:, 1]], axis=1),
        at={"x": x, "y": y, "z": z, "r": np.hypot(x, y)},
    )


def _shell(structure: Structure, name: str) -> ShellBody:
    return structure.shell_edges.bodies[name]


def _range(scene: Scene, spec: RodPlaces, count: int, path: KeyPath) -> IntArray:
    """Numbers of the joints or edges that are chosen.

    Raises:
        ScenarioError: The rod has none of that number.
    """
    first, last = (0, count - 1) if spec.joints is None else spec.joints
    if last >= count or count == 0:
        raise scene.error(
            (*path, "joints" if spec.joints else "rod"), f"rod '{spec.rod}' has {count}, counted from 0"
        )
    return np.arange(first, last + 1)


def _some(energy: StencilEnergy, stencils: IntArray) -> StencilEnergy:
    return replace(
        energy,
        dofs=energy.dofs[stencils],
        parameters=np.ascontiguousarray(energy.parameters[:, stencils]),
        auxiliaries=energy.auxiliaries[stencils],
    )


def _reading(structure: Structure, energy: StencilEnergy, modes: FloatArray) -> StrainReading:
    return StrainReading.of(energy, structure.frames, structure.driver, structure.rest, modes)


def _linked(pairs: IntArray, lengths: FloatArray) -> tuple[IntArray, FloatArray]:
    """Joints (J, 2) of edges that share an edge, and its length."""
    found: dict[int, list[int]] = {}
    for joint, edges in enumerate(pairs.tolist()):
        for edge in edges:
            found.setdefault(edge, []).append(joint)
    links = [
        (a, b, edge)
        for edge, members in found.items()
        for k, a in enumerate(members)
        for b in members[k + 1 :]
    ]
    table = np.array(links, dtype=np.int64).reshape(-1, 3)
    return table[:, :2], lengths[table[:, 2]]


def _adjacent(faces: IntArray, middle: FloatArray) -> tuple[IntArray, FloatArray]:
    """Hinges at the same triangle, shape (L, 2), and their distances [m]."""
    found: dict[int, list[int]] = {}
    for hinge, sides in enumerate(faces.tolist()):
        for face in sides:
            found.setdefault(face, []).append(hinge)
    links = [(a, b) for members in found.values() for k, a in enumerate(members) for b in members[k + 1 :]]
    pairs = np.array(links, dtype=np.int64).reshape(-1, 2)
    return pairs, np.linalg.norm(middle[pairs[:, 0]] - middle[pairs[:, 1]], axis=1)
