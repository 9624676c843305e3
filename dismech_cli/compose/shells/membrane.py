"""The table of membranes of shells."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ...energies.membrane import membrane_term
from ...energies.membrane_neo_hookean import neo_hookean_term
from ...energies.membrane_springs import spring_term
from ...mesh.measure import edge_lengths
from ...model.stencil import StencilEnergy
from ...sections.shells import area_springs
from .bending import bending_of
from .body import Ground, ShellBody


def _name(body: ShellBody) -> str:
    return f"{body.shell.name}.membrane"


def _triangles(body: ShellBody, ground: Ground) -> StencilEnergy:
    return TRIANGLES[body.sheet.model](body, ground)


def _linear(body: ShellBody, ground: Ground) -> StencilEnergy:
    return membrane_term(
        _name(body),
        ground.dofs,
        ground.positions,
        body.triangles,
        youngs_modulus=body.sheet.youngs_modulus,
        poisson_ratio=body.sheet.poisson_ratio,
        thickness=body.sheet.thickness,
    )


def _rubber(body: ShellBody, ground: Ground) -> StencilEnergy:
    return neo_hookean_term(
        _name(body),
        ground.dofs,
        ground.positions,
        body.triangles,
        shear_modulus=body.sheet.youngs_modulus / 3.0,
        thickness=body.sheet.thickness,
    )


def _springs(body: ShellBody, ground: Ground) -> StencilEnergy:
    lengths = edge_lengths(ground.positions, body.topology.edges)
    around = body.adjacent_areas(ground.positions)
    stiffness = area_springs(*body.on_edges(ground.positions), lengths, around)
    return spring_term(_name(body), ground.dofs, body.topology.edges, lengths, stiffness)


def _family(body: ShellBody, ground: Ground) -> StencilEnergy:
    lengths = edge_lengths(ground.positions, body.topology.edges)
    stiffness = bending_of(body.shell).springs(body, ground.positions)
    return spring_term(_name(body), ground.dofs, body.topology.edges, lengths, stiffness)


MEMBRANES: Mapping[str, Callable[[ShellBody, Ground], StencilEnergy]] = {
    "cst": _triangles,
    "springs": _springs,
    "family": _family,
}
"""Stretching energy of a shell, stress-free in its rest shape."""

TRIANGLES: Mapping[str, Callable[[ShellBody, Ground], StencilEnergy]] = {
    "st_venant_kirchhoff": _linear,
    "neo_hookean": _rubber,
}
"""That of triangles, by the model of the material."""
