"""Probes that are read after every step."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arrays import FloatArray
from ..model.saved import Arrays, Numbers, within
from .observables.probes import Probe
from .observables.snapshot import Snapshot


class Watched:
    """The course over time of some probes; implements :class:`~dismech_cli.model.saved.Saved`."""

    def __init__(self, probes: Mapping[str, Probe]) -> None:
        """Watch nothing yet.

        Args:
            probes: By name; one of several names is read once.
        """
        self._probes = list({id(probe): probe for probe in probes.values()}.values())
        places = {id(probe): place for place, probe in enumerate(self._probes)}
        self._place = {name: places[id(probe)] for name, probe in probes.items()}
        self._times: list[float] = []
        self._values: list[list[float]] = [[] for _ in self._probes]

    def __bool__(self) -> bool:
        """Whether there is anything to watch."""
        return bool(self._probes)

    @property
    def times(self) -> FloatArray:
        """Times at which the probes were read [s], shape (K,)."""
        return np.array(self._times)

    @property
    def values(self) -> dict[str, FloatArray]:
        """What each read then, shape (K,)."""
        return {name: np.array(self._values[place]) for name, place in self._place.items()}

    def read(self, s: Snapshot) -> None:
        """Read every probe."""
        if self._probes:
            self._times.append(s.state.t)
            for probe, values in zip(self._probes, self._values, strict=True):
                values.append(probe(s))

    def arrays(self) -> Arrays:
        """Times and values."""
        return {"t": self.times} | {f"value.{name}": values for name, values in self.values.items()}

    def numbers(self) -> Numbers:
        """None."""
        return {}

    def restore(self, arrays: Arrays, numbers: Numbers) -> Watched:
        """Go on from the courses that were saved."""
        values = within("value", arrays)
        self._times = arrays["t"].tolist()
        for name, place in self._place.items():
            self._values[place] = values[name].tolist()
        return self
