"""Bodies of the scenario as one set of nodes, edges and triangles, groups resolved."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, distinct
from ...errors import ScenarioError
from ...frozen import frozen
from ...mesh.measure import edge_lengths, triangle_areas
from ...scenario.language.geometry import Rod, Shell
from ...scenario.load import LoadedScenario
from ...sections.rods import RodProperties
from .cells import rod_cells, shell_cells
from .mesh import BodyMesh, left_out
from .rod import rod_mesh, with_ends
from .section import properties_of
from .shell import ShellProperties, shell_mesh, shell_properties
from .turning import Turning, whole
from .varying import Sampler


@frozen
class ShellWeld:
    """An edge of a rod that turns with a shell at one of its ends.

    Attributes:
        edge: The rod's edge.
        node: The node that it shares with the shell.
        joint: Place of the joint in the scenario's list.
        release: What alone does not pass, or None.
        footprint: Distance [m] from the node within which triangles turn with the rod.
    """

    edge: int
    node: int
    joint: int
    release: str | None
    footprint: float


@frozen
class Joined:
    """Two bodies that share a node, or a node within one that is released.

    Attributes:
        joint: Place of the joint in the scenario's list, or None where a mesh file says so.
        bodies: Their names.
        members: The node in the words of either.
        node: Which it is.
        passes: Which of bending and twist pass there.
        gap: How far apart its two nodes were [m], 0 for round-off.
    """

    joint: int | None
    bodies: tuple[str, ...]
    members: tuple[str, ...]
    node: int
    passes: tuple[str, ...]
    gap: float


@frozen
class WeldedSides:
    """Sides of triangles across which bending passes from shell to shell.

    Attributes:
        shells: Places of the shells among the shells.
        sides: Their nodes, shape (S, 2).
    """

    shells: tuple[int, ...]
    sides: IntArray


@frozen
class Geometry:
    """All bodies together.

    Attributes:
        nodes: Positions [m], shape (N, 3).
        edges: Rod edges, shape (E, 2).
        edge_rod: Rod of each edge, shape (E,).
        rods: The rods, in the order of the scenario.
        rod_keys: Place of each rod in the scenario's list of bodies.
        properties: Stiffness and inertia of the edges of each rod.
        triangles: Shell triangles, shape (T, 3).
        triangle_shell: Shell of each triangle, shape (T,).
        shells: The shells, in the order of the scenario.
        shell_keys: Place of each shell in the scenario's list of bodies.
        sheets: Stiffness and inertia of the triangles of each shell.
        node_groups: ``body``, ``body.GROUP``, ``rod.start``, ``rod.end``, ``shell.boundary`` to nodes.
        edge_groups: ``rod``, ``rod.start``, ``rod.end``, ``rod.GROUP`` to edge indices.
        body_nodes: Nodes of each body, in its own order.
        rod_edges: Edges of each rod, in its own order.
        turning: Which of its edges turn as one where they meet.
        shell_welds: Edges of rods that turn with a shell.
        seams: Sides along which shells are welded.
        joined: What became one.
        files: File of each body's mesh, or None, and its nodes' numbers there.
        notes: What the mesh readers said, and what varies over a body.
        doubts: What varies too fast for the mesh, or to odd values.
    """

    nodes: FloatArray
    edges: IntArray
    edge_rod: IntArray
    rods: tuple[Rod, ...]
    rod_keys: tuple[int, ...]
    properties: tuple[RodProperties, ...]
    triangles: IntArray
    triangle_shell: IntArray
    shells: tuple[Shell, ...]
    shell_keys: tuple[int, ...]
    sheets: tuple[ShellProperties, ...]
    node_groups: Mapping[str, IntArray]
    edge_groups: Mapping[str, IntArray]
    body_nodes: Mapping[str, IntArray]
    rod_edges: Mapping[str, IntArray]
    turning: Turning
    shell_welds: tuple[ShellWeld, ...]
    seams: tuple[WeldedSides, ...]
    joined: tuple[Joined, ...]
    files: Mapping[str, tuple[Path, IntArray]]
    notes: tuple[str, ...]
    doubts: tuple[str, ...]

    def per_edge(self, name: str) -> FloatArray:
        """A property of the rods on every edge, shape (E,)."""
        return np.concatenate((np.empty(0), *(getattr(p, name) for p in self.properties)))

    def per_triangle(self, name: str) -> FloatArray:
        """A property of the shells on every triangle, shape (T,)."""
        return np.concatenate((np.empty(0), *(getattr(s, name) for s in self.sheets)))

    @property
    def lengths(self) -> FloatArray:
        """Rest lengths of the rod edges [m], shape (E,)."""
        return edge_lengths(self.nodes, self.edges)

    @property
    def areas(self) -> FloatArray:
        """Rest areas of the triangles [m^2], shape (T,)."""
        return triangle_areas(self.nodes, self.triangles)

    @property
    def on_shell(self) -> IntArray:
        """Nodes of the shells."""
        return distinct(self.triangles)

    @property
    def carries_shell(self) -> BoolArray:
        """Which nodes are on a shell, shape (N,)."""
        out = np.zeros(len(self.nodes), dtype=np.bool_)
        out[self.triangles] = True
        return out

    def triangles_of(self, shell: str) -> IntArray:
        """Indices of the triangles of a shell."""
        return np.flatnonzero(self.triangle_shell == [one.name for one in self.shells].index(shell))


def assemble_geometry(loaded: LoadedScenario) -> Geometry:
    """Read or generate every body and put them together; joints are welded later.

    Raises:
        ScenarioError: A mesh is unusable.
    """
    scenario = loaded.scenario
    nodes, edges, edge_rod, triangles, triangle_shell, notes = [], [], [], [], [], []
    node_groups: dict[str, IntArray] = {}
    edge_groups: dict[str, IntArray] = {}
    body_nodes: dict[str, IntArray] = {}
    rod_edges: dict[str, IntArray] = {}
    files: dict[str, tuple[Path, IntArray]] = {}
    rods, shells = scenario.rods, scenario.shells
    n = e = 0
    bodies: list[BodyMesh] = []
    properties: list[RodProperties] = []
    sheets: list[ShellProperties] = []
    doubts: list[str] = []
    for index, body in enumerate(scenario.geometry):
        found = _mesh(loaded, index, body)
        bodies.append(found)
        mesh = found.mesh
        notes += [f"{body.name}: {note}" for note in mesh.notes]
        nodes.append(mesh.nodes)
        edges.append(mesh.edges + n)
        triangles.append(mesh.triangles + n)
        body_nodes[body.name] = node_groups[body.name] = n + np.arange(len(mesh.nodes))
        if found.file is not None:
            files[body.name] = (found.file, found.numbers)
        if isinstance(body, Rod):
            edge_rod.append(np.full(len(mesh.edges), list(rods).index(index)))
            rod_edges[body.name] = edge_groups[body.name] = e + np.arange(len(mesh.edges))
        else:
            triangle_shell.append(np.full(len(mesh.triangles), list(shells).index(index)))
        own: dict[str, IntArray] = {}
        for name, group in with_ends(mesh).items():
            node_groups[f"{body.name}.{name}"] = group + n
            if isinstance(body, Rod):
                inside = np.isin(mesh.edges, group)
                touching = inside.all(axis=1) if len(group) > 1 else inside.any(axis=1)
                own[name] = np.flatnonzero(touching)
        for name, group in mesh.edge_groups.items():
            own[name] = group
            node_groups.setdefault(f"{body.name}.{name}", distinct(mesh.edges[group]) + n)
        edge_groups.update({f"{body.name}.{name}": e + group for name, group in own.items()})
        material = scenario.materials[body.material]
        if isinstance(body, Rod):
            sample = Sampler(loaded, body.name, rod_cells(mesh, own))
            properties.append(properties_of(body, ("geometry", index), material, sample))
        else:
            sample = Sampler(loaded, body.name, shell_cells(mesh))
            sheets.append(shell_properties(body, ("geometry", index), material, sample))
        notes += sample.notes
        doubts += sample.doubts
        n, e = n + len(mesh.nodes), e + len(mesh.edges)
    notes += left_out(bodies)
    empty, all_edges = np.empty(0, dtype=np.int64), np.concatenate(edges)
    return Geometry(
        nodes=np.concatenate(nodes),
        edges=all_edges,
        edge_rod=np.concatenate((empty, *edge_rod)),
        rods=tuple(rods.values()),
        rod_keys=tuple(rods),
        properties=tuple(properties),
        triangles=np.concatenate(triangles),
        triangle_shell=np.concatenate((empty, *triangle_shell)),
        shells=tuple(shells.values()),
        shell_keys=tuple(shells),
        sheets=tuple(sheets),
        node_groups=node_groups,
        edge_groups=edge_groups,
        body_nodes=body_nodes,
        rod_edges=rod_edges,
        turning=whole(all_edges),
        shell_welds=(),
        seams=(),
        joined=(),
        files=files,
        notes=tuple(notes),
        doubts=tuple(doubts),
    )


def _mesh(loaded: LoadedScenario, index: int, body: Rod | Shell) -> BodyMesh:
    path = ("geometry", index, "generate" if body.generate is not None else "mesh")
    try:
        if isinstance(body, Rod):
            return rod_mesh(body, loaded.directory)
        return shell_mesh(body, loaded.directory)
    except ScenarioError as error:
        raise loaded.error(path, str(error)) from error
