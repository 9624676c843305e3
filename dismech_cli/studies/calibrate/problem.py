"""Least squares over the values of a scenario, and over the cameras that saw it."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from ...arrays import FloatArray
from ...errors import SolverError
from ...output.durable import output_errors
from ...scenario.load import LoadedScenario
from ...session.narrator import Narrator
from ...words import hint
from ..source import Source
from . import camera
from .data import Curves, read_curves
from .experiment import Experiment
from .knobs import Knob, knobs_of

_MAX_EVALUATIONS: Final = 60
# Values told of each evaluation.
_TOLD: Final = 6
# Deviations beyond which a sample counts by its distance only.
_FAR: Final = 2.0
# Deviation of samples of which none is given, of their range; the fit says what it is.
_GUESS: Final = 0.01


@dataclass(slots=True)
class Problem:
    """Least squares over the parameters, then over the four numbers of each camera."""

    experiment: Experiment
    knobs: tuple[Knob, ...]
    deviations: tuple[float, ...]
    robust: bool
    narrator: Narrator
    evaluations: int = 0

    @classmethod
    def of(cls, source: Source, loaded: LoadedScenario, folder: Path, narrator: Narrator) -> Problem:
        """The problem that a scenario states; evaluations are kept in a folder.

        Raises:
            ScenarioError: What it fits or its data cannot be used.
            OutputError: The folder cannot be made.
        """
        knobs, curves = knobs_of(loaded), read_curves(loaded)
        _check_probes(loaded, curves)
        spec = loaded.scenario.calibrate
        assert spec is not None
        identity = hashlib.sha256(
            (loaded.text_hash + repr([one.values.tobytes() for one in curves])).encode()
        )
        kept = folder / "evaluations" / identity.hexdigest()[:12]
        with output_errors(kept, "create"):
            kept.mkdir(parents=True, exist_ok=True)
        settings = tuple(knob.setting for knob in knobs)
        experiment = Experiment(source, loaded, settings, curves, kept, narrator)
        return cls(experiment, knobs, tuple(map(_deviation, curves)), spec.robust, narrator)

    @property
    def curves(self) -> tuple[Curves, ...]:
        """The tables of samples."""
        return self.experiment.curves

    @property
    def pictures(self) -> list[int]:
        """Numbers of the tables that are pictures."""
        return [
            k for k, one in enumerate(self.curves) if one.spec.markers is not None and one.spec.markers.camera
        ]

    def start(self) -> FloatArray:
        """Where the fit starts.

        Raises:
            SolverError: The run there fails.
        """
        inner = [knob.inner(knob.setting.value) for knob in self.knobs]
        found = self.experiment.at(self.values(np.array(inner)))
        if found is None:
            raise SolverError("the run from which the fit would start fails")
        for k in self.pictures:
            one = self.curves[k]
            inner += camera.found(found.predicted[k], np.where(one.fitted, one.values, np.nan)).tolist()
        return np.array(inner)

    def solve(self, x: FloatArray) -> OptimizeResult:
        """What SciPy finds from a start."""
        n = len(self.knobs)
        low = [knob.inner(knob.low) if knob.low > 0.0 or not knob.log else -np.inf for knob in self.knobs]
        high = [knob.inner(knob.high) for knob in self.knobs]
        free = [np.inf] * (len(x) - n)
        bounds = ([*low, *(-one for one in free)], [*high, *free])
        margin = 1e-9 * np.maximum(np.abs(x), 1.0)
        inside = np.clip(x, np.array(bounds[0]) + margin, np.array(bounds[1]) - margin)
        # the number of runs that are needed is small: each is dear
        return least_squares(
            self._residual,
            inside,
            self._jacobian,
            bounds,
            method="trf",
            x_scale="jac",
            loss="soft_l1" if self.robust else "linear",
            f_scale=_FAR,
            ftol=1e-8,
            xtol=1e-8,
            gtol=1e-8,
            max_nfev=_MAX_EVALUATIONS,
        )

    def values(self, x: FloatArray) -> FloatArray:
        """Values of the scenario [SI], shape (K,), of the numbers that are fitted (P,)."""
        pairs = zip(self.knobs, x[: len(self.knobs)], strict=True)
        return np.array([knob.outer(float(one)) for knob, one in pairs])

    def cameras(self, x: FloatArray) -> dict[int, FloatArray]:
        """The four numbers of each camera, by the number of its table."""
        numbers = x[len(self.knobs) :].reshape(-1, camera.COUNT)
        return dict(zip(self.pictures, numbers, strict=True))

    def _shown(self, x: FloatArray) -> list[FloatArray] | None:
        """What each table should show, shape (R, C)."""
        found = self.experiment.at(self.values(x))
        if found is None:
            return None
        cameras = self.cameras(x)
        return [
            camera.pictured(cameras[k], one) if k in cameras else one for k, one in enumerate(found.predicted)
        ]

    def left(self, x: FloatArray) -> list[FloatArray] | None:
        """What is left of each table, per deviation, shape (R, C)."""
        shown = self._shown(x)
        if shown is None:
            return None
        return [
            (one - curves.values) / deviation
            for one, curves, deviation in zip(shown, self.curves, self.deviations, strict=True)
        ]

    def _residual(self, x: FloatArray) -> FloatArray:
        left = self.left(x)
        size = sum(int(one.fitted.sum()) for one in self.curves) + self.priors
        if left is None:
            return np.full(size, np.nan)  # the step is shortened then
        parts = [one[curves.fitted] for one, curves in zip(left, self.curves, strict=True)]
        residual = np.concatenate([*parts, self.prior(x)])
        self.evaluations += 1
        share = 0.5 * float(residual @ residual)
        self.narrator.say(f"evaluation {self.evaluations}: cost {share:.6g}, {self._told(x)}")
        return residual

    @property
    def priors(self) -> int:
        """How many values something was known of."""
        return sum(bool(np.isfinite(knob.deviation)) for knob in self.knobs)

    def prior(self, x: FloatArray) -> FloatArray:
        """How far those are from it, in its deviations."""
        return np.array(
            [
                (x[k] - knob.inner(knob.setting.value)) / knob.deviation
                for k, knob in enumerate(self.knobs)
                if np.isfinite(knob.deviation)
            ]
        )

    def _jacobian(self, x: FloatArray) -> FloatArray:
        slopes, found = self.experiment.slopes(self.values(x)), self.experiment.at(self.values(x))
        assert found is not None
        cameras, n = self.cameras(x), len(self.knobs)
        factors = np.array([knob.slope(float(one)) for knob, one in zip(self.knobs, x[:n], strict=True)])
        rows = []
        for k, (one, deviation) in enumerate(zip(slopes, self.deviations, strict=True)):
            by_all = np.zeros((*one.shape[:2], len(x)))
            moves = one * factors
            if k in cameras:
                moves = np.moveaxis(camera.turned(cameras[k], np.moveaxis(moves, 2, 0)), 0, 2)
                at = n + camera.COUNT * self.pictures.index(k)
                by_camera = camera.slopes(found.predicted[k])
                by_all[:, :, at : at + camera.COUNT] = np.moveaxis(by_camera, 0, 2)
            by_all[:, :, :n] = moves
            rows.append(by_all[self.curves[k].fitted] / deviation)
        prior = np.zeros((self.priors, len(x)))
        known = [k for k, knob in enumerate(self.knobs) if np.isfinite(knob.deviation)]
        for row, k in enumerate(known):
            prior[row, k] = 1.0 / self.knobs[k].deviation
        return np.concatenate([*rows, prior])

    def _told(self, x: FloatArray) -> str:
        values = self.values(x)
        shown = [f"{knob.setting.path} {value:.6g}" for knob, value in zip(self.knobs, values, strict=True)]
        more = [f"and {len(shown) - _TOLD} more"] if len(shown) > _TOLD else []
        return ", ".join([*shown[:_TOLD], *more]) or "cameras alone"


def _deviation(one: Curves) -> float:
    """Standard deviation of the samples of a table, guessed where it is not given."""
    if one.deviation is not None:
        return one.deviation
    fitted = np.where(one.fitted, one.values, np.nan)
    seen = one.fitted.any(axis=0)
    ranges = np.nanmax(fitted[:, seen], axis=0) - np.nanmin(fitted[:, seen], axis=0)
    return _GUESS * (float(ranges.max(initial=0.0)) or _size(one))


def _size(one: Curves) -> float:
    return float(np.nanmax(np.abs(one.values), initial=0.0)) or 1.0


def _check_probes(loaded: LoadedScenario, curves: Sequence[Curves]) -> None:
    """Refuse probes that are not there."""
    known = loaded.scenario.output.probes
    for k, one in enumerate(curves):
        for name in one.spec.probes or ():
            if name not in known:
                path = ("calibrate", "data", k, "probes", name)
                raise loaded.error(path, f"no probe of the output has this name{hint(name, known)}")
        if one.spec.markers is not None and one.spec.markers.camera and len(one.spec.markers.columns) != 2:
            path = ("calibrate", "data", k, "markers", "columns")
            raise loaded.error(path, "a picture shows two coordinates")
