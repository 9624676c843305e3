"""Fields over the robot, computed only when a frame asks for them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...kinematics.strains import material_curvatures
from ...mesh.measure import edge_lengths
from ...output.frame import FieldSpec
from ...output.viewer import DISPLACEMENT
from .corners import CornerStrains
from .snapshot import Snapshot

VELOCITY = FieldSpec(name="velocity", unit="m/s", long_name="nodal velocity", location="node", components=3)
CURVATURE = FieldSpec(name="curvature", unit="1/m", long_name="curvature of the centreline", location="node")
BENDING_MOMENT = FieldSpec(
    name="bending_moment", unit="N m", long_name="magnitude of the bending moment", location="node"
)
TWIST = FieldSpec(name="twist", unit="rad/m", long_name="material twist per length", location="node")
AXIAL_STRAIN = FieldSpec(
    name="axial_strain", unit="1", long_name="axial strain from the rest length", location="cell"
)
AXIAL_FORCE = FieldSpec(
    name="axial_force", unit="N", long_name="axial force, tension positive", location="cell"
)
DIRECTOR = FieldSpec(
    name="director", unit="1", long_name="first material director m1", location="cell", components=3
)


class Field(Protocol):
    """A field with its description."""

    @property
    def spec(self) -> FieldSpec:
        """Name, unit, place."""

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values at every node or cell."""


@frozen
class VelocityField:
    """Nodal velocity."""

    visible: int
    spec: FieldSpec = VELOCITY

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N, 3)."""
        return s.velocities[: self.visible]


@frozen
class DisplacementField:
    """Displacement from the rest positions (N, 3)."""

    rest: FloatArray
    spec: FieldSpec = DISPLACEMENT

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N, 3)."""
        return s.positions[: len(self.rest)] - self.rest


@frozen
class CurvatureField:
    """Curvature |kappa b| / l_v of the centreline; zero at free ends, the largest at junctions.

    At corners it is what they have bent from rest: their angle is no curvature.
    """

    visible: int
    triples: IntArray
    voronoi: FloatArray
    corners: CornerStrains
    spec: FieldSpec = CURVATURE

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N,)."""
        density = np.linalg.norm(s.binormals(self.triples), axis=1) / self.voronoi
        nodes = np.concatenate((self.triples[:, 1], self.corners.nodes))
        return _largest_at(nodes, np.concatenate((density, self.corners.curvature(s))), self.visible)


@frozen
class MomentField:
    """Elastic bending moment; framed rods: (EI1 (k1 - k1_0), EI2 (k2 - k2_0)) / l_v."""

    visible: int
    triples: IntArray
    voronoi: FloatArray
    measure: Curvatures
    corners: CornerStrains
    spec: FieldSpec = BENDING_MOMENT

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N,)."""
        moments = self.measure(s) / self.voronoi
        size = np.concatenate((np.sqrt((moments**2).sum(axis=0)), self.corners.moment(s)))
        nodes = np.concatenate((self.triples[:, 1], self.corners.nodes))
        return _largest_at(nodes, size, self.visible)


class Curvatures(Protocol):
    """EI (kappa - kappa_0) of each joint, one row per direction."""

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (1 or 2, J) [N m^2]."""


@frozen
class NoCurvatures:
    """Where no joint bends."""

    def __call__(self, s: Snapshot) -> FloatArray:
        """No values (1, 0)."""
        return np.empty((1, 0))


@frozen
class BinormalCurvatures:
    """For straight or planar rods: EI (|kappa b| - kappa_0); an isotropic rod has no kappa_0.

    Attributes:
        triples: Nodes of the joints, shape (J, 3).
        stiffness: EI [N m^2], shape (J,).
        energy: Name of the bending energy.
        normal: Of the plane, or None in space.
    """

    triples: IntArray
    stiffness: FloatArray
    energy: str
    normal: FloatArray | None

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (1, J)."""
        kb = s.binormals(self.triples)
        kappa = np.linalg.norm(kb, axis=1) if self.normal is None else kb @ self.normal
        # one row of natural strain, or none
        moments: FloatArray = self.stiffness * (kappa - s.natural(self.energy).sum(axis=0))
        return moments[None]


@frozen
class MaterialCurvatures:
    """For framed rods: both material directions.

    Attributes:
        triples: Nodes of the joints, shape (J, 3).
        stiffness: EI_1 and EI_2 [N m^2], shape (2, J).
        energy: Name of the bending energy; its first natural strains are the curvatures.
        places: Of the directors in the auxiliary array.
        angles: Angle DOFs of the edges at the joints, shape (J, 2).
        signs: Of the edges at the joints, shape (J, 2).
        rest_twist: At the joints [rad], shape (J,).
    """

    triples: IntArray
    stiffness: FloatArray
    energy: str
    places: IntArray
    angles: IntArray
    signs: FloatArray
    rest_twist: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (2, J)."""
        kappa = material_curvatures(
            s.binormals(self.triples),
            s.frames.auxiliary,
            self.places,
            self.signs,
            joint_twist(s, self.angles, self.signs),
            self.rest_twist,
        )
        return self.stiffness * (kappa - s.natural(self.energy)[:2])


@frozen
class TwistField:
    """Twist per length of framed rods."""

    visible: int
    centres: IntArray
    voronoi: FloatArray
    angles: IntArray
    signs: FloatArray
    corners: CornerStrains
    spec: FieldSpec = TWIST

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N,)."""
        tau = joint_twist(s, self.angles, self.signs) / self.voronoi
        out = np.zeros(len(s.positions))
        nodes = np.concatenate((self.centres, self.corners.nodes))
        np.add.at(out, nodes, np.concatenate((tau, self.corners.twist(s))))
        count = np.bincount(nodes, minlength=len(out))
        return (out / np.maximum(count, 1))[: self.visible]


@frozen
class AxialStrainField:
    """Axial strain of edges from their rest lengths."""

    edges: IntArray
    rest: FloatArray
    spec: FieldSpec = AXIAL_STRAIN

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (E,)."""
        return edge_lengths(s.positions, self.edges) / self.rest - 1.0


@frozen
class AxialForceField:
    """Tension of the edges: EA times the elastic part of the axial strain, or that of rubber.

    Attributes:
        edges: Shape (E, 2).
        axial: Energy, tension and slope by length, natural strain and constants.
        constants: Of the stretching energy, shape (C, E).
        energy: Its name.
    """

    edges: IntArray
    axial: Callable[..., Any]
    constants: FloatArray
    energy: str
    spec: FieldSpec = AXIAL_FORCE

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (E,)."""
        (natural,) = s.natural(self.energy)
        force: FloatArray = self.axial(edge_lengths(s.positions, self.edges), natural, *self.constants)[1]
        return force


@frozen
class DirectorField:
    """First material director of framed rods.

    Attributes:
        places: Of its components in the auxiliary array, shape (E, 3).
    """

    places: IntArray
    spec: FieldSpec = DIRECTOR

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (E, 3)."""
        return s.frames.auxiliary[self.places]


def joint_twist(s: Snapshot, angles: IntArray, signs: FloatArray) -> FloatArray:
    """Twist of the directors across each joint [rad], shape (J,)."""
    theta = s.state.q[angles] * signs
    twist: FloatArray = theta[:, 1] - theta[:, 0] + s.state.frames.reference_twist
    return twist


def _largest_at(nodes: IntArray, values: FloatArray, count: int) -> FloatArray:
    out = np.zeros(max(int(nodes.max(initial=-1)) + 1, count))
    np.maximum.at(out, nodes, values)
    return out[:count]
