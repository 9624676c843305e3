"""The report of a fit: for the terminal, for programs, as a page, and the scenario with the fitted values."""

from __future__ import annotations

from math import isfinite
from pathlib import Path

from ...output.durable import write_bytes
from ...output.jsonable import Json, dumps, to_json
from ...quantities import read_quantity, with_unit
from ...scenario.load import dump_resolved
from ...scenario.views.walk import leaves
from ..source import Source
from .fit import Fit, Table
from .knobs import Knob

SCENARIO_FILE = "fitted.yaml"
# Markers and probes that are told one by one.
_PARTS = 40


def write_report(folder: Path, source: Source, fit: Fit) -> None:
    """Write ``report.json``, ``report.md`` and the scenario with the fitted values.

    Raises:
        OutputError: One cannot be written.
    """
    write_bytes(folder / "report.json", (dumps(as_json(fit), indent=2) + "\n").encode())
    write_bytes(folder / "report.md", as_markdown(source, fit).encode())
    changes = [knob.setting.to(float(value)) for knob, value in zip(fit.knobs, fit.values, strict=True)]
    loaded = source.load(*changes)
    files = {name: str((loaded.directory / name).resolve()) for name in _files(source)}
    write_bytes(folder / SCENARIO_FILE, dump_resolved(loaded.scenario, files, loaded.parameters).encode())


def _files(source: Source) -> list[str]:
    return [leaf.value for leaf in leaves(source.load().scenario) if leaf.file and leaf.path[0] != "include"]


def as_json(fit: Fit) -> dict[str, Json]:
    """For programs."""
    return {
        "parameters": [
            {
                "of": knob.setting.path,
                "unit": knob.setting.unit,
                "start": to_json(knob.setting.value),
                "value": to_json(float(fit.values[k])),
                "deviation": to_json(_deviation(fit, k)),
                "at_bound": fit.at_bound[k],
                "moved_far": fit.far[k],
                "finer": to_json(float(fit.finer[k])) if len(fit.finer) else None,
            }
            for k, knob in enumerate(fit.knobs)
        ],
        "correlation": [[to_json(float(x)) for x in row] for row in fit.correlation],
        "condition": to_json(fit.condition),
        "unseen": [[to_json(float(x)) for x in row] for row in fit.unseen],
        "chi2": to_json(fit.chi2),
        "deviations_known": fit.known,
        "data": [
            {
                "file": one.curves.spec.file,
                "unit": one.curves.spec.unit,
                "samples": one.samples,
                "deviation": to_json(_shown(one, one.deviation)),
                "rms": to_json(_shown(one, one.fit)),
                "worst": to_json(_shown(one, one.worst)),
                "held_out_rms": to_json(_shown(one, one.held)) if isfinite(one.held) else None,
                "scale": to_json(one.scale) if one.scale != 1.0 else None,
                "parts": [
                    {
                        "name": part.name,
                        "mean": _or_none(one, part.mean),
                        "worst": _or_none(one, part.worst),
                        "held_out_mean": _or_none(one, part.held),
                        "held_out_worst": _or_none(one, part.worst_held),
                    }
                    for part in one.parts
                ],
            }
            for one in fit.tables
        ],
        "cameras": [None if one is None else [to_json(float(x)) for x in one] for one in fit.cameras],
        "evaluations": fit.evaluations,
        "runs": fit.runs,
        "message": fit.message,
        "doubts": list(fit.doubts),
    }


def as_text(fit: Fit) -> str:
    """For people."""
    lines = _columns(parameter_rows(fit)) if fit.knobs else []
    lines += _columns(data_rows(fit))
    if len(parts := part_rows(fit)) > 1:
        lines += _columns(parts)
    lines.append(
        f"{fit.evaluations} evaluations, {fit.runs} runs; chi2/dof {fit.chi2:.3g}, "
        f"condition {fit.condition:.2g}"
    )
    return "\n".join(lines)


def as_markdown(source: Source, fit: Fit) -> str:
    """As a page."""
    parts = [f"# Calibration of {source.path.name}", ""]
    if fit.knobs:
        parts += [*_table(parameter_rows(fit)), ""]
    parts += [*_table(data_rows(fit)), ""]
    if len(each := part_rows(fit)) > 1:
        parts += [*_table(each), ""]
    parts.append(
        f"{fit.evaluations} evaluations, {fit.runs} runs. {fit.message} "
        f"Sum of squares per degree of freedom {fit.chi2:.4g}; condition number {fit.condition:.3g}."
    )
    if not fit.known:
        parts.append(
            "Deviations of samples are not all given: those of values follow from what the fit left."
        )
    if fit.doubts:
        parts += ["", "## Doubts", "", *(f"- {doubt}" for doubt in fit.doubts)]
    if len(fit.knobs) > 1:
        names = [knob.setting.path for knob in fit.knobs]
        rows = [["", *names]]
        rows += [[name, *(f"{x:.3f}" for x in row)] for name, row in zip(names, fit.correlation, strict=True)]
        parts += ["", "## Correlation", "", *_table(rows)]
    return "\n".join(parts) + "\n"


def parameter_rows(fit: Fit) -> list[list[str]]:
    """The values as a table, its head first."""
    head = ["fitted", "start", "value", "deviation"]
    rows = [head + (["at dt / 2"] if len(fit.finer) else [])]
    for k, knob in enumerate(fit.knobs):
        unit = knob.setting.unit
        row = [
            knob.setting.path,
            with_unit(f"{knob.setting.value:.6g}", unit),
            with_unit(f"{fit.values[k]:.6g}", unit),
            _spread(fit, k, knob),
        ]
        rows.append(row + ([f"{fit.finer[k]:+.2f} deviations"] if len(fit.finer) else []))
    return rows


def _spread(fit: Fit, k: int, knob: Knob) -> str:
    size = _deviation(fit, k)
    relative = size / abs(float(fit.values[k])) if fit.values[k] else float("nan")
    return f"{with_unit(f'{size:.2g}', knob.setting.unit)} ({100.0 * relative:.2g} %)"


def _deviation(fit: Fit, k: int) -> float:
    """Standard deviation of a value."""
    scale = float(fit.values[k]) if fit.knobs[k].log else 1.0
    return float(fit.deviations[k]) * scale


def data_rows(fit: Fit) -> list[list[str]]:
    """How the samples are met, as a table, its head first."""
    rows = [["data", "samples", "rms left", "largest", "held out"]]
    for one in fit.tables:
        cells = [_told(one, x) for x in (one.fit, one.worst, one.held)]
        rows.append([one.curves.spec.file, str(one.samples), *cells])
    return rows


def part_rows(fit: Fit) -> list[list[str]]:
    """How each marker and probe is met, its head first; nothing below it where that is a long list."""
    rows = [["each", "mean left", "largest", "predicted, mean", "largest"]]
    parts = [(one, part) for one in fit.tables for part in one.parts]
    if len(parts) > _PARTS:
        return rows
    for one, part in parts:
        sizes = (part.mean, part.worst, part.held, part.worst_held)
        rows.append([part.name, *(_told(one, x) for x in sizes)])
    return rows


def _told(one: Table, x: float) -> str:
    """A size in the unit of its table, and in a picture in millimetres too; nothing for none."""
    if not isfinite(x):
        return ""
    cell = with_unit(f"{_shown(one, x):.4g}", one.curves.spec.unit)
    return f"{cell} ({1e3 * x / one.scale:.3g} mm)" if one.scale != 1.0 else cell


def _or_none(one: Table, x: float) -> Json:
    return to_json(_shown(one, x)) if isfinite(x) else None


def _shown(one: Table, x: float) -> float:
    """A size in the unit of its table."""
    return x / read_quantity(f"1 {one.curves.spec.unit}")[0]


def _columns(rows: list[list[str]]) -> list[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _table(rows: list[list[str]]) -> list[str]:
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return [lines[0], "|" + "---|" * len(rows[0]), *lines[1:]]
