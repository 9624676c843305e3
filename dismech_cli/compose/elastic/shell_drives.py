"""Bending energies of shells, driven where the scenario actuates them."""

from __future__ import annotations

from typing import assert_never

from ...model.driven import Drive, DrivenEnergy
from ...model.stencil import StencilEnergy
from ...scenario.language.actuation import (
    CurvatureActuation,
    DihedralActuation,
    StretchActuation,
    SurfaceCurvatureActuation,
    TwistActuation,
)
from ..scene import Scene
from ..structure.structure import Structure
from .curvature_drives import curvature_drives
from .hinge_drives import hinge_drives
from .shells import ShellEnergies


def driven_shells(
    scene: Scene, structure: Structure, shells: ShellEnergies
) -> tuple[StencilEnergy | DrivenEnergy, ...]:
    """The elastic energies of the shells.

    Raises:
        ScenarioError: An actuation drives nothing, or what it cannot drive.
    """
    drives: dict[str, list[Drive]] = {name: [] for name in shells.bending}
    bodies = structure.shell_edges.bodies
    for index, actuation in enumerate(scene.scenario.actuation):
        match actuation:
            case DihedralActuation(shell=name):
                drives[name] += hinge_drives(scene, bodies[name], index, actuation)
            case SurfaceCurvatureActuation(shell=name):
                drives[name] += curvature_drives(scene, bodies[name], index, actuation)
            case StretchActuation() | CurvatureActuation() | TwistActuation():  # of a rod
                continue
            case _:
                assert_never(actuation)
    bending = (
        DrivenEnergy(energy, tuple(drives[name])) if drives[name] else energy
        for name, energy in shells.bending.items()
    )
    return (*shells.membrane.values(), *bending)
