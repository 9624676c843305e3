"""Material damping: viscous stresses beside the elastic ones, no more than some material asks for.

Where rods of several relaxation times meet at a joint, either half of it counts by its share of the turn:
their mean dissipates what they do as long as the motion is slow against them; where sheets meet, see
:mod:`..shells.seams`. The material of rubber damps with the stiffness that it has at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ...arrays import FloatArray
from ...energies.strain_rates import RATES, damping_term
from ...model.rate import ViscousStress
from ...model.stencil import StencilEnergy
from ..scene import Scene
from ..shells.bending import bending_of
from ..shells.membrane import TRIANGLES
from ..structure.joints import Joints
from ..structure.structure import Structure
from .halves import Halves
from .joints import of_edges
from .rods import STRETCHES, RodEnergies
from .shells import ShellEnergies


def damping_terms(
    scene: Scene,
    structure: Structure,
    rods: RodEnergies,
    shells: ShellEnergies,
    welds: Sequence[tuple[StencilEnergy, Halves]],
) -> tuple[ViscousStress, ...]:
    """The damping of all materials that have any; none in statics, where nothing moves."""
    if structure.plan.static:
        return ()
    materials = scene.scenario.materials
    times = np.array([materials[rod.material].relaxation_time for rod in scene.geometry.rods])
    return (
        *_of_rods(scene, structure, rods, times),
        *(term for energy, halves in welds for term in _where(energy, times[halves.joints.rods[:, 0]])),
        *_of_shells(structure, shells),
    )


def _of_rods(
    scene: Scene, structure: Structure, rods: RodEnergies, times: FloatArray
) -> Iterator[ViscousStress]:
    geometry = scene.geometry
    if rods.stretch is None or not times.any():
        return
    stretch = StencilEnergy.of(
        rods.stretch.name,
        STRETCHES[False].kernels[structure.dofs.dimension],
        rods.stretch.dofs,
        {"eps": 0.0, "EA": geometry.per_edge("axial"), "length": rods.stretch.parameter("length")},
    )
    yield from _where(stretch, times[geometry.edge_rod])
    if rods.bending is not None:
        yield from _where(rods.bending, _at_joints(scene, structure, structure.skeleton.joints, times))
    if rods.corners is not None:
        yield from _where(
            rods.corners.energy, _at_joints(scene, structure, rods.corners.halves.joints, times)
        )


def _at_joints(scene: Scene, structure: Structure, joints: Joints, times: FloatArray) -> FloatArray:
    """Relaxation time of each joint [s], shape (J,), from those of the rods."""
    stiffness = of_edges(scene.geometry, structure.skeleton, "bending_1")[joints.pairs]
    share = joints.halves / stiffness
    mean: FloatArray = (share * times[joints.rods]).sum(axis=1) / share.sum(axis=1)
    return mean


def _of_shells(structure: Structure, shells: ShellEnergies) -> Iterator[ViscousStress]:
    for name, body in structure.shell_edges.bodies.items():
        membrane, bending, time = shells.membrane[name], shells.bending[name], body.sheet.relaxation_time
        if membrane.kernel not in RATES:
            membrane = TRIANGLES["st_venant_kirchhoff"](body, structure)
        yield from _where(membrane, np.full(len(membrane.dofs), time))
        at_hinges = bending_of(body.shell).at_hinges
        yield from _where(bending, body.times if at_hinges else np.full(len(bending.dofs), time))
    for energy in shells.seams:
        yield from _where(energy, structure.shell_edges.seams.times)


def _where(energy: StencilEnergy, times: FloatArray) -> Iterator[ViscousStress]:
    """The damping of the stencils that have some, given their relaxation times [s], shape (S,)."""
    some = times != 0.0
    if some.any():
        part = replace(
            energy,
            dofs=energy.dofs[some],
            parameters=np.ascontiguousarray(energy.parameters[:, some]),
            auxiliaries=energy.auxiliaries[some],
        )
        yield damping_term(part, times[some])
