"""The scene at values of its parameters: what it predicts for all tables, and the derivatives of that."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import FloatArray
from ...compose.compose import Composition
from ...errors import LawError, ScenarioError, SolverError
from ...output.durable import staged
from ...scenario.load import LoadedScenario
from ...session.narrator import Narrator, Silent
from ...solve.integrators import Static
from ...solve.linear.factors import FactorizationError
from ...solve.sensitivity import NOWHERE, forward
from ..gradient.acting import acting_of
from ..gradient.nearby import Nearby, nearby
from ..gradient.reading import Readings, states
from ..gradient.run import (
    TapedRun,
    differentiated,
    exactly,
    quietly,
    run_taped,
    sweeper,
    why_not,
    why_not_after,
    why_not_by,
)
from ..gradient.setting import Setting
from ..source import Source
from .channel import Channel, Probed, points, sampling
from .data import Curves

# Step of differences of runs, of each value.
_STEP = 1e-3


@dataclass(slots=True)
class Evaluation:
    """What a run predicts.

    Attributes:
        predicted: For each table, shape (R, C).
        slopes: Their derivatives, shape (R, C, P); None until they are asked for.
    """

    predicted: list[FloatArray]
    slopes: list[FloatArray] | None = None


@dataclass(slots=True)
class Experiment:
    """Runs a scene at values of its parameters; keeps what it has run, on disk too.

    Attributes:
        source: The scenario.
        loaded: As it stands.
        settings: Its parameters.
        curves: Tables that it is compared with.
        folder: Where evaluations are kept.
        narrator: Told of each.
        runs: Runs made by this process.
        why: Why there are no exact derivatives; empty if there are, None before that is known.
    """

    source: Source
    loaded: LoadedScenario
    settings: tuple[Setting, ...]
    curves: tuple[Curves, ...]
    folder: Path
    narrator: Narrator
    runs: int = field(default=0, init=False)
    why: str | None = field(default=None, init=False)
    _known: dict[bytes, Evaluation] = field(default_factory=dict, init=False)
    _neighbours: dict[bytes, list[Nearby]] = field(default_factory=dict, init=False)
    _tapes: dict[bytes, tuple[Source, Composition, TapedRun]] = field(default_factory=dict, init=False)

    def at(self, values: FloatArray) -> Evaluation | None:
        """What the scene predicts at values of its parameters; None where its run fails."""
        key = values.tobytes()
        if key not in self._known and not self._recall(key):
            try:
                composition, run = self._taped(values)
                self._known[key] = Evaluation(self._predicted(composition, run))
                self._keep(key)
            except (SolverError, LawError) as error:
                self.narrator.say(f"a run failed, the step is shortened: {str(error).splitlines()[0]}")
                self.narrator.detail(f"at {self._told(values)}: {error}")
                return None
        return self._known[key]

    def slopes(self, values: FloatArray) -> list[FloatArray]:
        """Derivatives of what it predicts there, for each table (R, C, P).

        Raises:
            ScenarioError: They are not there.
        """
        key = values.tobytes()
        found = self.at(values)
        assert found is not None
        if found.slopes is None:
            composition, run = self._taped(values)
            if self.why is None:
                self.why = why_not(run.simulation) or why_not_by(
                    run.simulation, self._near(values, composition)
                )
                if self.why:
                    self.narrator.say(f"gradients by differences of runs: {self.why}")
            here = self.why or why_not_after(run)
            if here and not self.why:
                self.narrator.say(f"gradients by differences of runs here: {here}")
            found.slopes = self._by_runs(values) if here else self._differentiated(values, composition, run)
            self._keep(key)
            self._tapes.clear()
            self._neighbours.clear()
        return found.slopes

    def _by_runs(self, values: FloatArray) -> list[FloatArray]:
        """Central differences of runs; on one side where the run on the other fails.

        Raises:
            SolverError: Both fail.
        """
        columns = []
        for k, setting in enumerate(self.settings):
            step = _STEP * max(setting.size, abs(float(values[k])))
            sides = []
            for offset in (step, -step):
                there = values.copy()
                there[k] += offset
                if (found := self._beside(there)) is not None:
                    sides.append((offset, found.predicted))
            if len(sides) < 2 and (here := self.at(values)) is not None:
                sides.append((0.0, here.predicted))
            if len(sides) < 2:
                raise SolverError(f"no run on either side of {setting.path} = {values[k]:.6g}")
            (a, one), (b, other) = sides[:2]
            columns.append([(x - y) / (a - b) for x, y in zip(one, other, strict=True)])
        return [np.stack(tables, axis=2) for tables in zip(*columns, strict=True)]

    def _beside(self, values: FloatArray) -> Evaluation | None:
        """An evaluation beside another; None where the scenario does not allow the value either."""
        try:
            return self.at(values)
        except ScenarioError:
            return None

    def _told(self, values: FloatArray) -> str:
        shown = zip(self.settings, values, strict=True)
        return ", ".join(f"{setting.path} = {value:.6g} {setting.unit}".rstrip() for setting, value in shown)

    def _source(self, values: FloatArray) -> Source:
        pairs = zip(self.settings, values, strict=True)
        return self.source.having(*(setting.to(float(value)) for setting, value in pairs))

    def _taped(self, values: FloatArray) -> tuple[Composition, TapedRun]:
        key = values.tobytes()
        if key not in self._tapes:
            source = self._source(values)
            composition = quietly(source)
            self.runs += 1
            run = run_taped(exactly(composition, {}), Silent())
            self._tapes = {key: (source, composition, run)}
        _, composition, run = self._tapes[key]
        return composition, run

    def _channel(self, k: int, composition: Composition, near: Sequence[Nearby]) -> Channel:
        spec = self.curves[k].spec
        path = ("calibrate", "data", k)
        if spec.markers is not None:
            return points(self.loaded, (*path, "markers"), spec.markers, composition, near)
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

    def _predicted(self, composition: Composition, run: TapedRun) -> list[FloatArray]:
        seen, still = states(run.simulation.start, run.steps), isinstance(run.simulation.integrator, Static)
        out = []
        for k, one in enumerate(self.curves):
            channel, sampled = self._channel(k, composition, ()), sampling(one.times, run, still=still)
            read = np.stack([channel.values(seen[i]) for i in sampled.states])
            out.append(np.asarray(sampled.weights @ read))
        return out

    def _differentiated(
        self, values: FloatArray, composition: Composition, run: TapedRun
    ) -> list[FloatArray]:
        seen, still = states(run.simulation.start, run.steps), isinstance(run.simulation.integrator, Static)
        count = len(self.settings)
        if not count:
            return [np.zeros((*one.values.shape, 0)) for one in self.curves]
        near = self._near(values, composition)
        model = differentiated(run, near, sweeper(self.loaded, run.simulation))
        channels = [self._channel(k, composition, near) for k in range(len(self.curves))]
        sampled = [sampling(one.times, run, still=still) for one in self.curves]
        read: list[list[FloatArray]] = [[] for _ in self.curves]
        wanted = [set(one.states.tolist()) for one in sampled]
        try:
            forces = any(channel.of_forces for channel in channels)
            acting = acting_of(run.simulation, near)
            reacting = np.arange(len(run.simulation.start.q)) if forces else NOWHERE
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

    def _near(self, values: FloatArray, composition: Composition) -> list[Nearby]:
        """The scene at neighbours of each value; made once for the values last asked for."""
        key = values.tobytes()
        if key not in self._neighbours:
            source = self._source(values)
            pairs = zip(self.settings, values, strict=True)
            settings = [replace(setting, value=float(value)) for setting, value in pairs]
            self._neighbours = {key: nearby(source, settings, composition)}
        return self._neighbours[key]

    def _file(self, key: bytes) -> Path:
        return self.folder / f"{hashlib.sha256(key).hexdigest()[:16]}.npz"

    def _keep(self, key: bytes) -> None:
        one = self._known[key]
        arrays: dict[str, Any] = {f"predicted_{k}": x for k, x in enumerate(one.predicted)}
        arrays |= {f"slopes_{k}": x for k, x in enumerate(one.slopes or ())}
        with staged(self._file(key)) as temporary, temporary.open("wb") as stream:
            np.savez(stream, values=np.frombuffer(key), **arrays)

    def _recall(self, key: bytes) -> bool:
        file = self._file(key)
        if not file.exists():
            return False
        with np.load(file) as found:
            if found["values"].tobytes() != key:
                return False
            predicted = [found[f"predicted_{k}"] for k in range(len(self.curves))]
            slopes = None
            if "slopes_0" in found:
                slopes = [found[f"slopes_{k}"] for k in range(len(self.curves))]
        self._known[key] = Evaluation(predicted, slopes)
        return True
