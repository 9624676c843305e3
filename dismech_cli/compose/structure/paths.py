"""How what is held moves: displacements that may differ from node to node, and rotations of all together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray, IntArray
from ...errors import LawError
from ...frozen import frozen
from ...kinematics.rigid import Rigid, Turn
from ...laws.expression import compile_expression
from ...laws.laws import Constant, Law
from ...mesh.measure import edge_lengths
from ...mesh.topology.rods import ChainKind, chains
from ...scenario.language.motion import Clamp, Pin
from ...scenario.text.tree import KeyPath
from ...scenario.values.law import ExpressionLaw, LawSpec
from ..bodies.geometry import Geometry
from ..laws import ToLaw, vanishes
from ..scene import Scene

ZERO = Constant(0.0)
_SPACE = ("x", "y", "z")


@frozen
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
    turning = _turning(scene, index, motion)
    if motion.displacement is None:
        return Path(turning=turning)
    key = ("motions", index, "displacement")
    found = laws_of_places(scene, key, nodes, motion.displacement, scene.laws)
    x, y, z = found.laws
    return Path((x, y, z), found.places, turning)


@frozen
class PlacedLaws:
    """Laws that may differ from node to node.

    Attributes:
        laws: One per component.
        places: What they are asked for with: 0 to 1 along the rod of each node, shape (K,).
    """

    laws: tuple[Law, ...]
    places: FloatArray


def laws_of_places(
    scene: Scene, path: KeyPath, nodes: IntArray, specs: Sequence[LawSpec], to_law: ToLaw
) -> PlacedLaws:
    """The laws of a vector at nodes.

    Args:
        scene: The scene.
        path: Key of the vector.
        nodes: Where, shape (K,).
        specs: What was said of each component.
        to_law: How it is taken.

    Raises:
        ScenarioError: One depends on the place along a rod, but a node has none; or has no value at
            the start.
    """
    places = along_rods(scene.geometry)[nodes]
    columns = dict(zip(_SPACE, scene.geometry.nodes[nodes].T, strict=True))
    laws = []
    for axis, spec in enumerate(specs):
        used = frozenset[str]()
        if isinstance(spec, ExpressionLaw):
            used = compile_expression(spec.expression, ("t", "s", *_SPACE)).variables
        if "s" in used and np.isnan(places).any():
            lone = nodes[int(np.argmax(np.isnan(places)))]
            raise scene.error(
                (*path, axis), f"'s' goes along a rod that is one open line, but node {lone} is on none"
            )
        law = to_law(spec, {name: columns[name] for name in _SPACE if name in used})
        try:
            law(0.0, places)
        except LawError as error:
            raise scene.error((*path, axis), str(error)) from error
        laws.append(law)
    return PlacedLaws(tuple(laws), places)


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
        if start != 0.0 and scene.scenario.initial is None:
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
