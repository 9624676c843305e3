"""Imperfections: soft modes of the perfect scene as small deviations of its nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import FloatArray, IntArray, distinct
from ..frozen import frozen
from ..kinematics.dofs import DofMap
from ..kinematics.motion import held_dofs
from ..kinematics.rod_frames import Frames
from ..mesh.topology.components import components
from ..mesh.topology.sides import half_edges
from ..model.model import Model
from ..model.state import State
from ..scenario.language.imperfection import Imperfection
from ..solve.linear.modes import softest_modes
from ..solve.stage import at_state
from ..solve.system import System
from .bodies.geometry import Geometry
from .scene import Scene
from .structure.plan import Decision

# Modes that a random imperfection mixes; those that may be rigid, of each body.
_MIXED, _RIGID = 10, 6
# A mode is rigid that leaves this share of it to no rigid motion.
_RIGIDLY = 1e-5
# Eigenvalues this near to each other are one, whose modes any rotation may mix.
_EQUAL = 1e-6
# Decimals of the share of the amplitude: no rounding of eigenvectors changes a run that is resumed.
_DECIMALS = 8


@frozen
class Deviation:
    """What an imperfection does.

    Attributes:
        told: How it is told; nothing for none.
        offsets: By how much the nodes of the bodies are made to deviate [m], shape (N, 3), or 0.
        push: By how much they are only pushed at the start, likewise.
    """

    told: tuple[Decision, ...]
    offsets: FloatArray | float
    push: FloatArray | float

    def made(self, scene: Scene) -> Scene:
        """The scene with its bodies made in the imperfect shape; places stay where they were found."""
        nodes = scene.geometry.nodes + self.offsets
        return replace(scene, geometry=replace(scene.geometry, nodes=nodes))

    def pushed(self, start: State, dofs: DofMap, frames: Frames) -> State:
        """The start of a run, pushed off."""
        if not np.any(self.push):
            return start
        push, q = np.broadcast_to(self.push, (dofs.visible, 3)), start.q.copy()
        q[dofs.of_nodes(np.arange(dofs.visible)).ravel()] += dofs.project(push).ravel()
        return replace(start, q=q, frames=frames.transport(start.frames, q).state)


NO_DEVIATION = Deviation((), 0.0, 0.0)
"""That of a perfect scene."""


def find_deviation(spec: Imperfection, scene: Scene, perfect: Model, mass: FloatArray) -> Deviation:
    """The deviation that an imperfection asks for.

    Args:
        spec: The imperfection.
        scene: The perfect scene.
        perfect: Its model with elastic terms alone.
        mass: Diagonal of its mass matrix, shape (n,); in statics too.

    Raises:
        ScenarioError: The scene has fewer modes, or they cannot be found.
    """
    wanted = _MIXED if spec.mode == "random" else spec.mode
    try:
        shapes = _soft_shapes(scene.geometry, perfect, mass, wanted)
    except ArithmeticError as error:
        raise scene.error(("imperfection", "mode"), f"no modes can be found: {error}") from error
    if not shapes or (spec.mode != "random" and len(shapes) < spec.mode):
        raise scene.error(("imperfection", "mode"), f"the scene has {len(shapes)} modes")
    if spec.mode == "random":
        generator = np.random.default_rng(spec.seed or 0)
        weights = generator.standard_normal(len(shapes)) / np.arange(1, len(shapes) + 1)
        shape = np.tensordot(weights, np.array(shapes), axes=1)
        what = f"{len(shapes)} soft modes mixed by seed {spec.seed or 0}"
    else:
        shape, what = shapes[spec.mode - 1], f"soft mode {spec.mode}"
    size = np.linalg.norm(shape, axis=1)
    largest = int(np.argmax(np.round(size / size.max(), _DECIMALS)))
    share = np.round(shape / size[largest], _DECIMALS)
    at = ", ".join(f"{x:.3g}" for x in scene.geometry.nodes[largest])
    free = "stress-free" if spec.stress_free else "as a push at the start"
    told = Decision(
        f"imperfection: {what}, up to {spec.amplitude:.3g} m, {free}", f"asked for; largest at ({at}) m"
    )
    offsets = spec.amplitude * share
    return Deviation((told,), offsets, 0.0) if spec.stress_free else Deviation((told,), 0.0, offsets)


def _soft_shapes(geometry: Geometry, model: Model, mass: FloatArray, wanted: int) -> list[FloatArray]:
    """The softest modes that strain, as displacements of the nodes (N, 3), each with a definite sign."""
    held = held_dofs(model.motions, model.dofs.n, 0.0)
    system = System(model, ~held)
    rest = model.rest
    state = State(0.0, rest, np.zeros_like(rest), np.zeros_like(rest), model.frames.rest(rest))
    values = system.linearize(at_state(state), rest, state.frames).values.copy()
    sides = np.concatenate((geometry.edges, half_edges(geometry.triangles)))
    number, piece = components(len(geometry.nodes), sides)
    count = wanted + _RIGID * number + 2
    with np.errstate(all="ignore"):
        sizes, vectors = softest_modes(
            system.pattern, system.solver, values, _with_inertia(mass)[system.pattern.free], count
        )
    strained = np.flatnonzero(
        [not _rigid(geometry.nodes, piece, v) for v in _shapes(geometry, system, vectors)]
    )
    sizes, vectors = sizes[strained], vectors[:, strained]
    for first in range(len(sizes)):
        same = np.flatnonzero(np.abs(sizes - sizes[first]) <= _EQUAL * np.abs(sizes[first]))
        if len(same) > 1 and same[0] == first:
            vectors[:, same] = _along_axes(vectors[:, same], _shapes(geometry, system, vectors[:, same]))
    return [_signed(shape) for shape in _shapes(geometry, system, vectors[:, :wanted])]


def _with_inertia(mass: FloatArray) -> FloatArray:
    """Masses; what has none follows the rest, as if it were very light."""
    return np.where(mass > 0.0, mass, 1e-6 * np.median(mass[mass > 0.0]))


def _shapes(geometry: Geometry, system: System, vectors: FloatArray) -> list[FloatArray]:
    """Displacements of the nodes of the bodies, shape (N, 3), of each column."""
    dofs, shapes = system.model.dofs, []
    for vector in vectors.T:
        q = np.zeros(dofs.n)
        q[system.pattern.free] = vector
        shapes.append(dofs.embed(dofs.positions(q))[: len(geometry.nodes)])
    return shapes


def _rigid(nodes: FloatArray, piece: IntArray, shape: FloatArray) -> bool:
    """Whether every piece moves or turns as a whole."""
    left = 0.0
    for label in distinct(piece):
        mine = np.flatnonzero(piece == label)
        arms = nodes[mine] - nodes[mine].mean(axis=0)
        size = float(np.abs(arms).max()) or 1.0
        turns = [np.cross(np.broadcast_to(axis, arms.shape), arms / size).ravel() for axis in np.eye(3)]
        moves = [np.broadcast_to(axis, arms.shape).ravel() for axis in np.eye(3)]
        motions = np.stack((*moves, *turns), axis=1)
        fitted = motions @ np.linalg.lstsq(motions, shape[mine].ravel(), rcond=None)[0]
        left += float(((shape[mine].ravel() - fitted) ** 2).sum())
    return left <= _RIGIDLY**2 * float((shape**2).sum())


def _along_axes(vectors: FloatArray, shapes: list[FloatArray]) -> FloatArray:
    """Equally soft modes, mixed so that each moves along one axis as far as may be: x, then y, z."""
    flat = np.array(shapes) * np.array([1.0, 2.0, 3.0])
    _, mix = np.linalg.eigh(np.einsum("ank,bnk->ab", flat, flat))
    return np.asarray(vectors @ mix)


def _signed(shape: FloatArray) -> FloatArray:
    """The shape with its largest component positive, the first of those as large but for rounding."""
    flat = shape.ravel()
    largest = int(np.argmax(np.round(np.abs(flat) / np.abs(flat).max(), 6)))
    return shape if flat[largest] > 0.0 else -shape
