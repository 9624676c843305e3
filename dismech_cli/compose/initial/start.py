"""Where a run starts: at rest, as another run was, or displaced; and how fast."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...arrays import FloatArray
from ...csv_columns import read_columns
from ...errors import ScenarioError
from ...frozen import frozen
from ...kinematics.motion import Prescribed, Since
from ...model.state import State
from ...scenario.language.initial import Displaced, FromRun, PositionFile
from ...scenario.text.tree import KeyPath
from ..laws import dynamic_laws
from ..scene import Scene
from ..structure.paths import laws_of_places
from ..structure.structure import Structure
from ..structure.velocities import initial_velocity
from .hubs import settled
from .known import known_state
from .mapped import Started, mapped

# What is held starts where it is held, to this share of the size of the scene, and to this angle [rad].
_HELD = 1e-6


@frozen
class Start:
    """The start of a run.

    Attributes:
        state: The state at t = 0.
        kept: A file that stands for the run it is from; empty where it is from none.
    """

    state: State
    kept: bytes = b""


def make_start(scene: Scene, structure: Structure, motions: Sequence[Prescribed]) -> Start:
    """The start that the scenario asks for.

    Raises:
        ScenarioError: The state is not one of this scene, or a motion holds something elsewhere.
    """
    initial, kept = scene.scenario.initial, b""
    if initial is None:
        q = structure.rest.copy()
        started = Started(q, np.zeros_like(q), structure.frames.rest(q))
    elif isinstance(initial, FromRun):
        try:
            known = known_state(scene.loaded.directory / initial.run, initial)
            started = mapped(known, scene.geometry, structure)
        except ScenarioError as error:
            raise scene.error(("initial", "run"), f"{initial.run}: {error}") from error
        kept = known.packed()
        if initial.at_rest or structure.plan.static:
            started = replace(started, v=np.zeros_like(started.v))
    else:
        started = _displaced(scene, structure, initial.displacements)
    v = initial_velocity(scene, structure.dofs, started.v)
    state = State(0.0, started.q, v, np.zeros_like(v), started.frames)
    if initial is not None:
        _check_holds(scene, structure, motions, state)
    return Start(state, kept)


def _displaced(scene: Scene, structure: Structure, entries: Sequence[Displaced]) -> Started:
    dofs, skeleton = structure.dofs, structure.skeleton
    moved = np.zeros((dofs.n_nodes, 3))
    hidden = [axis for axis in range(3) if axis not in dofs.axes]
    for index, entry in enumerate(entries):
        path: KeyPath = ("initial", "displacements", index)
        nodes = scene.places.nodes((*path, "where"))
        values = _values(scene, (*path, "displacement"), entry)
        if np.any(values[:, hidden]):
            raise scene.error((*path, "displacement"), "has a part out of the plane of the scene")
        moved[nodes] = values
    # a wall goes on straight behind its rod
    for k, (node, owner) in enumerate(zip(skeleton.wall_nodes, skeleton.owners, strict=True)):
        (other,) = set(scene.geometry.edges[owner].tolist()) - {int(node)}
        moved[skeleton.visible + k] = 2.0 * moved[node] - moved[other]
    rest = structure.rest
    q = rest.copy()
    q[: dofs.n_positions] += dofs.project(moved).reshape(-1)
    q = settled(structure, q)
    frames = structure.frames.transport(structure.frames.rest(rest), q).state
    edges = structure.shell_edges.edges
    if len(edges):
        # what is free has the normals of its faces, as at rest
        held = np.zeros(len(edges), dtype=np.bool_)
        for hold in structure.holds:
            held |= np.isin(edges, hold.sloped).all(axis=1)
        free = structure.normals.turned_to_faces(frames, q)
        frames = replace(frames, edge_normal=np.where(held, frames.edge_normal, free))
    return Started(q, np.zeros_like(q), frames)


def _values(scene: Scene, path: KeyPath, entry: Displaced) -> FloatArray:
    """Displacement of each selected node [m], shape (K, 3)."""
    nodes = scene.places.nodes((*path[:-1], "where"))
    if not isinstance(entry.displacement, PositionFile):
        # numbers as they are written: in statics too, where those of loads grow
        laws = dynamic_laws(scene.loaded.directory)
        found = laws_of_places(scene, path, nodes, entry.displacement, laws)
        return np.stack([np.broadcast_to(law(0.0, found.places), len(nodes)) for law in found.laws], axis=1)
    columns = read_columns(scene.loaded.directory / entry.displacement.file, entry.displacement.columns)
    values = np.stack(columns, axis=1)
    if len(values) != len(nodes):
        raise scene.error(path, f"the file has {len(values)} rows for {len(nodes)} selected nodes")
    return values


def _check_holds(scene: Scene, structure: Structure, motions: Sequence[Prescribed], state: State) -> None:
    """Refuse a start from which what is held would leap to where it is held."""
    dofs = structure.dofs
    size = float(np.ptp(dofs.positions(structure.rest), axis=0).max())
    since, q = Since(0.0, state.q, state.frames), state.q.copy()
    for motion in motions:
        values = motion.values(0.0, q, since)
        off = np.abs(values - state.q[motion.dofs])
        far = off / np.where(motion.dofs < dofs.n_positions, size, 1.0)
        if far.max() > _HELD:
            worst = int(np.argmax(far))
            dof = int(motion.dofs[worst])
            unit = "m" if dof < dofs.n_positions else "rad"
            raise scene.error(
                ("initial",),
                f"{motion.name}: holds {dofs.describe(dof)} {off[worst]:.3g} {unit} from where the run "
                "starts: it would leap there; let the motion begin at the start",
            )
