"""The order of edges where rods join shells, as in reference data: shell edges next to a joint are ghosts.

Reference codes bend and twist the edge of a rod at a shell against every edge of the triangles around it,
each with an angle of its own. Welds here need none of them (``energies/rod_shell.py``); what is compared with
the reference are the edges, faces, hinges and bending stencils that both must find.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dismech_cli.arrays import IntArray
from dismech_cli.mesh.topology.shells import ShellTopology, shell_edges


@dataclass(frozen=True, slots=True, kw_only=True)
class RodShellTopology:
    """Rods and shells joined: the global edge list is rod, joint, ghost, remaining shell edges.

    Edges that carry a twist angle come first, ``edges[:n_twist]``.

    Attributes:
        edges: All edges in global order, shape (n_edges, 2).
        n_rod: Rod edges away from the shell.
        n_joint: Rod edges that end at a shell node, turned so that the shell node is the head.
        n_ghost: Shell edges of the triangles around joint nodes: they carry a material frame to
            which the joint edges bend and twist.
        rod_source: Input rod edge of each of the first n_rod + n_joint edges.
        shell_source: Shell edge, in discovery order, of each of the others.
        face_edges: Global edge opposite each corner of each triangle, shape (T, 3).
        shell: Topology of the surface alone.
    """

    edges: IntArray
    n_rod: int
    n_joint: int
    n_ghost: int
    rod_source: IntArray
    shell_source: IntArray
    face_edges: IntArray
    shell: ShellTopology

    @property
    def n_twist(self) -> int:
        """Number of edges with a twist angle."""
        return self.n_rod + self.n_joint + self.n_ghost


def rod_shell_joints(edges: IntArray, triangles: IntArray) -> RodShellTopology:
    """Join rods to shells where they share nodes.

    Args:
        edges: Rod edges, shape (E, 2).
        triangles: Shape (T, 3).

    Raises:
        MeshError: If more than two triangles share an edge.
    """
    shell = shell_edges(triangles)
    on_shell = np.isin(edges, triangles)
    joined = on_shell.any(axis=1)
    rods, joints = np.flatnonzero(~joined), np.flatnonzero(joined)
    turned = np.where(on_shell[joints, :1], edges[joints][:, ::-1], edges[joints])
    ghosts = _ghosts(turned[:, 1], triangles, shell.face_edges)
    rest = np.setdiff1d(np.arange(len(shell.edges)), ghosts)
    shell_source = np.concatenate([ghosts, rest])
    offset = len(edges)
    place = np.empty(len(shell.edges), dtype=np.int64)
    place[shell_source] = np.arange(len(shell_source)) + offset
    return RodShellTopology(
        edges=np.concatenate([edges[rods], turned, shell.edges[shell_source]]),
        n_rod=len(rods),
        n_joint=len(joints),
        n_ghost=len(ghosts),
        rod_source=np.concatenate([rods, joints]),
        shell_source=shell_source,
        face_edges=place[shell.face_edges],
        shell=shell,
    )


def _ghosts(nodes: IntArray, triangles: IntArray, face_edges: IntArray) -> IntArray:
    """Shell edges of the triangles around each node in turn, each once, shape (n_ghost,)."""
    around = [np.empty(0, dtype=np.int64)]
    for node in nodes:
        around.append(face_edges[(triangles == node).any(axis=1)].ravel())
    listed = np.concatenate(around)
    return listed[np.sort(np.unique(listed, return_index=True)[1])]
