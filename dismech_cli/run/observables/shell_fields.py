"""Fields over the triangles of shells, and fields of one kind of cell among others."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from ...frozen import frozen
from ...mesh.measure import triangle_areas
from ...output.frame import FieldSpec
from .rod_fields import Field
from .snapshot import Snapshot

AREA_STRAIN = FieldSpec(
    name="area_strain", unit="1", long_name="change of area from the rest area", location="cell"
)
BENDING_ENERGY_DENSITY = FieldSpec(
    name="bending_energy_density", unit="J/m^2", long_name="bending energy per rest area", location="cell"
)


@frozen
class AreaStrainField:
    """A / A0 - 1 of each triangle."""

    triangles: IntArray
    rest: FloatArray
    spec: FieldSpec = AREA_STRAIN

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (T,)."""
        return triangle_areas(s.positions, self.triangles) / self.rest - 1.0


@frozen
class BendingEnergyField:
    """Bending energy of each triangle over its rest area; a hinge gives half to each side.

    Attributes:
        shares: For each bending energy by name, a sparse matrix (T, S): energies of stencils to
            energies per area.
    """

    shares: tuple[tuple[str, Any], ...]
    spec: FieldSpec = BENDING_ENERGY_DENSITY

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (T,)."""
        return np.asarray(sum(shares @ s.stencil_energies(name) for name, shares in self.shares))


@frozen
class AmongCells:
    """A field of rods or shells in a scene with both: zero on the cells of the other kind.

    Attributes:
        field: Values on one kind of cell.
        before: Cells of the other kind that come before.
        after: Cells of the other kind that come after.
    """

    field: Field
    before: int
    after: int

    @property
    def spec(self) -> FieldSpec:
        """That of the field."""
        return self.field.spec

    def __call__(self, s: Snapshot) -> FloatArray:
        """Values (E + T,) or (E + T, components)."""
        values = self.field(s)
        zeros = ((self.before, self.after), *((0, 0) for _ in values.shape[1:]))
        return np.pad(values, zeros)
