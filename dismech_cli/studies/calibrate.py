"""Fit values of a scenario to measured curves, and say what the curves cannot tell; ``dismech calibrate``."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from scipy.optimize import least_squares

from ..arrays import BoolArray, FloatArray, IntArray
from ..errors import ScenarioError, SolverError
from ..output.durable import output_errors
from ..quantities import QuantityError, read_quantity
from ..scenario.language.calibrate import Fitted
from ..scenario.language.numerics import Static
from ..scenario.load import LoadedScenario
from ..session.narrator import Narrator
from ..words import hint
from . import calibrate_camera as camera
from .calibrate_data import Curves, read_curves
from .calibrate_experiment import Experiment
from .gradient_run import start_run
from .gradient_setting import Setting, expanded
from .source import Source

_MAX_EVALUATIONS: Final = 60
# Values told of each evaluation.
_TOLD: Final = 6
# Deviations beyond which a sample counts by its distance only.
_FAR: Final = 2.0
# Share of the strongest direction below which a direction of the parameters is not seen at all.
_UNSEEN: Final = 1e-6
# Correlation from which two values are hardly told apart; squares per degree of freedom that are too many.
_ALIKE: Final = 0.99
_POOR: Final = 2.0
# Deviation of samples of which none is given, of their range; the fit says what it is.
_GUESS: Final = 0.01


@dataclass(frozen=True, slots=True)
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


@dataclass(frozen=True, slots=True)
class Table:
    """How a table of samples is met.

    Attributes:
        curves: The samples.
        deviation: Standard deviation taken for them.
        fit: Root mean square of what is left of the fitted samples.
        worst: The largest.
        held: Root mean square of those kept out; NaN if there are none.
        scale: Size of a metre in them, where they are of a picture; else 1.
        samples: How many are fitted.
        shown: What the fit gives in their places, shape (R, C).
    """

    curves: Curves
    deviation: float
    fit: float
    worst: float
    held: float
    scale: float
    samples: int
    shown: FloatArray


@dataclass(frozen=True, slots=True)
class Fit:
    """The end of a fit.

    Attributes:
        knobs: What was fitted.
        values: To these values.
        deviations: Standard deviations of the numbers fitted: relative where the logarithm is.
        correlation: Of all of them, shape (P, P).
        condition: Ratio of the strongest to the weakest direction that is seen.
        unseen: Directions of the parameters that the samples do not see, each of shape (P,).
        at_bound: Which stopped at a bound.
        far: Which moved by more than three deviations of what was known.
        chi2: Sum of squares per degree of freedom.
        known: Whether the deviations of all samples are given.
        tables: How each table is met.
        cameras: Of each table that is a picture.
        evaluations: Points at which the scene was evaluated.
        runs: Runs that this took, those of an earlier process not counted.
        message: Why it ended.
        finer: Change of each value at half the time step, in deviations; empty where that was not asked for.
    """

    knobs: tuple[Knob, ...]
    values: FloatArray
    deviations: FloatArray
    correlation: FloatArray
    condition: float
    unseen: tuple[FloatArray, ...]
    at_bound: tuple[bool, ...]
    far: tuple[bool, ...]
    chi2: float
    known: bool
    tables: tuple[Table, ...]
    cameras: tuple[FloatArray | None, ...]
    evaluations: int
    runs: int
    message: str
    finer: FloatArray

    @property
    def doubts(self) -> tuple[str, ...]:
        """Why not to believe the values, a line each."""
        told = []
        for k, knob in enumerate(self.knobs):
            path = knob.setting.path
            if self.at_bound[k]:
                told.append(f"{path} stopped at a bound: what is beyond may fit better")
            if self.far[k]:
                told.append(
                    f"{path} moved by more than 3 deviations of what was known of it: the model may be wrong "
                    "where this value makes up for it"
                )
            if len(self.finer) and abs(self.finer[k]) > 2.0:
                change = f"{self.finer[k]:.2g} deviations at half the time step"
                told.append(f"{path} changes by {change}: take a shorter one")
        for row in self.unseen:
            shown = [
                f"{knob.setting.path} by {part:+.2g}"
                for knob, part in zip(self.knobs, row, strict=True)
                if abs(part) > 0.1
            ]
            told.append(
                f"the samples do not see changes of {', '.join(shown) or 'a camera'}: fix one of them"
            )
        for i, one in enumerate(self.knobs):
            for j in range(i):
                if abs(self.correlation[i, j]) > _ALIKE:
                    told.append(
                        f"{self.knobs[j].setting.path} and {one.setting.path} are hardly told apart: "
                        f"correlation {self.correlation[i, j]:.4f}"
                    )
        if self.known and self.chi2 > _POOR:
            told.append(
                f"what is left is {self.chi2**0.5:.2g} times as large as the deviations of the samples: the "
                "model does not explain them"
            )
        return tuple(told)


def calibrate(source: Source, folder: Path, narrator: Narrator, *, finer: bool = True) -> Fit:
    """Fit what ``calibrate:`` of a scenario says.

    Args:
        source: The scenario.
        folder: Where evaluations are kept; what is there already is not run again.
        narrator: Told what happens.
        finer: Whether the fit is repeated at half the time step.

    Raises:
        ScenarioError: The scenario or its data cannot be used.
        SolverError: The run at the start fails.
    """
    loaded, _ = start_run(source, narrator)
    if loaded.scenario.calibrate is None:
        raise ScenarioError(f"{source.path}: has no 'calibrate': docs/calibration.md shows one")
    problem = _Problem.of(source, loaded, folder, narrator)
    x, fit = problem.solve(problem.start())
    still = isinstance(loaded.scenario.numerics.integrator, Static)
    if not finer or still or not problem.knobs:
        return fit
    dt = loaded.scenario.numerics.dt
    assert dt is not None
    narrator.say(f"again at half the time step, {dt / 2:.6g} s")
    halved = source.having(f"numerics.dt={dt / 2!r}")
    again = _Problem.of(halved, halved.load(), folder, narrator)
    y, other = again.solve(x)
    n = len(problem.knobs)
    change = (y[:n] - x[:n]) / np.where(fit.deviations > 0.0, fit.deviations, np.inf)
    return replace(fit, finer=change, runs=fit.runs + other.runs)


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


@dataclass(slots=True)
class _Problem:
    """Least squares over the parameters, then over the four numbers of each camera."""

    experiment: Experiment
    knobs: tuple[Knob, ...]
    deviations: tuple[float, ...]
    robust: bool
    narrator: Narrator
    evaluations: int = 0

    @classmethod
    def of(cls, source: Source, loaded: LoadedScenario, folder: Path, narrator: Narrator) -> _Problem:
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
        found = self.experiment.at(self._values(np.array(inner)))
        if found is None:
            raise SolverError("the run from which the fit would start fails")
        for k in self.pictures:
            one = self.curves[k]
            inner += camera.found(found.predicted[k][one.fitted], one.values[one.fitted]).tolist()
        return np.array(inner)

    def solve(self, x: FloatArray) -> tuple[FloatArray, Fit]:
        """The fit from a start."""
        n = len(self.knobs)
        low = [knob.inner(knob.low) if knob.low > 0.0 or not knob.log else -np.inf for knob in self.knobs]
        high = [knob.inner(knob.high) for knob in self.knobs]
        free = [np.inf] * (len(x) - n)
        bounds = ([*low, *(-one for one in free)], [*high, *free])
        margin = 1e-9 * np.maximum(np.abs(x), 1.0)
        inside = np.clip(x, np.array(bounds[0]) + margin, np.array(bounds[1]) - margin)
        # the number of runs that are needed is small: each is dear
        found = least_squares(
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
        return found.x, self._judged(found.x, np.asarray(found.jac), found.active_mask, str(found.message))

    def _values(self, x: FloatArray) -> FloatArray:
        pairs = zip(self.knobs, x[: len(self.knobs)], strict=True)
        return np.array([knob.outer(float(one)) for knob, one in pairs])

    def _cameras(self, x: FloatArray) -> dict[int, FloatArray]:
        numbers = x[len(self.knobs) :].reshape(-1, camera.COUNT)
        return dict(zip(self.pictures, numbers, strict=True))

    def _shown(self, x: FloatArray) -> list[FloatArray] | None:
        """What each table should show, shape (R, C)."""
        found = self.experiment.at(self._values(x))
        if found is None:
            return None
        cameras = self._cameras(x)
        return [
            camera.pictured(cameras[k], one) if k in cameras else one for k, one in enumerate(found.predicted)
        ]

    def _left(self, x: FloatArray) -> list[FloatArray] | None:
        """What is left of each table, per deviation, shape (R, C)."""
        shown = self._shown(x)
        if shown is None:
            return None
        return [
            (one - curves.values) / deviation
            for one, curves, deviation in zip(shown, self.curves, self.deviations, strict=True)
        ]

    def _rows(self, k: int) -> BoolArray:
        """Which samples of a table are fitted, shape (R, C)."""
        one = self.curves[k]
        return one.fitted[:, None] & np.isfinite(one.values)

    def _residual(self, x: FloatArray) -> FloatArray:
        left = self._left(x)
        size = sum(int(self._rows(k).sum()) for k in range(len(self.curves))) + self._priors
        if left is None:
            return np.full(size, np.nan)  # the step is shortened then
        parts = [one[self._rows(k)] for k, one in enumerate(left)]
        residual = np.concatenate([*parts, self._prior(x)])
        self.evaluations += 1
        share = 0.5 * float(residual @ residual)
        self.narrator.say(f"evaluation {self.evaluations}: cost {share:.6g}, {self._told(x)}")
        return residual

    @property
    def _priors(self) -> int:
        return sum(bool(np.isfinite(knob.deviation)) for knob in self.knobs)

    def _prior(self, x: FloatArray) -> FloatArray:
        return np.array(
            [
                (x[k] - knob.inner(knob.setting.value)) / knob.deviation
                for k, knob in enumerate(self.knobs)
                if np.isfinite(knob.deviation)
            ]
        )

    def _jacobian(self, x: FloatArray) -> FloatArray:
        slopes, found = self.experiment.slopes(self._values(x)), self.experiment.at(self._values(x))
        assert found is not None
        cameras, n = self._cameras(x), len(self.knobs)
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
            rows.append(by_all[self._rows(k)] / deviation)
        prior = np.zeros((self._priors, len(x)))
        known = [k for k, knob in enumerate(self.knobs) if np.isfinite(knob.deviation)]
        for row, k in enumerate(known):
            prior[row, k] = 1.0 / self.knobs[k].deviation
        return np.concatenate([*rows, prior])

    def _told(self, x: FloatArray) -> str:
        values = self._values(x)
        shown = [f"{knob.setting.path} {value:.6g}" for knob, value in zip(self.knobs, values, strict=True)]
        more = [f"and {len(shown) - _TOLD} more"] if len(shown) > _TOLD else []
        return ", ".join([*shown[:_TOLD], *more]) or "cameras alone"

    def _judged(self, x: FloatArray, jacobian: FloatArray, active: IntArray, why: str) -> Fit:
        """What the fit is worth."""
        n = len(self.knobs)
        left = self._left(x)
        assert left is not None
        # directions in units of the values themselves: logarithms have none
        sizes = np.array(
            [
                1.0 if knob.log else max(knob.setting.size, abs(value))
                for knob, value in zip(self.knobs, self._values(x), strict=True)
            ]
        )
        units = np.concatenate((sizes, np.maximum(np.abs(x[n:]), 1.0)))
        rows = np.zeros((max(len(jacobian), len(x)), len(x)))  # directions that no sample asks for count too
        rows[: len(jacobian)] = jacobian * units
        _, strength, directions = np.linalg.svd(rows, full_matrices=False)
        seen = strength > _UNSEEN * strength[0]
        fitted = np.concatenate([one[self._rows(k)] for k, one in enumerate(left)])
        freedom = max(len(fitted) + self._priors - len(x), 1)
        cost = np.concatenate((fitted, self._prior(x)))
        chi2 = float(cost @ cost) / freedom
        known = all(one.deviation is not None for one in self.curves)
        root = directions[seen].T / strength[seen]
        covariance = (root @ root.T) * np.outer(units, units) * (1.0 if known else chi2)
        covariance = covariance[:n, :n]
        deviations = np.sqrt(np.diag(covariance))
        safe = np.where(deviations > 0.0, deviations, 1.0)
        cameras = self._cameras(x)
        condition = float(strength[0] / strength[seen][-1]) if seen.any() else np.inf
        blind = [row[:n] for row in directions[~seen]]
        values = self._values(x)
        moved = [
            abs(x[k] - knob.inner(knob.setting.value)) > 3.0 * knob.deviation
            for k, knob in enumerate(self.knobs)
        ]
        return Fit(
            knobs=self.knobs,
            values=values,
            deviations=deviations,
            correlation=covariance / np.outer(safe, safe),
            condition=condition,
            unseen=tuple(blind),
            at_bound=tuple(bool(active[k]) or self._near_bound(k, values[k]) for k in range(n)),
            far=tuple(map(bool, moved)),
            chi2=chi2,
            known=known,
            tables=tuple(self._table(k, one, cameras.get(k)) for k, one in enumerate(left)),
            cameras=tuple(cameras.get(k) for k in range(len(self.curves))),
            evaluations=self.evaluations,
            runs=self.experiment.runs,
            message=why,
            finer=np.empty(0),
        )

    def _near_bound(self, k: int, value: float) -> bool:
        knob = self.knobs[k]
        slack = 1e-6 * knob.setting.size
        return bool(value - knob.low < slack or knob.high - value < slack)

    def _table(self, k: int, left: FloatArray, seen: FloatArray | None) -> Table:
        one, deviation = self.curves[k], self.deviations[k]
        fitted = np.abs(left[self._rows(k)]) * deviation
        held = (left[one.held] * deviation)[np.isfinite(one.values[one.held])]
        return Table(
            curves=one,
            deviation=deviation,
            fit=float(np.sqrt(np.mean(fitted**2))),
            worst=float(fitted.max()),
            held=float(np.sqrt(np.mean(held**2))) if held.size else float("nan"),
            scale=1.0 if seen is None else camera.scale(seen),
            samples=int(fitted.size),
            shown=one.values + left * deviation,
        )


def _deviation(one: Curves) -> float:
    """Standard deviation of the samples of a table, guessed where it is not given."""
    if one.deviation is not None:
        return one.deviation
    return _GUESS * (float(np.nanmax(np.ptp(one.values[one.fitted], axis=0), initial=0.0)) or _size(one))


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
