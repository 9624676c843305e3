"""Fields over the robot, computed only when a frame asks for them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..arrays import FloatArray, IntArray
from ..model.strains import curvature_binormal, lengths, material_curvatures
from ..output.frame import FieldSpec
from .snapshot import Snapshot

VELOCITY = FieldSpec(name="velocity", unit="m/s", long_name="nodal velocity", location="node", components=3)
CURVATURE = FieldSpec(name="curvature", unit="1/m", long_name="curvature of the centreline", location="node")
BENDING_MOMENT = FieldSpec(
    name="bending_moment", unit="N m", long_name="magnitude of the bending moment", location="node"
)
TWIST = FieldSpec(name="twist", unit="rad/m", long_name="material twist per length", location="node")
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


@dataclass(frozen=True, slots=True)
class VelocityField:
    """Nodal velocity."""

    visible: int
    spec: FieldSpec = VELOCITY

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N, 3)."""
        return s.velocities[: self.visible]


@dataclass(frozen=True, slots=True)
class CurvatureField:
    """Curvature |kappa b| / l_v of the centreline; zero at free ends, the largest at junctions."""

    visible: int
    triples: IntArray
    voronoi: FloatArray
    spec: FieldSpec = CURVATURE

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N,)."""
        density = np.linalg.norm(curvature_binormal(s.positions, self.triples), axis=1) / self.voronoi
        return _largest_at(self.triples[:, 1], density, self.visible)


@dataclass(frozen=True, slots=True)
class MomentField:
    """Elastic bending moment; framed rods: (EI1 (k1 - k1_0), EI2 (k2 - k2_0)) / l_v."""

    visible: int
    triples: IntArray
    voronoi: FloatArray
    measure: Curvatures
    spec: FieldSpec = BENDING_MOMENT

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N,)."""
        moments = self.measure(s) / self.voronoi
        return _largest_at(self.triples[:, 1], np.sqrt((moments**2).sum(axis=0)), self.visible)


class Curvatures(Protocol):
    """EI (kappa - kappa_0) of each joint, one row per direction."""

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (1 or 2, J) [N m^2]."""


@dataclass(frozen=True, slots=True)
class BinormalCurvatures:
    """For straight or planar rods: EI (|kappa b| - kappa_0)."""

    triples: IntArray
    stiffness: FloatArray
    natural: FloatArray
    normal: FloatArray | None

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (1, J)."""
        kb = curvature_binormal(s.positions, self.triples)
        kappa = np.linalg.norm(kb, axis=1) if self.normal is None else kb @ self.normal
        return (self.stiffness * (kappa - self.natural))[None]


@dataclass(frozen=True, slots=True)
class MaterialCurvatures:
    """For framed rods: both material directions."""

    triples: IntArray
    stiffness: FloatArray
    natural: FloatArray
    places: IntArray
    signs: FloatArray
    rest_twist: FloatArray

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (2, J)."""
        kappa = material_curvatures(
            s.positions, self.triples, s.frames.auxiliary, self.places, self.signs, self.rest_twist
        )
        return self.stiffness * (kappa - self.natural)


@dataclass(frozen=True, slots=True)
class TwistField:
    """Twist per length of framed rods."""

    visible: int
    centres: IntArray
    voronoi: FloatArray
    angles: IntArray
    signs: FloatArray
    spec: FieldSpec = TWIST

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (N,)."""
        theta = s.state.q[self.angles] * self.signs
        tau = (theta[:, 1] - theta[:, 0] + s.state.frames.reference_twist) / self.voronoi
        out = np.zeros(len(s.positions))
        np.add.at(out, self.centres, tau)
        count = np.bincount(self.centres, minlength=len(out))
        return (out / np.maximum(count, 1))[: self.visible]


@dataclass(frozen=True, slots=True)
class AxialField:
    """Axial strain of edges, times a stiffness less a natural strain: a force if that is EA."""

    edges: IntArray
    rest: FloatArray
    natural: FloatArray
    stiffness: FloatArray
    spec: FieldSpec

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (E,)."""
        return self.stiffness * (lengths(s.positions, self.edges) / self.rest - 1.0 - self.natural)


@dataclass(frozen=True, slots=True)
class DirectorField:
    """First material director of framed rods."""

    edges: int
    spec: FieldSpec = DIRECTOR

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (E, 3)."""
        n = s.state.frames.tangent.shape[1]
        return np.ascontiguousarray(s.frames.auxiliary[: 3 * n].reshape(3, n).T[: self.edges])


def _largest_at(nodes: IntArray, values: FloatArray, count: int) -> FloatArray:
    out = np.zeros(max(int(nodes.max(initial=-1)) + 1, count))
    np.maximum.at(out, nodes, values)
    return out[:count]
