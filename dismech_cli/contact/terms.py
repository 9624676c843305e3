"""The bound terms of contact: the energy of being too near, and friction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Protocol

import numpy as np

from ..arrays import FloatArray, IntArray, distinct
from ..kernels.linearization import Linearization, Pattern
from ..model.configuration import Configuration
from .drivers.loops import Loops
from .gather.stencils import Stencils
from .gather.touching import Touching
from .gather.upper import Sums
from .law.rubbing import slip

# Below this share of the speed over which friction grows it is all but linear.
_CREEP = 0.5

# Steps of differences of friction, of the deepest penetration: curvature leaves their fourth power.
_STEP, _TINY = 1e-3, 1e-300
_DIFFERENCE = ((1, 2.0 / 3.0), (-1, -2.0 / 3.0), (2, -1.0 / 12.0), (-2, 1.0 / 12.0))

NORMAL, FRICTION = "contact", "friction"


class Found(Protocol):
    """What the terms share: who touches whom."""

    @property
    def loops(self) -> Loops:
        """What sums over points."""

    @property
    def stencils(self) -> tuple[Stencils, ...]:
        """Nodes of all items that have places in the matrix, by kind."""

    def touching(self, c: Configuration) -> Sequence[Touching]:
        """What touches at a configuration."""

    def velocities(self, touching: Touching, c: Configuration, v: FloatArray) -> FloatArray:
        """Relative velocities at points of contact if the DOFs at ``c`` had velocities (n,), shape (3, K)."""

    def nodal(self, c: Configuration) -> tuple[FloatArray, FloatArray]:
        """Places and velocities of all nodes in space, each of shape (N, 3)."""


class NormalTerm:
    """The energy of lines that are too near; implements :class:`~dismech_cli.model.term.BoundChanging`."""

    name: ClassVar[str] = NORMAL
    shares: ClassVar[tuple[str, ...]] = (NORMAL,)
    symmetric: ClassVar[bool] = True
    _places: Sums

    def __init__(self, found: Found, *, steady: bool) -> None:
        self.steady = steady
        self._found = found

    @property
    def potential(self) -> NormalTerm:
        """Itself."""
        return self

    def place(self, pattern: Pattern) -> None:
        """Look the slots of all items up."""
        self._places = self._found.loops.sums(self._found.stencils, pattern)

    def heat(self, c: Configuration, v: FloatArray) -> float:
        """None."""
        return 0.0

    def energy(self, c: Configuration) -> FloatArray:
        """Energy of each point [J], shape (1, K)."""
        energies = [touching.points.energy for touching in self._found.touching(c)]
        return np.concatenate((np.empty(0), *energies))[None]

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Add dE/dq."""
        for touching in self._found.touching(c):
            points = touching.points
            self._found.loops.add_forces(touching, points.pull * points.gap, r)

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add dE/dq and d2E/dq2."""
        self._places.add(self._found.touching(c), into.residual, into.stiffness)

    def add_convex_linearization(self, c: Configuration, into: Linearization) -> None:
        """Add dE/dq and what its Hessian has along the gaps (Gauss and Newton)."""
        self._places.add_convex(self._found.touching(c), into.residual, into.stiffness)


class _Friction:
    """The force of friction, whatever its tangent."""

    name: ClassVar[str] = FRICTION
    potential: ClassVar[None] = None

    def __init__(self, found: Found, slip_speed: float) -> None:
        """Bind.

        Args:
            found: Who touches whom.
            slip_speed: Speed at which friction is all but full [m/s].
        """
        self._found = found
        # the family's K = 15 / slip speed; tanh(K u / 2) is 0.9999994 at the slip speed
        self._sharpness = 7.5 / slip_speed

    def forces(self, touching: Touching) -> FloatArray:
        """Friction at each point, against the motion of the line [N], shape (3, K)."""
        return touching.rubbing.friction(touching.friction, self._sharpness, touching.velocity)

    def add_residual(self, c: Configuration, r: FloatArray) -> None:
        """Subtract the force."""
        for touching in self._found.touching(c):
            self._found.loops.add_forces(touching, self.forces(touching), r)

    def heat(self, c: Configuration, v: FloatArray) -> float:
        """Force times slip at all points [W]."""
        return sum(
            float((self.forces(one) * self._found.velocities(one, c, v)).sum())
            for one in self._found.touching(c)
        )

    def reverses(self, touching: Touching, velocity: FloatArray) -> bool:
        """Whether the slip of a point turns round on the way to other velocities (3, K), and is no creep."""
        normal = touching.points.normal
        before, after = slip(touching.velocity, normal), slip(velocity, normal)
        creep = _CREEP / self._sharpness
        turned = ((before * after).sum(axis=0) < 0.0) & (self._size(before, after) > creep * creep)
        return bool((turned & (touching.points.load > 0.0) & (touching.friction > 0.0)).any())

    def _size(self, before: FloatArray, after: FloatArray) -> FloatArray:
        """Of the smaller of two slips (3, K), squared, shape (K,)."""
        out: FloatArray = np.minimum((before * before).sum(axis=0), (after * after).sum(axis=0))
        return out

    def _tangents(self, touching: Touching) -> tuple[FloatArray, FloatArray]:
        return touching.rubbing.friction_tangents(touching.friction, self._sharpness, touching.velocity)


class SymmetricFriction(_Friction):
    """Friction with the symmetric part of its tangent that changes with velocity.

    Newton's method takes a quarter more iterations, but the matrix stays symmetric. Implements
    :class:`~dismech_cli.model.term.BoundChanging`.
    """

    symmetric: ClassVar[bool] = True

    def place(self, pattern: Pattern) -> None:
        """Look the slots of all items up."""
        self._places = [
            self._found.loops.symmetric_places(stencils, pattern) for stencils in self._found.stencils
        ]

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its tangent to velocities."""
        for touching in self._found.touching(c):
            self._found.loops.add_forces(touching, self.forces(touching), into.residual)
            _, by_velocity = self._tangents(touching)
            self._places[touching.kind].add_symmetric(touching, by_velocity, into.damping)

    add_convex_linearization = add_linearization


class FullFriction(_Friction):
    """Friction with all of its tangent; implements :class:`~dismech_cli.model.term.BoundChanging`."""

    symmetric: ClassVar[bool] = False

    def place(self, pattern: Pattern) -> None:
        """Look the slots of all items up."""
        self._places = [
            self._found.loops.general_places(stencils, pattern) for stencils in self._found.stencils
        ]

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its tangents."""
        for touching in self._found.touching(c):
            self._found.loops.add_forces(touching, self.forces(touching), into.residual)
            by_position, by_velocity = self._tangents(touching)
            places, add = self._places[touching.kind], self._found.loops.add_general
            add(touching, places, by_position, into.stiffness)
            add(touching, places, by_velocity, into.damping)

    add_convex_linearization = add_linearization


class MeasuredFriction(FullFriction):
    """Friction with the slope that it has: as things move, so do the points at which it is summed.

    What :class:`FullFriction` says leaves that out, which Newton's method hardly notices. Here each item is
    moved by itself, one coordinate after the other, and its forces are compared.
    """

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its slopes."""
        x, v = self._found.nodal(c)
        for touching in self._found.touching(c):
            self._found.loops.add_forces(touching, self.forces(touching), into.residual)
            _, by_velocity = self._tangents(touching)
            places = self._places[touching.kind]
            self._found.loops.add_general(touching, places, by_velocity, into.damping)
            points = touching.points
            items = distinct(points.item[(touching.friction > 0.0) & (points.load != 0.0)])
            if len(items):
                places.add(items, self._by_position(touching, items, x, v), into.stiffness)

    add_convex_linearization = add_linearization

    def _by_position(self, touching: Touching, items: IntArray, x: FloatArray, v: FloatArray) -> FloatArray:
        """Slopes of the forces on the DOFs of some items to these, shape (R, n d, n d)."""
        assert touching.again is not None
        points, stencils, remake = touching.points, touching.stencils, touching.again(items)
        nodes, axes = stencils.nodes[items], stencils.axes
        places, speeds, own = x[nodes], v[nodes], touching.between.friction[items]
        step = _STEP * float((np.abs(points.load) / np.maximum(np.abs(points.growth), _TINY)).max())

        def forces(moved: FloatArray) -> FloatArray:
            found, velocity = remake(moved, speeds)
            vectors = found.weights[:, None] * found.friction(own[found.item], self._sharpness, velocity)
            out = np.zeros_like(places)
            np.add.at(out, found.item, vectors.transpose(2, 0, 1))
            return out[:, :, axes].reshape(len(items), -1)

        columns = []
        for node in range(nodes.shape[1]):
            for axis in axes:
                column = np.zeros((len(items), nodes.shape[1] * len(axes)))
                for offset, weight in _DIFFERENCE:
                    moved = places.copy()
                    moved[:, node, axis] += offset * step
                    column += weight / step * forces(moved)
                columns.append(column)
        return np.stack(columns, axis=2)


class AnchoredFriction(FullFriction):
    """Friction that grows with the way from an anchor, up to a length; see :mod:`.anchored_wall`."""

    def _size(self, way: FloatArray, velocity: FloatArray) -> FloatArray:
        """Of the way, squared: what goes back from far behind its anchor turns round."""
        out: FloatArray = (way * way).sum(axis=0)
        return out

    def add_linearization(self, c: Configuration, into: Linearization) -> None:
        """Subtract the force and add its tangents: a way changes as much as a place does."""
        loops = self._found.loops
        for touching in self._found.touching(c):
            loops.add_forces(touching, self.forces(touching), into.residual)
            by_position, by_way = self._tangents(touching)
            places = self._places[touching.kind]
            loops.add_general(touching, places, by_position + by_way, into.stiffness)

    add_convex_linearization = add_linearization
