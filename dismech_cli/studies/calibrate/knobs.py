"""What a fit may turn: values of a scenario, within bounds, and what was known of them before."""

from __future__ import annotations

import numpy as np

from ...errors import ScenarioError
from ...frozen import frozen
from ...quantities import QuantityError, read_quantity
from ...scenario.language.calibrate import Fitted
from ...scenario.load import LoadedScenario
from ..gradient.setting import Setting, expanded


@frozen
class Knob:
    """A fitted value: what it may be and what was known of it.

    Attributes:
        setting: Where it stands, and its value there.
        low: Least value.
        high: Greatest value.
        log: Whether its logarithm is fitted.
        deviation: Of what was known before, of its logarithm where that is fitted; infinite for nothing.
    """

    setting: Setting
    low: float
    high: float
    log: bool
    deviation: float

    def inner(self, value: float) -> float:
        """The number that is fitted."""
        return float(np.log(value)) if self.log else value

    def outer(self, x: float) -> float:
        """The value of such a number."""
        return float(np.exp(x)) if self.log else x

    def slope(self, x: float) -> float:
        """How the value changes with it."""
        return self.outer(x) if self.log else 1.0


def knobs_of(loaded: LoadedScenario) -> tuple[Knob, ...]:
    """What a scenario says is fitted.

    Raises:
        ScenarioError: A key path, a bound or a deviation is wrong.
    """
    spec = loaded.scenario.calibrate
    assert spec is not None
    knobs: list[Knob] = []
    for k, one in enumerate(spec.fit):
        path = ("calibrate", "fit", k)
        try:
            settings = [Setting.of(loaded, each) for each in expanded(loaded, one.of)]
        except ScenarioError as error:
            raise loaded.error((*path, "of"), str(error).replace("--by ", "")) from None
        for setting in settings:
            if any(setting.path == knob.setting.path for knob in knobs):
                raise loaded.error((*path, "of"), f"{setting.path} is fitted already")
            knobs.append(_knob(loaded, k, one, setting))
    return tuple(knobs)


def _knob(loaded: LoadedScenario, k: int, one: Fitted, setting: Setting) -> Knob:
    def read(key: str, amount: float | str) -> float:
        if isinstance(amount, float | int):
            return float(amount)
        try:
            return read_quantity(amount)[0]
        except QuantityError as error:
            raise loaded.error(("calibrate", "fit", k, key), str(error)) from None

    log = one.scale == "log"
    low = -np.inf if one.min is None else read("min", one.min)
    high = np.inf if one.max is None else read("max", one.max)
    if log:
        low = max(low, 0.0)
        if setting.value <= 0.0 or high <= 0.0:
            raise loaded.error(("calibrate", "fit", k, "scale"), "'log' wants values above zero")
    if not low <= setting.value <= high or low >= high:
        message = f"{setting.value:.6g} {setting.unit}, where the fit starts, is not between its bounds"
        raise loaded.error(("calibrate", "fit", k), message)
    deviation = np.inf if one.deviation is None else read("deviation", one.deviation)
    if deviation <= 0.0:
        raise loaded.error(("calibrate", "fit", k, "deviation"), "must be above zero")
    return Knob(setting, float(low), float(high), log, float(deviation))
