"""A sweep on stdout, for people and for programs."""

from __future__ import annotations

from collections.abc import Mapping

from ..output.jsonable import Json, dumps
from ..scenario.language.sweep import Sweep
from ..session.exit_codes import Exit
from ..session.faults import fault
from ..studies.sweep.points import Base, Point, points_of, shard
from ..studies.sweep.sweep import CSV_FILE, HDF5_FILE, PAGE_FILE, Swept
from ..studies.sweep.task import Result
from .console import QUIET, Console, emit
from .tables import table

_LISTED = 20


def show(swept: Swept, json: bool, console: Console) -> int:
    """Print how a sweep ended.

    Returns:
        The exit code.
    """
    if swept.message:
        console.error(swept.message)
    if json:
        emit(dumps(_as_json(swept), indent=2))
        return swept.code
    if console.level > QUIET:
        emit(", ".join(f"{count} {name}" for name, count in swept.counts.items() if count))
        bad = [one for one in swept.results.values() if one.exit_code]
        rows = [(one.id, one.status, one.label, one.message.partition("\n")[0]) for one in bad[:_LISTED]]
        if rows:
            emit(table(("point", "", "sets", "message"), rows))
        if len(bad) > _LISTED:
            emit(f"... and {len(bad) - _LISTED} more in {swept.folder / CSV_FILE}")
        emit(f"report: {swept.folder / PAGE_FILE}")
    emit(str(swept.folder))
    return swept.code


def show_points(base: Base, axes: Sweep | None, part: tuple[int, int], json: bool) -> int:
    """Print the points of a sweep, all checked, none run.

    Raises:
        ScenarioError: Some cannot run.
    """
    points = shard(points_of(base, axes), *part)
    if json:
        emit(dumps([_point(point, None) for point in points], indent=2))
        return Exit.DONE
    emit(table(("point", "sets"), [(point.id, point.label) for point in points]))
    emit(f"{len(points)} points")
    return Exit.DONE


def _as_json(swept: Swept) -> dict[str, object]:
    return {
        "sweep_dir": str(swept.folder),
        "exit_code": swept.code,
        "message": swept.message,
        "errors": [fault(swept.message)] if swept.code else [],
        "counts": swept.counts,
        "points": [_point(point, swept.results.get(point.id)) for point in swept.points],
        "files": [str(swept.folder / name) for name in (CSV_FILE, HDF5_FILE, PAGE_FILE)],
    }


def _point(point: Point, result: Result | None) -> Mapping[str, Json]:
    settings = {one.key: {"text": one.text, "value": one.value, "unit": one.unit} for one in point.settings}
    if result is None:
        return {"id": point.id, "settings": settings, "result": None}
    return {
        "id": point.id,
        "settings": settings,
        "result": {
            "status": result.status,
            "exit_code": result.exit_code,
            "message": result.message,
            "expectations": result.expectations,
            "probes": result.probes,
            "counters": result.counters,
            "cpu": result.cpu,
            "wall": result.wall,
        },
    }
