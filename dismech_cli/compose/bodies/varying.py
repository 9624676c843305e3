"""Values that vary over a body: evaluated on its cells, refused where they make no sense."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import field
from typing import Final

import numpy as np

from ...arrays import BoolArray, FloatArray, Numbers
from ...frozen import frozen
from ...laws.expression import compile_expression
from ...quantities import with_unit
from ...scenario.checking.plausibility import STOUTEST, density_doubts, modulus_doubts
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from ...scenario.values.quantity import LARGEST, SMALLEST
from ...scenario.values.varying import ALONG, PLACES, ByExpression, ByGroup, ByTable, Varying
from ...units import KINDS
from ...words import hint
from .cells import Cells

# A property that changes by more than this within one cell is not resolved by the mesh.
_STEEP: Final = 2.0

# What is odd about values that only an expression knows; the others are judged as they are read.
_ODD: Final[dict[str, Callable[[float, float], Iterator[str]]]] = {
    "pressure": modulus_doubts,
    "density": density_doubts,
}


@frozen
class Sampler:
    """Reads the values of one body.

    Attributes:
        loaded: The scenario.
        body: Name of the body.
        cells: Its cells.
        notes: What varies, for the user.
        doubts: What varies too fast for the mesh, or to odd values.
    """

    loaded: LoadedScenario
    body: str
    cells: Cells
    notes: list[str] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)

    def __call__(self, value: Varying, path: KeyPath, kind: str) -> Numbers:
        """The value on the points of all cells, shape (P, K), or one number for all.

        Args:
            value: As written.
            path: Its key path.
            kind: What it is, a key of :data:`.units.KINDS`.

        Raises:
            ScenarioError: It names what the body does not have, or is not a number above zero everywhere.
        """
        if isinstance(value, float):
            return value
        found = self._values(value, path)
        self.refuse(~(found >= SMALLEST) | (found > LARGEST), found, path, kind, "must be above zero")
        low, high = float(found.min()), float(found.max())
        key = str(path[-1]).replace("_", " ")
        unit = KINDS[kind].unit
        self.notes.append(
            f"{self.body}: {key} from {with_unit(f'{low:.4g}', unit)} to {with_unit(f'{high:.4g}', unit)}"
        )
        within = found[self.cells.weights > 0.0]
        steep = float((within.max(axis=0) / within.min(axis=0)).max())
        if steep > _STEEP:
            self.doubts.append(
                self.loaded.warning(
                    path,
                    f"changes by a factor of {steep:.2g} within one element of '{self.body}': a finer mesh "
                    "would follow it",
                )
            )
        if isinstance(value, ByExpression):
            odd = list(_ODD[kind](low, high)) if kind in _ODD else []
            size = self.cells.size
            if kind == "length" and high > STOUTEST * size:
                odd.append(f"grows to {high:.3g} m on a body of {size:.3g} m; expressions are in SI units")
            self.doubts.extend(self.loaded.warning(path, what) for what in odd)
        return found

    def refuse(self, wrong: BoolArray, found: Numbers, path: KeyPath, kind: str, why: str) -> None:
        """Raise with the first place where values are wrong, given as a mask; do nothing where none is.

        Raises:
            ScenarioError: One is.
        """
        if not wrong.any():
            return
        shape = self.cells.places["x"].shape
        wrong, found = np.broadcast_to(wrong, shape), np.broadcast_to(found, shape)
        cell, point = np.argwhere(wrong.T)[0]
        places = self.cells.places
        names = ("s",) if "s" in places else ("x", "y", "z")
        where = ", ".join(f"{name} = {places[name][point, cell]:.4g}" for name in names)
        value = with_unit(f"{found[point, cell]:.4g}", KINDS[kind].unit)
        raise self.loaded.error(path, f"is {value} at {where} of '{self.body}'; {why}")

    def _values(self, value: ByExpression | ByTable | ByGroup, path: KeyPath) -> FloatArray:
        match value:
            case ByExpression(expression=text):
                compiled = compile_expression(text, (*ALONG, *PLACES))
                for name in sorted(compiled.variables):
                    self._check_place(name, path)
                with np.errstate(all="ignore"):
                    values = compiled.program(dict(self.cells.places))
                return np.broadcast_to(np.asarray(values, dtype=np.float64), self.cells.places["x"].shape)
            case ByTable(of=name):
                self._check_place(name, path)
                return _looked_up(value, self.cells.places[name])
            case ByGroup(value=rest, groups=groups):
                values = np.full(self.cells.places["x"].shape, rest)
                for name, number in groups.items():
                    if name not in self.cells.groups:
                        known = list(self.cells.groups)
                        told = hint(name, known) or f"; it has: {', '.join(sorted(known)) or 'none'}"
                        raise self.loaded.error(
                            (*path, "groups", name), f"'{self.body}' has no group '{name}'{told}"
                        )
                    values[:, self.cells.groups[name]] = number
                return values

    def _check_place(self, name: str, path: KeyPath) -> None:
        if name not in self.cells.places:
            raise self.loaded.error(
                path,
                f"{name} has no meaning on {self.cells.lacking} such as '{self.body}'; take x, y, z, r "
                "or groups",
            )


def _looked_up(law: ByTable, places: FloatArray) -> FloatArray:
    at, values = np.array(law.table).T
    places = np.clip(places, at[0], at[-1])
    if law.interpolation == "step":
        last = np.searchsorted(at, places, side="right") - 1
        return np.asarray(values[last], dtype=np.float64)
    if law.interpolation == "cubic" and len(at) > 2:
        from scipy.interpolate import CubicSpline

        curve: FloatArray = CubicSpline(at, values, bc_type="natural")(places)
        return curve
    return np.asarray(np.interp(places, at, values), dtype=np.float64)
