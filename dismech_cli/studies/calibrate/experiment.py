"""The scene at values of its parameters: what it predicts for all tables, and the derivatives of that."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ...arrays import FloatArray
from ...compose.compose import Composition
from ...errors import LawError, ScenarioError, SolverError
from ...scenario.load import LoadedScenario
from ...session.narrator import Narrator, Silent
from ..gradient.nearby import Nearby, nearby
from ..gradient.run import TapedRun, exactly, quietly, run_taped, why_not, why_not_after, why_not_by
from ..gradient.setting import Setting
from ..source import Source
from .data import Curves
from .evaluations import Evaluation, Evaluations
from .instruments import Instruments

# Step of differences of runs, of each value.
_STEP = 1e-3


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
    _kept: Evaluations = field(init=False)
    _instruments: Instruments = field(init=False)
    _neighbours: dict[bytes, list[Nearby]] = field(default_factory=dict, init=False)
    _tapes: dict[bytes, tuple[Source, Composition, TapedRun]] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self._kept = Evaluations(self.folder, len(self.curves))
        self._instruments = Instruments(self.loaded, self.curves)

    def at(self, values: FloatArray) -> Evaluation | None:
        """What the scene predicts at values of its parameters; None where its run fails."""
        key = values.tobytes()
        if (known := self._kept.get(key)) is not None:
            return known
        try:
            composition, run = self._taped(values)
            made = Evaluation(self._instruments.predicted(composition, run))
        except (SolverError, LawError) as error:
            self.narrator.say(f"a run failed, the step is shortened: {str(error).splitlines()[0]}")
            self.narrator.detail(f"at {self._told(values)}: {error}")
            return None
        self._kept.keep(key, made)
        return made

    def slopes(self, values: FloatArray) -> list[FloatArray]:
        """Derivatives of what it predicts there, for each table (R, C, P).

        Raises:
            ScenarioError: They are not there.
        """
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
            found.slopes = self._by_runs(values) if here else self._exact(values, composition, run)
            self._kept.keep(values.tobytes(), found)
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

    def _exact(self, values: FloatArray, composition: Composition, run: TapedRun) -> list[FloatArray]:
        near = self._near(values, composition) if self.settings else []
        return self._instruments.slopes(composition, run, near)

    def _near(self, values: FloatArray, composition: Composition) -> list[Nearby]:
        """The scene at neighbours of each value; made once for the values last asked for."""
        key = values.tobytes()
        if key not in self._neighbours:
            source = self._source(values)
            pairs = zip(self.settings, values, strict=True)
            settings = [replace(setting, value=float(value)) for setting, value in pairs]
            self._neighbours = {key: nearby(source, settings, composition)}
        return self._neighbours[key]
