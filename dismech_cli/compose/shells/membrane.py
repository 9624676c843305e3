"""The table of membranes of shells."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ...arrays import FloatArray
from ...energies.membrane import membrane_term
from ...energies.membrane_springs import spring_term
from ...model.stencil import StencilEnergy
from ...sections.shells import area_springs, edge_lengths
from .bending import bending_of
from .parts import ShellParts


def _name(parts: ShellParts) -> str:
    return f"{parts.shell.name}.membrane"


def _triangles(parts: ShellParts) -> StencilEnergy:
    return membrane_term(
        _name(parts),
        parts.dofs,
        parts.positions,
        parts.triangles,
        youngs_modulus=parts.sheet.youngs_modulus,
        poisson_ratio=parts.sheet.poisson_ratio,
        thickness=parts.sheet.thickness,
    )


def _springs(parts: ShellParts) -> StencilEnergy:
    lengths = edge_lengths(parts.positions, parts.topology.edges)
    sheet = parts.sheet
    stiffness = area_springs(sheet.youngs_modulus, sheet.thickness, lengths, parts.adjacent_areas())
    return _along_edges(parts, lengths, stiffness)


def _family(parts: ShellParts) -> StencilEnergy:
    lengths = edge_lengths(parts.positions, parts.topology.edges)
    return _along_edges(parts, lengths, bending_of(parts.shell).springs(parts, lengths))


def _along_edges(parts: ShellParts, lengths: FloatArray, stiffness: FloatArray) -> StencilEnergy:
    return spring_term(_name(parts), parts.dofs, parts.topology.edges, lengths, stiffness)


MEMBRANES: Mapping[str, Callable[[ShellParts], StencilEnergy]] = {
    "cst": _triangles,
    "springs": _springs,
    "family": _family,
}
"""Stretching energy of a shell, stress-free in its rest shape."""
