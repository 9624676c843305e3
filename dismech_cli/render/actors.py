"""What moves in a picture: the surfaces of rods and shells."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..output.frame import Topology
from .chains import find_chains, find_junctions
from .coloring import Colors, body_colors
from .shell_solid import ShellSolid

_MESH_COLOR = "#101820"
_SIDES = 24
_MATERIAL = {
    "ambient": 0.34,
    "diffuse": 0.74,
    "specular": 0.26,
    "specular_power": 30.0,
    "interpolation": "Phong",
}


def _finish(actor: Any) -> None:
    for name, value in _MATERIAL.items():
        setattr(actor.prop, name, value)


class RodActor:
    """One surface for all rods: a tube along every chain, a ball at every junction."""

    def __init__(self, topology: Topology, least: float) -> None:
        import pyvista as pv

        chains = find_chains(topology.edges, topology.edge_radius, topology.edge_body)
        self._lengths = [len(chain.nodes) for chain in chains]
        self._nodes = np.concatenate([chain.nodes for chain in chains]) if chains else _no_nodes()
        self._radius = np.maximum(np.concatenate([[], *(chain.radius for chain in chains)]), least)
        bodies = np.repeat(np.array([chain.body for chain in chains], dtype=np.int64), self._lengths)
        self._own_colors = body_colors(bodies)
        self._junctions, radius, junction_bodies = find_junctions(chains)
        self._ball_radius = np.maximum(radius, least)
        self._ball_colors = body_colors(junction_bodies)
        self._ball: Any = pv.Sphere(radius=1.0, theta_resolution=_SIDES, phi_resolution=_SIDES)
        self._surface: Any = pv.PolyData()

    def add_to(self, plotter: Any) -> None:
        """Put it on the stage."""
        if not len(self._nodes):
            return
        actor = plotter.add_mesh(self._placeholder(), scalars="rgb", rgb=True)
        _finish(actor)

    def _placeholder(self) -> Any:
        import pyvista as pv

        self._surface = pv.PolyData(np.zeros((3, 3)), faces=[3, 0, 1, 2])
        self._surface["rgb"] = np.zeros((3, 3), dtype=np.uint8)
        return self._surface

    def move(self, positions: FloatArray, colors: Colors | None) -> None:
        """Place it; ``colors`` of all nodes replace those of the bodies, shape (N, 3)."""
        import pyvista as pv

        if not len(self._nodes):
            return
        starts = np.cumsum([0, *self._lengths[:-1]])
        lines = np.concatenate(
            [
                np.concatenate([[length], start + np.arange(length)])
                for start, length in zip(starts, self._lengths, strict=True)
            ]
        )
        path: Any = pv.PolyData(positions[self._nodes], lines=lines)
        path["rgb"] = self._own_colors if colors is None else colors[self._nodes]
        path["radius"] = self._radius
        surface = path.tube(scalars="radius", absolute=True, n_sides=_SIDES, capping=True)
        balls = self._balls(positions, colors)
        self._surface.copy_from(surface if balls is None else surface.append_polydata(balls))

    def _balls(self, positions: FloatArray, colors: Colors | None) -> Any:
        import pyvista as pv

        count = len(self._junctions)
        if not count:
            return None
        points = np.asarray(self._ball.points, dtype=np.float64)
        faces = self._ball.regular_faces
        shift = np.arange(count)[:, None, None] * len(points)
        placed = positions[self._junctions][:, None] + self._ball_radius[:, None, None] * points
        balls: Any = pv.PolyData.from_regular_faces(placed.reshape(-1, 3), (faces + shift).reshape(-1, 3))
        own = self._ball_colors if colors is None else colors[self._junctions]
        balls["rgb"] = np.repeat(own, len(points), axis=0)
        balls["radius"] = np.repeat(self._ball_radius, len(points))
        balls.point_data.active_normals = np.tile(points, (count, 1))
        return balls


class ShellActor:
    """The closed surface of one shell body."""

    def __init__(self, solid: ShellSolid, least: float) -> None:
        self._solid = solid
        self._least = least / 2
        self._own_colors = body_colors(np.full(len(solid.source), solid.body, dtype=np.int64))
        self._surface: Any = None

    def add_to(self, plotter: Any) -> None:
        """Put it on the stage."""
        import pyvista as pv

        points = np.zeros((len(self._solid.source), 3))
        faces: Any = self._solid.faces
        self._surface = pv.PolyData.from_regular_faces(points, faces)
        self._surface["rgb"] = self._own_colors
        self._surface.point_data.active_normals = points + np.array([0.0, 0.0, 1.0])
        # Each face of the thin solid has a twin behind it: hiding those turned away avoids flicker.
        actor = plotter.add_mesh(
            self._surface,
            scalars="rgb",
            rgb=True,
            culling="back",
            show_edges=True,
            edge_color=_MESH_COLOR,
            edge_opacity=0.25,
        )
        _finish(actor)

    def move(self, positions: FloatArray, colors: Colors | None) -> None:
        """Place it; ``colors`` of all nodes replace those of the bodies, shape (N, 3)."""
        vertices, normals = self._solid.vertices(positions, self._least)
        self._surface.points = vertices
        self._surface.point_data.active_normals = normals
        self._surface["rgb"] = self._own_colors if colors is None else colors[self._solid.source]


def _no_nodes() -> IntArray:
    return np.empty(0, dtype=np.int64)
