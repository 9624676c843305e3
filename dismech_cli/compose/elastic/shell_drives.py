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
from ...scenario.load import LoadedScenario
from ..bodies.geometry import Geometry
from ..laws import ToLaw
from ..shells.topology import ShellEdges
from .curvature_drives import curvature_drives
from .hinge_drives import hinge_drives
from .shells import ShellSystem


def build_shell_elastic(
    loaded: LoadedScenario, geometry: Geometry, free: ShellEdges, shells: ShellSystem, laws: ToLaw
) -> tuple[StencilEnergy | DrivenEnergy, ...]:
    """The elastic energies of the shells.

    Raises:
        ScenarioError: An actuation drives nothing, or what it cannot drive.
    """
    drives: dict[str, list[Drive]] = {name: [] for name in shells.bending}
    named = {shell.name: shell for shell in geometry.shells}
    for index, actuation in enumerate(loaded.scenario.actuation):
        match actuation:
            case DihedralActuation(shell=name):
                topology = free.topologies[name]
                drives[name] += hinge_drives(loaded, geometry, named[name], topology, index, actuation, laws)
            case SurfaceCurvatureActuation(shell=name):
                drives[name] += curvature_drives(loaded, geometry, named[name], index, actuation, laws)
            case StretchActuation() | CurvatureActuation() | TwistActuation():  # of a rod
                continue
            case _:
                assert_never(actuation)
    bending = (
        DrivenEnergy(energy, tuple(drives[name])) if drives[name] else energy
        for name, energy in shells.bending.items()
    )
    return (*shells.membrane.values(), *bending)
