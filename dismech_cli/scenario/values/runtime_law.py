"""Laws of the scenario to laws of the run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from ...arrays import FloatArray
from ...csv_columns import read_columns
from ...laws import laws
from .law import ExpressionLaw, LawSpec, RampLaw, SawtoothLaw, SineLaw, TableFile, TableLaw


def to_law(
    spec: LawSpec, directory: Path, places: Mapping[str, FloatArray] = MappingProxyType({})
) -> laws.Law:
    """The runtime law of a scenario law.

    Args:
        spec: As validated, in SI units.
        directory: Folder of the scenario, where names of table files start.
        places: Values of the variables of :data:`.law.PLACES`, where the law may use them.

    Raises:
        ScenarioError: if a table file cannot be used.
    """
    match spec:
        case TableLaw():
            return _table(spec, directory)
        case RampLaw(ramp=r):
            return laws.Ramp(before=r.before, after=r.after, start=r.start, end=r.end)
        case SineLaw(sine=w):
            return laws.Sine(amplitude=w.amplitude, frequency=w.frequency, phase=w.phase, offset=w.offset)
        case SawtoothLaw(sawtooth=w):
            return laws.Sawtooth(
                amplitude=w.amplitude, frequency=w.frequency, phase=w.phase, offset=w.offset, width=w.width
            )
        case ExpressionLaw(expression=text):
            return laws.Expression(text, places)
        case number:
            return laws.Constant(float(number))


def _table(spec: TableLaw, directory: Path) -> laws.Table:
    if isinstance(spec.table, TableFile):
        file = spec.table
        times, values = (c.tolist() for c in read_columns(directory / file.file, (file.time, file.value)))
    else:
        times, values = [row[0] for row in spec.table], [row[1] for row in spec.table]
    return laws.Table(times=tuple(times), values=tuple(values), interpolation=spec.interpolation)
