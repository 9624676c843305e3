"""What the tables of a fit see of a run, and the derivatives of that."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import FloatArray
from ...compose.compose import Composition
from ...errors import ScenarioError
from ...frozen import frozen
from ...scenario.load import LoadedScenario
from ...solve.integrators import Static
from ...solve.linear.factors import FactorizationError
from ...solve.sensitivity import NOWHERE, forward
from ..gradient.acting import acting_of
from ..gradient.nearby import Nearby
from ..gradient.reading import Readings, states
from ..gradient.run import TapedRun, differentiated, exactly, sweeper
from .channel import Channel, Probed, Sampling, points, sampling
from .data import Curves


@frozen
class Instruments:
    """Read the markers and probes of all tables at their times.

    Attributes:
        loaded: The scenario as it stands.
        curves: The tables.
    """

    loaded: LoadedScenario
    curves: tuple[Curves, ...]

    def predicted(self, composition: Composition, run: TapedRun) -> list[FloatArray]:
        """What each table should hold, shape (R, C)."""
        seen = states(run.simulation.start, run.steps)
        out = []
        for k, sampled in enumerate(self._sampled(run)):
            channel = self._channel(k, composition, ())
            read = np.stack([channel.values(seen[i]) for i in sampled.states])
            out.append(np.asarray(sampled.weights @ read))
        return out

    def slopes(self, composition: Composition, run: TapedRun, near: Sequence[Nearby]) -> list[FloatArray]:
        """Derivatives of that by P values, shape (R, C, P).

        Args:
            composition: The scene that was run.
            run: Its run.
            near: The scene at neighbours of each value.

        Raises:
            ScenarioError: The run passes a state where there is none.
        """
        count = len(near)
        if not count:
            return [np.zeros((*one.values.shape, 0)) for one in self.curves]
        seen, sampled = states(run.simulation.start, run.steps), self._sampled(run)
        model = differentiated(run, near, sweeper(self.loaded, run.simulation))
        channels = [self._channel(k, composition, near) for k in range(len(self.curves))]
        read: list[list[FloatArray]] = [[] for _ in self.curves]
        wanted = [set(one.states.tolist()) for one in sampled]
        forces = any(channel.of_forces for channel in channels)
        reacting = np.arange(len(run.simulation.start.q)) if forces else NOWHERE
        try:
            acting = acting_of(run.simulation, near)
            for i, d in enumerate(forward(model, run.simulation.start, run.steps, reacting, acting)):
                for k, channel in enumerate(channels):
                    if i in wanted[k]:
                        read[k].append(channel.slopes(seen[i], d))
        except FactorizationError as error:
            raise ScenarioError(f"the run passes a state without a derivative: {error}") from None
        out = []
        for one, found in zip(sampled, read, strict=True):
            rows = np.stack(found).reshape(len(found), -1)
            out.append(np.asarray(one.weights @ rows).reshape(one.weights.shape[0], -1, count))
        return out

    def _sampled(self, run: TapedRun) -> list[Sampling]:
        still = isinstance(run.simulation.integrator, Static)
        return [sampling(one.times, run, still=still) for one in self.curves]

    def _channel(self, k: int, composition: Composition, near: Sequence[Nearby]) -> Channel:
        spec = self.curves[k].spec
        if spec.markers is not None:
            path = ("calibrate", "data", k, "markers")
            return points(self.loaded, path, spec.markers, composition, near)
        assert spec.probes is not None
        simulation = exactly(composition, {})
        return Probed(
            tuple(
                Readings(
                    simulation,
                    composition.simulation.probes[name],
                    near,
                    [[other.probes[name] for other in one.simulations] for one in near],
                )
                for name in spec.probes
            )
        )
