"""Bodies of the scenario as one set of nodes and edges, joints welded, groups resolved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import MeshError
from ..mesh import generate
from ..mesh.mesh import Mesh
from ..mesh.read import read_mesh
from ..mesh.validate import validate
from ..model.sections import (
    RodProperties,
    Section,
    rectangular_section,
    rod_properties,
    round_section,
    tube_section,
)
from ..model.strains import lengths
from ..scenario.geometry import Rod
from ..scenario.joint import HingeJoint
from ..scenario.load import LoadedScenario
from ..scenario.schema import Scenario
from ..scenario.section import GivenSection, RectangularSection, RoundSection, TubeSection
from ..scenario.shape import Arc, CsvCurve, Helix, Line, Polyline

# Nodes of a joint must coincide to this fraction of the shortest edge.
_COINCIDENT = 1e-6


@dataclass(frozen=True, slots=True)
class Geometry:
    """All rods together.

    Attributes:
        nodes: Positions [m], shape (N, 3).
        edges: Rod edges, shape (E, 2).
        edge_rod: Rod of each edge, shape (E,).
        rods: The rods, in the order of the scenario.
        properties: Stiffness and inertia of each rod.
        node_groups: ``rod``, ``rod.start``, ``rod.end``, ``rod.GROUP`` to node indices.
        edge_groups: The same names to edge indices.
        rod_nodes: Nodes of each rod, in its own order.
        rod_edges: Edges of each rod, in its own order.
        hinges: Nodes where no bending or twist passes between any edges.
        rod_hinges: Nodes where none passes between edges of different rods.
        notes: What the mesh readers said.
    """

    nodes: FloatArray
    edges: IntArray
    edge_rod: IntArray
    rods: tuple[Rod, ...]
    properties: tuple[RodProperties, ...]
    node_groups: Mapping[str, IntArray]
    edge_groups: Mapping[str, IntArray]
    rod_nodes: Mapping[str, IntArray]
    rod_edges: Mapping[str, IntArray]
    hinges: IntArray
    rod_hinges: IntArray
    notes: tuple[str, ...]

    def per_edge(self, name: str) -> FloatArray:
        """A property of the rods on every edge, shape (E,)."""
        return np.array([getattr(p, name) for p in self.properties])[self.edge_rod]


def assemble_geometry(loaded: LoadedScenario) -> Geometry:
    """Read or generate every rod and put them together; joints are welded later.

    Raises:
        ScenarioError: A mesh is unusable.
    """
    scenario = loaded.scenario
    nodes, edges, edge_rod, notes = [], [], [], []
    node_groups: dict[str, IntArray] = {}
    edge_groups: dict[str, IntArray] = {}
    rod_nodes: dict[str, IntArray] = {}
    rod_edges: dict[str, IntArray] = {}
    n = e = 0
    for index, rod in enumerate(scenario.geometry):
        mesh = _mesh(loaded, index, rod)
        notes += [f"{rod.name}: {note}" for note in mesh.notes]
        nodes.append(mesh.nodes)
        edges.append(mesh.edges + n)
        edge_rod.append(np.full(len(mesh.edges), index))
        rod_nodes[rod.name] = node_groups[rod.name] = n + np.arange(len(mesh.nodes))
        rod_edges[rod.name] = edge_groups[rod.name] = e + np.arange(len(mesh.edges))
        for name, group in _with_ends(mesh).items():
            node_groups[f"{rod.name}.{name}"] = group + n
            inside = np.isin(mesh.edges, group)
            touching = inside.all(axis=1) if len(group) > 1 else inside.any(axis=1)
            edge_groups[f"{rod.name}.{name}"] = e + np.flatnonzero(touching)
        for name, group in mesh.edge_groups.items():
            edge_groups[f"{rod.name}.{name}"] = group + e
            node_groups.setdefault(f"{rod.name}.{name}", np.unique(mesh.edges[group]) + n)
        n, e = n + len(mesh.nodes), e + len(mesh.edges)
    empty = np.empty(0, dtype=np.int64)
    return Geometry(
        np.concatenate(nodes),
        np.concatenate(edges),
        np.concatenate(edge_rod),
        scenario.geometry,
        tuple(_properties(scenario, rod) for rod in scenario.geometry),
        node_groups,
        edge_groups,
        rod_nodes,
        rod_edges,
        empty,
        empty,
        tuple(notes),
    )


def weld_joints(loaded: LoadedScenario, geometry: Geometry) -> Geometry:
    """Merge the nodes of the scenario's joints and list the hinges.

    Raises:
        ScenarioError: Two nodes of a joint do not coincide.
    """
    from .selection import select_single_node

    target = np.arange(len(geometry.nodes))
    hinges: list[int] = []
    rod_hinges: list[int] = []
    near = _COINCIDENT * lengths(geometry.nodes, geometry.edges).min()
    for index, joint in enumerate(loaded.scenario.joints):
        path = ("joints", index)
        if isinstance(joint, HingeJoint) and joint.where is not None:
            hinges.append(select_single_node(loaded, geometry, joint.where, (*path, "where")))
            continue
        assert joint.nodes is not None
        a, b = (
            select_single_node(loaded, geometry, side, (*path, "nodes", k))
            for k, side in enumerate(joint.nodes)
        )
        gap = float(np.linalg.norm(geometry.nodes[a] - geometry.nodes[b]))
        if gap > near:
            raise loaded.error(
                (*path, "nodes"), f"the two nodes are {gap:.3g} m apart; a joint needs them to coincide"
            )
        target[target == target[b]] = target[a]
        if isinstance(joint, HingeJoint):
            rod_hinges.append(a)
    kept, index_of = np.unique(target, return_inverse=True)

    def moved(groups: Mapping[str, IntArray]) -> dict[str, IntArray]:
        return {name: index_of[group] for name, group in groups.items()}

    edges = index_of[geometry.edges]
    degenerate = np.flatnonzero(edges[:, 0] == edges[:, 1])
    if degenerate.size:
        raise loaded.error(("joints",), f"a joint welds both ends of edge {degenerate[0]} together")
    return Geometry(
        geometry.nodes[kept],
        edges,
        geometry.edge_rod,
        geometry.rods,
        geometry.properties,
        moved(geometry.node_groups),
        geometry.edge_groups,
        moved(geometry.rod_nodes),
        geometry.rod_edges,
        index_of[np.array(hinges, dtype=np.int64)],
        index_of[np.array(rod_hinges, dtype=np.int64)],
        geometry.notes,
    )


def _with_ends(mesh: Mesh) -> dict[str, IntArray]:
    """Node groups, with ``start`` and ``end`` of a single open chain from a file too."""
    groups = dict(mesh.node_groups)
    degree = np.bincount(mesh.edges.reshape(-1), minlength=len(mesh.nodes))
    ends = np.flatnonzero(degree == 1)
    if len(ends) == 2 and degree.max() == 2:
        groups.setdefault("start", ends[:1])
        groups.setdefault("end", ends[1:])
    return groups


def _mesh(loaded: LoadedScenario, index: int, rod: Rod) -> Mesh:
    path = ("geometry", index, "generate" if rod.generate is not None else "mesh")
    try:
        return _generated(rod, loaded.directory) if rod.generate is not None else _read(rod, loaded.directory)
    except MeshError as error:
        raise loaded.error(path, str(error)) from error


def _read(rod: Rod, directory: Path) -> Mesh:
    assert rod.mesh is not None
    mesh = read_mesh(directory / rod.mesh.file)
    if rod.mesh.group is not None:
        if rod.mesh.group not in mesh.edge_groups:
            known = ", ".join(sorted(mesh.edge_groups)) or "none"
            raise MeshError(f"{rod.mesh.file} has no group of lines '{rod.mesh.group}'; it has: {known}")
        chosen = mesh.edge_groups[rod.mesh.group]
        used, edges = np.unique(mesh.edges[chosen], return_inverse=True)
        back = np.full(len(mesh.nodes), -1)
        back[used] = np.arange(len(used))
        groups = {name: back[g][back[g] >= 0] for name, g in mesh.node_groups.items()}
        mesh = Mesh(
            nodes=mesh.nodes[used],
            edges=edges.reshape(-1, 2),
            node_groups={name: g for name, g in groups.items() if g.size},
            notes=mesh.notes,
        )
    if len(mesh.edges) == 0:
        raise MeshError(f"{rod.mesh.file} has no lines; a rod needs some")
    return validate(mesh, rod.mesh.file)


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
            return generate.polyline(s.points, nodes=s.nodes, spacing=s.spacing, closed=s.closed)
        case CsvCurve() as s:
            return generate.from_csv(directory / s.file, s.columns, closed=s.closed)
        case None:
            raise AssertionError("the schema asks for generate or mesh")


def _properties(scenario: Scenario, rod: Rod) -> RodProperties:
    material = scenario.materials[rod.material]
    shape: Section
    match rod.cross_section:
        case RoundSection() as s:
            shape = round_section(s.radius)
        case TubeSection() as s:
            shape = tube_section(s.outer_radius, s.inner_radius)
        case RectangularSection() as s:
            shape = rectangular_section(s.width, s.thickness, s.torsion_constant)
        case GivenSection() as s:
            return RodProperties(
                axial=s.axial_stiffness,
                bending_1=s.bending_stiffness_1,
                bending_2=s.bending_stiffness_2,
                torsional=s.torsional_stiffness,
                mass_per_length=s.mass_per_length,
                polar_per_length=s.rotary_inertia_per_length,
                area=s.mass_per_length / material.density,
                radius=s.radius,
            )
    return rod_properties(shape, material.youngs_modulus, material.poisson_ratio, material.density)
