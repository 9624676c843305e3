"""A value of a scenario as a parameter: found by its key path."""

from __future__ import annotations

import re
from math import isfinite
from typing import Final

from ...errors import ScenarioError
from ...frozen import frozen
from ...scenario.load import LoadedScenario, as_path
from ...scenario.text.amount import Amount
from ...scenario.text.tree import format_path
from ...units import Dimension
from ...words import hint

# Step of the difference of the balance, of the value: curvature leaves its fourth power, rounding 1e-12.
_STEP: Final = 1e-4
# Keys that say how a run goes or what it shows, not what is simulated.
_NOT_PHYSICS: Final = ("numerics", "output", "expect", "profiles", "include", "calibrate")


@frozen
class Setting:
    """A number of a scenario.

    Attributes:
        path: Its key path, such as ``materials.soft.youngs_modulus`` or ``parameters.E``.
        value: In SI units.
        unit: SI unit; empty for a number without one.
    """

    path: str
    value: float
    unit: str
    _dimension: Dimension | None = None

    @classmethod
    def of(cls, loaded: LoadedScenario, text: str) -> Setting:
        """The setting of a key path.

        Raises:
            ScenarioError: There is none, or its value is no number that varies smoothly.
        """
        path = format_path(as_path(text))
        found = loaded.provenance.get(path)
        if found is None:
            near = hint(path, loaded.provenance)
            raise ScenarioError(
                f"--by {text}: no value of the scenario has this key path{near}"
                + ("" if near else "; dismech explain lists all of them")
            )
        if as_path(path)[0] in _NOT_PHYSICS:
            raise ScenarioError(f"--by {text}: says how the scene is computed or shown, not what it is")
        value = found.value
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ScenarioError(f"--by {text}: is {value!r}, and a gradient needs a number with a unit")
        name = path.removeprefix("parameters.")
        parameter = loaded.parameters.get(name) if name != path else None
        if isinstance(value, int) and parameter is None:
            raise ScenarioError(f"--by {text}: is a whole number, and a gradient needs one that varies")
        if not isfinite(value):
            raise ScenarioError(f"--by {text}: is not finite")
        dimension = None if parameter is None else parameter.amount.dimension
        return cls(path, float(value), found.unit, dimension)

    @property
    def size(self) -> float:
        """Its magnitude; a value of zero has none, and is taken for one of its unit."""
        return abs(self.value) or 1.0

    @property
    def step(self) -> float:
        """Distance of neighbours."""
        return _STEP * self.size

    def to(self, value: float) -> str:
        """``KEY=VALUE`` that sets it to a value in SI units."""
        return f"{self.path}={Amount(float(value), self._dimension).scalar()}"


def expanded(loaded: LoadedScenario, text: str) -> tuple[str, ...]:
    """Key paths of the scenario that a text means: ``[*]`` stands for every item of a list.

    Raises:
        ScenarioError: It means none.
    """
    if "[*]" not in text:
        return (text,)
    pattern = re.compile(r"\[\d+\]".join(map(re.escape, text.split("[*]"))))
    found = tuple(path for path in loaded.provenance if pattern.fullmatch(path))
    if not found:
        raise ScenarioError(f"{text}: no value of the scenario has such a key path")
    return found
