"""Measured curves: tables of samples with their times, units and gaps."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray
from ...csv_columns import read_columns
from ...errors import ScenarioError
from ...frozen import frozen
from ...quantities import QuantityError, read_quantity
from ...scenario.language.calibrate import Markers, Samples
from ...scenario.load import LoadedScenario
from ...scenario.text.tree import KeyPath
from ...units import KINDS, Dimension

_HDF5 = (".h5", ".hdf5")


@frozen
class Curves:
    """One table of samples.

    Attributes:
        spec: As the scenario says.
        times: Time of each row [s], shape (R,); None where all are of the end of the run.
        values: Samples in SI units, of a picture in its own; NaN where there is none, shape (R, C).
        labels: A word for each column, shape (C,).
        deviation: Standard deviation of a sample, in the same units; None if not known.
        among: Rows that count, shape (R,).
        fitted: Samples that are fitted, shape (R, C).
        held: Samples that are kept out of the fit, shape (R, C).
    """

    spec: Samples
    times: FloatArray | None
    values: FloatArray
    labels: tuple[str, ...]
    deviation: float | None
    among: BoolArray
    fitted: BoolArray
    held: BoolArray


def read_curves(loaded: LoadedScenario) -> tuple[Curves, ...]:
    """All tables of a scenario.

    Raises:
        ScenarioError: One cannot be read, or holds no sample that counts.
    """
    assert loaded.scenario.calibrate is not None
    return tuple(_read(loaded, k, one) for k, one in enumerate(loaded.scenario.calibrate.data))


def _read(loaded: LoadedScenario, k: int, spec: Samples) -> Curves:
    path: KeyPath = ("calibrate", "data", k)
    factor = _factor(loaded, (*path, "unit"), spec.unit, spec)
    columns, labels = _columns(loaded, (*path, "markers"), spec)
    names = list(columns) if spec.time is None else [spec.time, *columns]
    try:
        found = _table(loaded.directory / spec.file, names)
    except ScenarioError as error:
        raise loaded.error((*path, "file"), str(error)) from None
    values = factor * np.stack(found if spec.time is None else found[1:], axis=1)
    if spec.time is None:
        rows = values.shape[0]
        if spec.markers is not None:
            count = count_of(spec.markers)
            if rows != count:
                message = f"{spec.file} has {rows} rows for {count} markers: without 'time' each row is one"
                raise loaded.error((*path, "markers"), message)
            # one row of all, marker by marker
            values = values.reshape(1, -1)
            labels = tuple(f"{letter}_{i}" for i in range(count) for letter in spec.markers.columns)
        elif rows != 1:
            raise loaded.error(
                (*path, "time"), f"{spec.file} has {rows} rows: say which column has the times"
            )
        times, among = None, np.ones(1, dtype=np.bool_)
    else:
        times = _seconds(loaded, (*path, "time_unit"), spec.time_unit) * found[0]
        if np.isnan(times).any() or (np.diff(times) <= 0.0).any():
            raise loaded.error((*path, "time"), f"the times of {spec.file} must increase")
        among = np.ones(len(times), dtype=np.bool_)
        if spec.after is not None:
            among &= times >= spec.after
        if spec.before is not None:
            among &= times <= spec.before
    held = np.zeros(values.shape, dtype=np.bool_)
    if spec.hold_out is not None:
        held[np.flatnonzero(among)[spec.hold_out - 1 :: spec.hold_out]] = True
    if spec.markers is not None:
        held[:, _predicted(loaded, (*path, "markers"), spec.markers)] = True
    there = among[:, None] & np.isfinite(values)
    fitted, held = there & ~held, there & held
    if not fitted.any():
        raise loaded.error(path, f"no sample of {spec.file} is left to fit")
    deviation = None if spec.deviation is None else spec.deviation * factor
    return Curves(spec, times, values, labels, deviation, among, fitted, held)


def _predicted(loaded: LoadedScenario, path: KeyPath, markers: Markers) -> IntArray:
    """Columns of markers that are kept out of the fit.

    Raises:
        ScenarioError: There is no such marker.
    """
    count, letters = count_of(markers), len(markers.columns)
    for k, number in enumerate(markers.predicted):
        if not markers.first <= number < markers.first + count:
            last = markers.first + count - 1
            message = f"markers are numbered from {markers.first} to {last}; there is no {number}"
            raise loaded.error((*path, "predicted", k), message)
    places = np.array(markers.predicted, dtype=np.int64) - markers.first
    return np.asarray((places[:, None] * letters + np.arange(letters)).ravel())


def _columns(loaded: LoadedScenario, path: KeyPath, spec: Samples) -> tuple[list[str | int], tuple[str, ...]]:
    """Columns of the file, marker by marker, and words for them."""
    if spec.probes is not None:
        return list(spec.probes.values()), tuple(spec.probes)
    markers = spec.markers
    assert markers is not None
    if spec.time is None:
        return list(markers.columns.values()), tuple(markers.columns)
    for letter, pattern in markers.columns.items():
        if "{i}" not in pattern:
            raise loaded.error(
                (*path, "columns", letter), "expected {i} where the number of the marker stands"
            )
    count = count_of(markers)
    columns: list[str | int] = []
    labels = []
    for i in range(markers.first, markers.first + count):
        for letter, pattern in markers.columns.items():
            columns.append(pattern.replace("{i}", str(i)))
            labels.append(f"{letter}_{i}")
    return columns, tuple(labels)


def _table(file: Path, names: list[str | int]) -> tuple[FloatArray, ...]:
    """Columns of a CSV file or data sets of an HDF5 file, all of one length.

    Raises:
        ScenarioError: One is not there or holds no numbers.
    """
    if file.suffix.lower() not in _HDF5:
        return read_columns(file, names, gaps=True)
    try:
        with h5py.File(file, "r") as h5:
            missing = [str(name) for name in names if str(name) not in h5]
            if missing:
                raise ScenarioError(f"{file}: has no data set {missing[0]!r}; there are {', '.join(h5)}")
            columns = tuple(np.asarray(h5[str(name)], dtype=np.float64) for name in names)
    except (OSError, ValueError, TypeError) as error:
        raise ScenarioError(f"{file}: cannot read: {error}") from None
    if any(column.ndim != 1 or len(column) != len(columns[0]) for column in columns):
        raise ScenarioError(f"{file}: its columns must be data sets of one dimension and one length")
    return columns


def _factor(loaded: LoadedScenario, path: KeyPath, unit: str, spec: Samples) -> float:
    """SI value of the unit of the samples.

    Raises:
        ScenarioError: It is no unit of what is measured.
    """
    factor, dimension = _unit(loaded, path, unit)
    markers = spec.markers
    if markers is not None and not markers.camera and dimension != KINDS["length"].dimension:
        raise loaded.error(path, f"positions are lengths, and {unit!r} is none")
    return factor


def _seconds(loaded: LoadedScenario, path: KeyPath, unit: str) -> float:
    factor, dimension = _unit(loaded, path, unit)
    if dimension is not None and any(dimension) and dimension != KINDS["time"].dimension:
        raise loaded.error(path, f"expected a unit of time such as ms, got {unit!r}")
    return factor


def _unit(loaded: LoadedScenario, path: KeyPath, unit: str) -> tuple[float, Dimension | None]:
    try:
        return read_quantity(f"1 {unit}")
    except QuantityError as error:
        raise loaded.error(path, str(error)) from None


def count_of(markers: Markers) -> int:
    """How many markers there are."""
    return len(markers.nodes or markers.arc or ())
