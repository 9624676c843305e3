"""How what is held moves: displacements that may differ from node to node, and rotations of all together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray, IntArray
from ...kinematics.rigid import Rigid, Turn
from ...laws.expression import compile_expression
from ...laws.laws import Constant, Law
from ...mesh.measure import edge_lengths
from ...mesh.topology.rods import ChainKind, chains
from ...scenario.language.motion import Clamp, Pin
from ...scenario.values.law import ExpressionLaw, LawSpec
from ..bodies.geometry import Geometry
from ..laws import vanishes
from ..scene import Scene

ZERO = Constant(0.0)
_SPACE = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class Path:
    """How held nodes move.

    Attributes:
        displacement: One law per space axis.
        places: Where it is asked for: 0 to 1 along the rod of each node, shape (K,); 0 where it is the same
            for all.
        turning: Rotations of all of them, before the displacement; None where nothing turns.
    """

    displacement: tuple[Law, Law, Law] = (ZERO, ZERO, ZERO)
    places: FloatArray | float = 0.0
    turning: Rigid | None = None

    @property
    def drives(self) -> bool:
        """Whether anything moves."""
        return self.turning is not None or not all(map(vanishes, self.displacement))


def path_of(scene: Scene, index: int, motion: Clamp | Pin, nodes: IntArray) -> Path:
    """The path of a motion.

    Args:
        scene: The scene.
        index: Place of the motion in the scenario's list.
        motion: What was said.
        nodes: Nodes whose positions are held, in the order in which the path is asked for, shape (K,).

    Raises:
        ScenarioError: A displacement depends on the place along a rod, but a node has none; or a rotation
            does not start from the rest shape.
    """
    places = along_rods(scene.geometry)[nodes]
    x, y, z = (_Laws(scene, index, nodes, places).law(axis, motion.displacement) for axis in range(3))
    return Path((x, y, z), places, _turning(scene, index, motion))


@dataclass(frozen=True, slots=True)
class _Laws:
    """What the laws of a displacement may depend on."""

    scene: Scene
    index: int
    nodes: IntArray
    places: FloatArray

    def law(self, axis: int, specs: tuple[LawSpec, ...] | None) -> Law:
        """Law of one component."""
        if specs is None:
            return ZERO
        spec, scene = specs[axis], self.scene
        if not isinstance(spec, ExpressionLaw):
            return scene.laws(spec)
        used = compile_expression(spec.expression, ("t", "s", *_SPACE)).variables
        if "s" in used and np.isnan(self.places).any():
            lone = self.nodes[int(np.argmax(np.isnan(self.places)))]
            raise scene.error(
                ("motions", self.index, "displacement", axis),
                f"'s' goes along a rod that is one open line, but node {lone} is on none",
            )
        here = used.intersection(_SPACE)
        columns = scene.geometry.nodes[self.nodes].T
        return scene.laws(spec, {name: columns[_SPACE.index(name)] for name in _SPACE if name in here})


def _turning(scene: Scene, index: int, motion: Clamp | Pin) -> Rigid | None:
    if motion.rotations is None:
        return None
    selected = scene.places.nodes(("motions", index, "where"))
    middle = scene.geometry.nodes[selected].mean(axis=0)
    turns = []
    for number, rotation in enumerate(motion.rotations):
        axis = np.array(rotation.axis)
        angle = scene.laws(rotation.angle)
        start = float(angle(0.0))
        if start != 0.0:
            raise scene.error(
                ("motions", index, "rotations", number, "angle"),
                f"is {start:.3g} rad at the start, where the scene is at rest: let it grow from 0, by a ramp",
            )
        centre = middle if rotation.center is None else np.array(rotation.center)
        turns.append(Turn(axis / np.linalg.norm(axis), angle, centre))
    return Rigid(f"motions[{index}]", tuple(turns))


def along_rods(geometry: Geometry) -> FloatArray:
    """Part of the length of its rod at which each node is, NaN where there is no such rod, shape (N,)."""
    out = np.full(len(geometry.nodes), np.nan)
    for rod in geometry.rods:
        edges = geometry.edges[geometry.rod_edges[rod.name]]
        pieces = chains(len(geometry.nodes), edges)
        if len(pieces) == 1 and pieces[0].kind is ChainKind.OPEN:
            (piece,) = pieces
            lengths = edge_lengths(geometry.nodes, edges[piece.edges])
            way = np.concatenate(([0.0], np.cumsum(lengths)))
            out[piece.nodes] = way / way[-1]
    return out
