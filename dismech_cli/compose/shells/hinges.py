"""The table of stiffnesses of hinges between triangles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ...arrays import FloatArray
from ...scenario.language.geometry import Shell
from ...sections.shells import hinge_stiffness, weighted_hinge_stiffness
from ..bodies.shell import ShellProperties

Rule: TypeAlias = Callable[[ShellProperties, FloatArray, FloatArray], FloatArray]
"""Stiffness [N m] from a sheet, lengths of edges [m] and areas beside them [m^2], shape (H,) each."""


@dataclass(frozen=True, slots=True)
class Hinges:
    """A rule for the stiffness of hinges.

    Attributes:
        whole: Of hinges between two triangles, from the area of both.
        half: Of one side of a hinge whose other side is rigid, from its area: two in series are a whole.
    """

    whole: Rule
    half: Rule


def hinges_of(shell: Shell) -> Hinges:
    """The rule for a shell."""
    return HINGES[shell.hinges or "equal"]


def _equal(sheet: ShellProperties, lengths: FloatArray, areas: FloatArray) -> FloatArray:
    return hinge_stiffness(sheet.youngs_modulus, sheet.thickness, len(lengths))


def _half_of_equal(sheet: ShellProperties, lengths: FloatArray, areas: FloatArray) -> FloatArray:
    return np.asarray(2.0 * _equal(sheet, lengths, areas))


def _weighted(sheet: ShellProperties, lengths: FloatArray, areas: FloatArray) -> FloatArray:
    return weighted_hinge_stiffness(sheet.youngs_modulus, sheet.thickness, lengths, areas)


HINGES: Mapping[str, Hinges] = {
    "equal": Hinges(_equal, _half_of_equal),
    # The area is a compliance: that of both sides is the sum.
    "weighted": Hinges(_weighted, _weighted),
}
