"""Ideal feedback: springs that are stiffer by their gain, and the energy that the passive ones lack."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ...frozen import frozen
from ...model.driven import Drive, DrivenEnergy
from ...model.stencil import StencilEnergy
from ...scenario.text.tree import KeyPath
from ..scene import Scene

_RUBBER = "muA"


@frozen
class Stiffening:
    """Springs under ideal feedback.

    Attributes:
        path: Key path of their actuation.
        drive: What drives them.
        p: By how many times their own stiffness they are stiffer.
    """

    path: KeyPath
    drive: Drive
    p: float


def stiffened(scene: Scene, energy: StencilEnergy, parts: Sequence[Stiffening]) -> StencilEnergy:
    """The energy with stiffer springs.

    Raises:
        ScenarioError: The springs are not linear, or their stiffness is that of other strains too.
    """
    for part in parts:
        name, stencils = _scale(scene, energy, part), part.drive.stencils
        stiffness = energy.parameter(name).copy()
        stiffness[stencils] *= 1.0 + part.p
        energy = energy.having({name: stiffness})
    return energy


def surplus(scene: Scene, energy: StencilEnergy, parts: Sequence[Stiffening]) -> Iterator[DrivenEnergy]:
    """Energies of the passive springs beyond those of the stiffer ones, which are not in the balance.

    Under u = r + p (r - y) a spring K is turned by y - u = (1 + p) (y - r'): it stores (1 + p) times what a
    spring K (1 + p) does that rests at r'.

    Args:
        scene: The scene.
        energy: With the stiffer springs.
        parts: Which they are.
    """
    for part in parts:
        kernel, drive, name = energy.kernel, part.drive, _scale(scene, energy, part)
        others = {scale for scales in kernel.scales for scale in scales} - {name}
        alone = replace(
            energy,
            dofs=energy.dofs[drive.stencils],
            parameters=np.ascontiguousarray(energy.parameters[:, drive.stencils]),
            auxiliaries=energy.auxiliaries[drive.stencils],
        )
        alone = alone.having({name: part.p * alone.parameter(name), **dict.fromkeys(others, 0.0)})
        yield DrivenEnergy(alone, (replace(drive, stencils=np.arange(len(drive.stencils))),))


def refuse_shared(scene: Scene, drives: Sequence[Drive], parts: Sequence[Stiffening]) -> None:
    """Refuse springs under ideal feedback that something else drives too.

    Raises:
        ScenarioError: naming the actuation.
    """
    for part in parts:
        for other in drives:
            alike = other is not part.drive and other.row == part.drive.row
            if alike and np.isin(other.stencils, part.drive.stencils).any():
                raise scene.error(
                    part.path, "another actuation drives the same places, against ideal feedback"
                )


def _scale(scene: Scene, energy: StencilEnergy, part: Stiffening) -> str:
    """Name of the stiffness of the springs.

    Raises:
        ScenarioError: It is not theirs alone, or not linear.
    """
    name, *others = energy.kernel.scales[part.drive.row]
    remedy = "ideal feedback stiffens springs one by one: take feedback: sampled"
    if others and others != [_RUBBER]:
        raise scene.error(part.path, f"a face of this shell bends every way with one stiffness; {remedy}")
    if others and energy.parameter(_RUBBER)[part.drive.stencils].any():
        raise scene.error(part.path, f"rubber of model neo_hookean has no constant stiffness; {remedy}")
    return name
