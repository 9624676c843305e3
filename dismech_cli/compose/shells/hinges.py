"""The table of stiffnesses of hinges between triangles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np

from ...arrays import FloatArray
from ...frozen import frozen
from ...mesh.measure import edge_lengths
from ...scenario.language.geometry import Shell
from ...sections.shells import hinge_stiffness, weighted_hinge_stiffness
from .body import ShellBody

Rule: TypeAlias = Callable[[FloatArray, FloatArray, FloatArray, FloatArray], FloatArray]
"""Stiffness [N m] from Young's modulus [Pa], thickness [m], length [m] and area [m^2], shape (H,) each."""


@frozen
class Hinges:
    """A rule for the stiffness of hinges.

    Attributes:
        whole: Of hinges between two triangles of one sheet, from the area of both.
        half: Of one side of a hinge whose other side is rigid, from its area: two in series are a whole.
    """

    whole: Rule
    half: Rule


def hinges_of(shell: Shell) -> Hinges:
    """The rule for a shell."""
    return HINGES[shell.hinges or "equal"]


def hinge_stiffnesses(body: ShellBody, positions: FloatArray) -> FloatArray:
    """Stiffness of the hinges of a shell, the two sides of each in series [N m], shape (H,)."""
    rule, edges = hinges_of(body.shell), body.topology.hinge_edges
    lengths = edge_lengths(positions, body.topology.edges)[edges]
    modulus, thickness, areas = (sides[edges].T for sides in body.sides(positions))
    one, two = (rule.half(modulus[i], thickness[i], lengths, areas[i]) for i in range(2))
    # without the rounding of a sum where both sides are the same
    alike = (modulus[0] == modulus[1]) & (thickness[0] == thickness[1])
    whole = rule.whole(modulus[0], thickness[0], lengths, areas.sum(axis=0))
    return np.where(alike, whole, one * two / (one + two))


def _equal(modulus: FloatArray, thickness: FloatArray, lengths: FloatArray, areas: FloatArray) -> FloatArray:
    return hinge_stiffness(modulus, thickness, len(lengths))


def _half_of_equal(
    modulus: FloatArray, thickness: FloatArray, lengths: FloatArray, areas: FloatArray
) -> FloatArray:
    return np.asarray(2.0 * hinge_stiffness(modulus, thickness, len(lengths)))


HINGES: Mapping[str, Hinges] = {
    "equal": Hinges(_equal, _half_of_equal),
    # The area is a compliance: that of both sides is the sum.
    "weighted": Hinges(weighted_hinge_stiffness, weighted_hinge_stiffness),
}
