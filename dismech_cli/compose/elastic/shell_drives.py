"""Bending energies of shells, driven where the scenario actuates them."""

from __future__ import annotations

from typing import assert_never

from ...frozen import frozen
from ...model.driven import Drive, DrivenEnergy
from ...model.stencil import StencilEnergy
from ...scenario.language.actuation import (
    Controlled,
    CurvatureActuation,
    DihedralActuation,
    StretchActuation,
    SurfaceCurvatureActuation,
    TwistActuation,
)
from ..scene import Scene
from ..structure.structure import Structure
from .curvature_drives import curvature_drives
from .following import Ports
from .hinge_drives import hinge_drives
from .shells import ShellEnergies
from .stiffening import Stiffening, refuse_shared, stiffened, surplus


@frozen
class DrivenShells:
    """The elastic energies of the shells under actuation.

    Attributes:
        terms: The energies.
        surplus: What passive hinges store beyond those that feedback makes stiffer.
    """

    terms: tuple[StencilEnergy | DrivenEnergy, ...]
    surplus: tuple[DrivenEnergy, ...]


def driven_shells(scene: Scene, structure: Structure, shells: ShellEnergies, ports: Ports) -> DrivenShells:
    """The elastic energies of the shells.

    Raises:
        ScenarioError: An actuation drives nothing, or what it cannot drive.
    """
    drives: dict[str, list[Drive]] = {name: [] for name in shells.bending}
    stiff: dict[str, list[Stiffening]] = {name: [] for name in shells.bending}
    bodies = structure.shell_edges.bodies
    for index, actuation in enumerate(scene.scenario.actuation):
        match actuation:
            case DihedralActuation(shell=name):
                made = hinge_drives(scene, bodies[name], index, actuation, ports)
            case SurfaceCurvatureActuation(shell=name):
                made = tuple(curvature_drives(scene, bodies[name], index, actuation, ports))
            case StretchActuation() | CurvatureActuation() | TwistActuation():  # of a rod
                continue
            case _:
                assert_never(actuation)
        if isinstance(actuation.value, Controlled) and (p := ports[index].p):
            stiff[name] += [Stiffening(("actuation", index, "value"), drive, p) for drive in made]
        drives[name] += made
    for name, parts in stiff.items():
        refuse_shared(scene, drives[name], parts)
    hinges = {name: stiffened(scene, energy, stiff[name]) for name, energy in shells.bending.items()}
    bending = (
        DrivenEnergy(energy, tuple(drives[name])) if drives[name] else energy
        for name, energy in hinges.items()
    )
    more = (one for name, energy in hinges.items() for one in surplus(scene, energy, stiff[name]))
    return DrivenShells((*shells.membrane.values(), *bending), tuple(more))
