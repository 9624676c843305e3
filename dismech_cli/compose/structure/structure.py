"""What moves, with its DOFs and frames: decided once, read by every stage after it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import FloatArray, median
from ...frozen import frozen
from ...kernels.driver import Driver
from ...kinematics.dofs import DofMap
from ...kinematics.rod_frames import Frames, NoFrames
from ...kinematics.shell_frames import ShellFrames
from ...mesh.measure import edge_lengths
from ..numerics import build_driver
from ..scene import Scene
from ..shells.topology import ShellEdges, find_shell_edges
from .frames import given_directors, rest_directors, rod_frames
from .holds import Hold
from .masses import point_masses
from .numbering import number_dofs
from .plan import Bending, Plan
from .skeleton import Skeleton, make_skeleton


@frozen(kw_only=True)
class Structure:
    """The scene as the plan wants it, before its energies and loads.

    Attributes:
        plan: What was decided.
        holds: Motions.
        skeleton: Rod edges and joints, walls included.
        shell_edges: Edges of the shells, and those that carry a normal.
        dofs: Numbering.
        rest: Rest configuration q, shape (n,).
        rod_frames: Frames of the rods, or their absence.
        normals: Frames of those, then of the shell edges that carry a normal.
        payload: Point mass of each node [kg], shape (n_nodes,).
        driver: Runs the kernels.
    """

    plan: Plan
    holds: tuple[Hold, ...]
    skeleton: Skeleton
    shell_edges: ShellEdges
    dofs: DofMap
    rest: FloatArray
    rod_frames: Frames
    normals: ShellFrames
    payload: FloatArray
    driver: Driver

    @property
    def positions(self) -> FloatArray:
        """Rest positions of all nodes with DOFs [m], shape (n_nodes, 3)."""
        return self.skeleton.positions

    @property
    def frames(self) -> Frames:
        """Frames of the whole scene, no more than it has."""
        return self.normals if len(self.shell_edges.edges) else self.rod_frames

    def run_by(self, driver: Driver) -> Structure:
        """The same with frames that another driver carries."""
        rods = self.rod_frames.run_by(driver)
        return replace(self, rod_frames=rods, normals=self.normals.run_by(driver), driver=driver)


def make_structure(scene: Scene, holds: tuple[Hold, ...], plan: Plan) -> Structure:
    """Do as planned.

    Raises:
        ScenarioError: The director of a rod lies along it.
    """
    skeleton = make_skeleton(scene.geometry, holds)
    edges = find_shell_edges(scene.geometry)
    numbering = number_dofs(plan, skeleton, edges)
    dofs, driver = numbering.dofs, build_driver(plan.kernels)
    given = given_directors(scene, skeleton)
    rods: Frames = NoFrames()
    if plan.bending is Bending.FRAMED:
        rods = rod_frames(skeleton, dofs, driver, rest_directors(skeleton, given))
    return Structure(
        plan=plan,
        holds=holds,
        skeleton=skeleton,
        shell_edges=edges,
        dofs=dofs,
        rest=numbering.rest,
        rod_frames=rods,
        normals=_normals(dofs, rods, edges, driver),
        payload=point_masses(scene, dofs.n_nodes),
        driver=driver,
    )


def _normals(dofs: DofMap, rods: Frames, edges: ShellEdges, driver: Driver) -> ShellFrames:
    return ShellFrames.of(dofs, rods, edges.edges, edges.normals, edges.edge_faces, edges.triangles, driver)


def typical_length(scene: Scene, structure: Structure) -> float:
    """Median length of the edges of rods and shells [m]."""
    geometry = scene.geometry
    bodies = structure.shell_edges.bodies.values()
    sides = [edge_lengths(geometry.nodes, body.topology.edges) for body in bodies]
    return median(np.concatenate((geometry.lengths, *sides)))
