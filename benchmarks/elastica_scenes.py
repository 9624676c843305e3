"""The same rods in PyElastica: Cosserat rods stepped explicitly."""

from __future__ import annotations

import contextlib
import io
import time
from dataclasses import dataclass
from math import sqrt

import numpy as np
from elastica.boundary_conditions import OneEndFixedBC
from elastica.external_forces import GravityForces
from elastica.modules.base_system import BaseSystemCollection
from elastica.modules.constraints import Constraints
from elastica.modules.forcing import Forcing
from elastica.rod.cosserat_rod import CosseratRod
from elastica.timestepper import integrate
from elastica.timestepper.symplectic_steppers import PositionVerlet

from dismech_cli.arrays import FloatArray


class _Scene(BaseSystemCollection, Constraints, Forcing):
    """A rod with a clamp and gravity."""


@dataclass(frozen=True, slots=True)
class Wire:
    """A round rod.

    Attributes:
        nodes: Positions [m], shape (N, 3).
        radius: Radius of the section [m].
        youngs_modulus: E [Pa]; Poisson's ratio is 1/2.
        density: Mass per volume [kg/m^3].
    """

    nodes: FloatArray
    radius: float
    youngs_modulus: float
    density: float

    @property
    def transit(self) -> float:
        """Time in which an axial wave crosses an edge [s]: the scale of stable explicit steps."""
        edge = float(np.linalg.norm(self.nodes[1] - self.nodes[0]))
        return edge / sqrt(self.youngs_modulus / self.density)


def fall(wire: Wire, t_end: float, dt: float) -> tuple[FloatArray, float]:
    """Position of the tip at ``t_end`` after release from rest, and CPU time [s]."""
    scene, rod = _Scene(), _rod(wire)
    scene.append(rod)
    scene.constrain(rod).using(OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
    scene.add_forcing_to(rod).using(GravityForces, acc_gravity=np.array([0.0, 0.0, -9.81]))
    scene.finalize()
    stepper = PositionVerlet()
    with contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        integrate(stepper, scene, 10 * dt, 10, progress_bar=False)  # compiles
        start = time.process_time()
        integrate(stepper, scene, t_end - 10 * dt, round(t_end / dt) - 10, 10 * dt, progress_bar=False)
    return rod.position_collection[:, -1].copy(), time.process_time() - start


def largest_stable_step(wire: Wire, t_end: float) -> float:
    """The largest of a few steps that stays bounded to ``t_end`` [s]."""
    size = float(np.ptp(wire.nodes, axis=0).max())
    for fraction in (0.8, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02):
        tip, _ = fall(wire, t_end, fraction * wire.transit)
        if np.linalg.norm(tip - wire.nodes[-1]) < size:
            return fraction * wire.transit
    raise RuntimeError("no step tried was stable")


def _rod(wire: Wire) -> CosseratRod:
    edges = np.diff(wire.nodes, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    tangents = edges / lengths[:, None]
    # a smooth field of directors: neither rod is anywhere parallel to the helper
    helper = np.array([0.0, 1.0, 0.0]) if np.ptp(wire.nodes[:, 1]) == 0.0 else np.array([0.0, 0.0, 1.0])
    first = np.cross(tangents, helper)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(tangents, first)
    rod = CosseratRod.straight_rod(
        len(edges),
        wire.nodes[0],
        tangents[0],
        first[0],
        float(lengths.sum()),
        wire.radius,
        wire.density,
        youngs_modulus=wire.youngs_modulus,
        shear_modulus=wire.youngs_modulus / 3.0,
        position=wire.nodes.T.copy(),
        directors=np.stack([first.T, second.T, tangents.T]),
    )
    rod.rest_kappa[:] = rod.kappa
    return rod
