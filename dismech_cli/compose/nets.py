"""Nets whose ends are pushed together: among the many ways they buckle, Newton's method may go astray."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..kinematics.motion import Since, held_dofs, prescribe
from ..mesh.topology.components import components
from ..model.model import Model
from ..scenario.language.numerics import Static
from .scene import Scene
from .structure.plan import Decision

# Held nodes that come nearer to each other by more than this share of their distance push what is between
# them in: the rods of a net are longer than 20 radii, and such buckle below (pi / 40)^2.
_PUSHED_IN = 0.01
# Nodes at a corner of a net may come as near as they like: pairs count from this share of the farthest on.
_ACROSS = 0.5
# Pairs of more held nodes than these are not looked at one by one.
_MANY = 500


def net_decisions(scene: Scene, model: Model) -> Iterator[Decision]:
    """What to choose where the statics of a net may buckle in many ways."""
    integrator = scene.scenario.numerics.integrator
    if not isinstance(integrator, Static) or integrator.path is not None or integrator.method != "newton":
        return
    nearer = max((_nearer(model, net) for net in _nets(scene)), default=0.0)
    if nearer > _PUSHED_IN:
        yield Decision(
            "equilibria by Newton's method",
            f"what holds the net brings its ends nearer to each other by {nearer:.0%}: it may buckle in many "
            "ways, among which Newton's method can go astray; damped motion to rest is slower and does not: "
            "--set numerics.integrator.method=relax",
        )


def _nets(scene: Scene) -> Iterator[BoolArray]:
    """Masks of the nodes of each piece of rods that branches and closes loops, shape (N,)."""
    edges, n = scene.geometry.edges, len(scene.geometry.nodes)
    degree = np.bincount(edges.reshape(-1), minlength=n)
    number, part = components(n, edges)
    nodes = np.bincount(part, minlength=number)
    loops = np.bincount(part[edges[:, 0]], minlength=number) - nodes + 1
    branches = np.bincount(part[degree > 2], minlength=number)
    for label in np.flatnonzero((loops > 0) & (branches > 0)):
        yield part == label


def _nearer(model: Model, member: BoolArray) -> float:
    """Largest share of their distance at rest by which two held nodes of a net come nearer in the end."""
    dofs = model.dofs
    end = model.rest.copy()
    prescribe(model.motions, end, 1.0, Since(0.0, model.rest, model.frames.rest(model.rest)))
    held = held_dofs(model.motions, dofs.n, 1.0)[dofs.of_nodes(np.arange(len(member)))]
    nodes = np.flatnonzero(held.all(axis=1) & member)
    nodes = nodes[:: len(nodes) // _MANY + 1]
    if len(nodes) < 2:
        return 0.0
    before, after = (_distances(dofs.positions(q), nodes) for q in (model.rest, end))
    across = before > _ACROSS * before.max()
    return float((1.0 - after / before)[across].max())


def _distances(positions: FloatArray, nodes: IntArray) -> FloatArray:
    """Between all pairs of nodes [m]."""
    from scipy.spatial.distance import pdist

    distances: FloatArray = pdist(positions[nodes])
    return distances
