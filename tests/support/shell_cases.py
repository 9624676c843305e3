"""Shell models put together by hand: every membrane and bending option on any mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dismech_cli.arrays import BoolArray, FloatArray, IntArray
from dismech_cli.energies.hinge import hinge_term
from dismech_cli.energies.membrane import membrane_term
from dismech_cli.energies.membrane_springs import spring_term
from dismech_cli.energies.midedge import midedge_term
from dismech_cli.energies.midedge_averaged import midedge_averaged_term
from dismech_cli.kernels.driver import Driver
from dismech_cli.kernels.numpy_driver import NumpyDriver
from dismech_cli.kinematics.dofs import DofMap
from dismech_cli.kinematics.rod_frames import Frames, NoFrames
from dismech_cli.kinematics.shell_frames import ShellFrames
from dismech_cli.mesh.measure import adjacent_areas, edge_lengths, triangle_areas
from dismech_cli.mesh.mesh import Mesh
from dismech_cli.mesh.topology.shells import ShellTopology, shell_edges
from dismech_cli.model.model import Model
from dismech_cli.model.stencil import StencilEnergy
from dismech_cli.sections.mass import shell_mass
from dismech_cli.sections.shells import area_springs, hinge_stiffness, weighted_hinge_stiffness

NUMPY = NumpyDriver()


@dataclass(frozen=True, slots=True)
class Material:
    """A homogeneous isotropic sheet."""

    youngs_modulus: float = 1.0
    poisson_ratio: float = 0.3
    thickness: float = 0.1
    density: float = 1.0

    @property
    def rigidity(self) -> float:
        """Plate rigidity D."""
        return self.youngs_modulus * self.thickness**3 / (12.0 * (1.0 - self.poisson_ratio**2))


@dataclass(frozen=True, slots=True)
class Shell:
    """A shell model with what tests want to know of it."""

    model: Model
    mesh: Mesh
    topology: ShellTopology
    areas: FloatArray

    def term(self, name: str) -> StencilEnergy:
        (found,) = (t for t in self.model.terms if t.name == name)
        assert isinstance(found, StencilEnergy)
        return found

    def with_naturals(self, name: str, natural: FloatArray) -> Shell:
        """The same shell with other natural strains of one energy."""
        old = self.term(name)
        new = old.having(dict(zip(old.kernel.naturals, natural, strict=True)))
        terms = tuple(new if t is old else t for t in self.model.terms)
        return replace(self, model=replace(self.model, terms=terms))

    def rim_edges(self) -> IntArray:
        return np.flatnonzero(self.topology.edge_faces[:, 1] < 0)

    def edges_among(self, nodes: BoolArray) -> IntArray:
        """Shell edges with both ends in a set of nodes."""
        return np.flatnonzero(nodes[self.topology.edges].all(axis=1))


def shell(
    mesh: Mesh,
    bending: str,
    membrane: str = "cst",
    material: Material = Material(),
    driver: Driver = NUMPY,
) -> Shell:
    """A shell without loads or supports, at rest in the mesh's shape.

    Args:
        mesh: Its nodes and triangles.
        bending: ``hinge``, ``weighted`` (hinges), ``midedge`` or ``averaged``.
        membrane: ``cst`` or ``springs``.
        material: The sheet.
        driver: Runs the kernels.
    """
    nodes, triangles = mesh.nodes, mesh.triangles
    topology = shell_edges(triangles)
    free = len(topology.edges) if bending == "midedge" else 0
    dofs = DofMap(len(nodes), 0, (0, 1, 2), len(nodes), n_normals=free)
    areas, lengths = triangle_areas(nodes, triangles), edge_lengths(nodes, topology.edges)
    e, nu, h = material.youngs_modulus, material.poisson_ratio, material.thickness
    frames: Frames = NoFrames()
    match bending:
        case "hinge":
            stiffness = hinge_stiffness(e, h, len(topology.hinges))
            bend = hinge_term("bend", dofs, nodes, topology.hinges, stiffness)
        case "weighted":
            pair = adjacent_areas(topology.edge_faces, areas)[topology.hinge_edges]
            stiffness = weighted_hinge_stiffness(e, h, lengths[topology.hinge_edges], pair)
            bend = hinge_term("bend", dofs, nodes, topology.hinges, stiffness)
        case "averaged":
            bend = midedge_averaged_term(
                "bend", dofs, nodes, triangles, topology.face_edges, topology.edge_faces,
                youngs_modulus=e, poisson_ratio=nu, thickness=h,
            )  # fmt: skip
        case _:
            frames = ShellFrames.of(
                dofs,
                NoFrames(),
                topology.edges,
                np.arange(len(topology.edges)),
                topology.edge_faces,
                triangles,
                driver,
            )
            bend = midedge_term(
                "bend", dofs, nodes, triangles, topology.face_edges, topology.face_signs, frames,
                youngs_modulus=e, poisson_ratio=nu, thickness=h,
            )  # fmt: skip
    if membrane == "cst":
        stretch = membrane_term(
            "membrane", dofs, nodes, triangles, youngs_modulus=e, poisson_ratio=nu, thickness=h
        )
    else:
        around = adjacent_areas(topology.edge_faces, areas)
        stretch = spring_term("membrane", dofs, topology.edges, lengths, area_springs(e, h, lengths, around))
    rest = np.concatenate((nodes.reshape(-1), np.zeros(free)))
    mass = shell_mass(dofs, triangles, areas, np.full(len(triangles), material.density * h))
    model = Model(dofs, rest, mass, (stretch, bend), (), frames, driver, float(lengths.mean()))
    return Shell(model, mesh, topology, areas)


def linear_solution(made: Shell, free: BoolArray, force: FloatArray) -> FloatArray:
    """Displacement (n,) under a small load: one linear solve with the tangent of the rest shape."""
    from scipy.sparse import triu
    from scipy.sparse.linalg import spsolve

    from dismech_cli.kernels.linearization import Linearization, all_symmetric
    from dismech_cli.model.configuration import Configuration
    from dismech_cli.solve.pattern import SparsityPattern

    model = made.model
    couplings = [c for t in model.terms for c in t.couplings]
    pattern = SparsityPattern.build(model.dofs, free, couplings, symmetric=all_symmetric(couplings))
    into = Linearization.of(model.dofs.n, pattern.slots)
    at = model.frames.transport(model.frames.rest(model.rest), model.rest)
    c = Configuration(0.0, model.rest, np.zeros(model.dofs.n), at)
    for term in model.terms:
        term.bind(pattern, model.driver).add_linearization(c, into)
    upper = pattern.csr(into.stiffness)
    out = np.zeros(model.dofs.n)
    out[pattern.free] = spsolve((upper + triu(upper, k=1).T).tocsc(), force[pattern.free])
    return out


def pressed(made: Shell, load: float) -> FloatArray:
    """Force (n,) of a load per area along z, a third of each triangle to its corners."""
    force = np.zeros(made.model.dofs.n)
    corners = made.mesh.triangles.reshape(-1)
    force[2 : made.model.dofs.n_positions : 3] = load * np.bincount(
        corners, np.repeat(made.areas / 3.0, 3), minlength=len(made.mesh.nodes)
    )
    return force
