"""A sweep from its axes to its table, report and exit code; nothing runs before every point was read."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Final

from ...errors import ScenarioError
from ...frozen import frozen
from ...output.durable import output_errors, write_bytes
from ...output.jsonable import dumps
from ...output.manifest import installed_versions
from ...run.interrupt import StopRequest, stop_on_signals
from ...scenario.language.sweep import Sweep
from ...session.exit_codes import Exit
from ...session.narrator import Narrator
from ...session.start import RESULTS
from ..page import write_page
from . import table
from .points import Base, Point, points_of, shard
from .pool import Executor, LocalPool
from .publish import is_done, remove_dead, withdraw
from .sweep_page import sweep_page
from .task import Result, Task
from .work import Worker

POINTS_FOLDER: Final = "points"
SWEEP_FILE: Final = "sweep.json"
FAILURES_FILE: Final = "failed.jsonl"
CSV_FILE: Final = "table.csv"
HDF5_FILE: Final = "table.h5"
PAGE_FILE: Final = "report.html"

_WARMED: Final = 8  # points whose kernels are compiled before the others begin, at most
_DOUBTS: Final = 10


@frozen(kw_only=True)
class Request:
    """What to sweep, as given on the command line.

    Attributes:
        base: The scenario.
        axes: What is varied; None takes the section of the scenario.
        folder: Where results go; None takes ``results/sweeps/<name>``.
        shard: Which part of how many, counted from 1.
        jobs: Points run at a time; None takes the cores that this process may use.
        resume: Whether the folder may hold points already.
        retry: Whether those that did not end well are run again.
        limit: Wall time of a point [s], or None.
        light: Whether the result of a point alone is kept.
        run: Whether anything is run, or only table and report made anew.
        deterministic: Whether MKL gives the same bits on every run.
        executor: Makes what runs the points elsewhere; None runs them here.
    """

    base: Base
    axes: Sweep | None = None
    folder: Path | None = None
    shard: tuple[int, int] = (1, 1)
    jobs: int | None = None
    resume: bool = False
    retry: bool = False
    limit: float | None = None
    light: bool = False
    run: bool = True
    deterministic: bool = False
    executor: Callable[[Path, Narrator], Executor] | None = None


@frozen(kw_only=True)
class Swept:
    """A sweep as far as it came.

    Attributes:
        name: Of the scenario.
        folder: Where it lies.
        points: All its points, or those of its shard.
        results: Those that have ended, by name of the point.
        code: Exit code of the program.
        message: Empty if all is well.
    """

    name: str
    folder: Path
    points: tuple[Point, ...]
    results: Mapping[str, Result]
    code: int
    message: str

    @property
    def counts(self) -> dict[str, int]:
        """How many points are how far."""
        ended = list(self.results.values())
        missed = sum(one.exit_code == Exit.EXPECTATION for one in ended)
        return {
            "points": len(self.points),
            "done": sum(one.status == "done" for one in ended) - missed,
            "missed": missed,
            "failed": sum(one.status == "failed" for one in ended),
            "timeout": sum(one.status == "timeout" for one in ended),
            "broken": sum(one.status == "broken" for one in ended),
            "missing": len(self.points) - len(ended),
        }


def sweep(request: Request, narrator: Narrator) -> Swept:
    """Run the points of a sweep that have no result, and make its table and report.

    Raises:
        ScenarioError: The scenario, a point or the folder is wrong.
        OutputError: A result cannot be written.
        UnfinishedError: What ran the points elsewhere is gone.
    """
    whole = points_of(request.base, request.axes)
    mine = shard(whole, *request.shard)
    _tell_doubts(whole, narrator)
    name = request.base.load().scenario.name
    folder = request.folder or RESULTS / "sweeps" / name
    points = _opened(folder, request, whole, narrator)
    if removed := remove_dead(points):
        narrator.say(f"removed what {removed} killed processes left half done")
    with stop_on_signals() as stop:
        try:
            if request.run:
                _run(request, mine, folder, stop, narrator)
        finally:
            results = {one.id: Result.read(points / one.id) for one in whole if is_done(points, one.id)}
            _tabulate(folder, name, whole, results)
    _tell_light(request, results, narrator)
    own = {point.id: results[point.id] for point in mine if point.id in results}
    code, message = _ending(mine, own, stop)
    return Swept(name=name, folder=folder, points=mine, results=own, code=code, message=message)


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _tell_doubts(points: Sequence[Point], narrator: Narrator) -> None:
    doubts = list(dict.fromkeys(doubt for point in points for doubt in point.doubts))
    for doubt in doubts[:_DOUBTS]:
        narrator.warn(doubt)
    if len(doubts) > _DOUBTS:
        narrator.warn(f"... and {len(doubts) - _DOUBTS} more warnings about points")


def _tell_light(request: Request, results: Mapping[str, Result], narrator: Narrator) -> None:
    count = sum(result.light for result in results.values())
    if count and not request.light:
        narrator.warn(
            f"{count} points have a result alone, from an earlier --light: no frames to draw or compare"
        )


def _opened(folder: Path, request: Request, whole: Sequence[Point], narrator: Narrator) -> Path:
    """Make the folder of the sweep, or go on in it, and write down what is swept.

    Raises:
        ScenarioError: It holds points and was not to be gone on with, or it holds something else.
        OutputError: It cannot be made.
    """
    points = folder / POINTS_FOLDER
    if folder.exists() and not folder.is_dir():
        raise ScenarioError(f"{folder} is no folder")
    if folder.is_dir() and any(folder.iterdir()) and not points.is_dir():
        raise ScenarioError(f"{folder} holds something that is no sweep; choose another folder with -o")
    with output_errors(points, "create"):
        points.mkdir(parents=True, exist_ok=True)
    here = {entry.name for entry in points.iterdir() if not entry.name.startswith(".")}
    if here and not request.resume:
        raise ScenarioError(
            f"{folder} holds {len(here)} points already: --resume goes on with them, -o names another folder"
        )
    if strange := here - {point.id for point in whole}:
        narrator.warn(
            f"{len(strange)} points in {folder} belong to other values or an older scenario: not in the table"
        )
    described = {
        "scenario": str(request.base.path),
        "profile": request.base.profile,
        "overrides": request.base.overrides,
        "versions": installed_versions(),
        "points": [{"id": point.id, "settings": dict(_texts(point))} for point in whole],
    }
    write_bytes(folder / SWEEP_FILE, (dumps(described, indent=1) + "\n").encode())
    return points


def _texts(point: Point) -> list[tuple[str, str]]:
    return [(one.key, one.text) for one in point.settings]


def _run(
    request: Request, mine: Sequence[Point], folder: Path, stop: StopRequest, narrator: Narrator
) -> None:
    points = folder / POINTS_FOLDER
    if request.retry:
        _withdraw_failed(points, mine, narrator)
    todo = [point for point in mine if not is_done(points, point.id)]
    if len(todo) < len(mine):
        narrator.say(f"{len(mine) - len(todo)} of {len(mine)} points have a result already")
    if not todo:
        return
    tasks = [Task.of(point, request.base, points.resolve(), request.limit, request.light) for point in todo]
    make = request.executor or _local(request, len(tasks))
    with closing(make(folder, narrator)) as executor:
        executor.warm(_unlike(todo, tasks), lambda: stop.requested)
        Worker(points, folder / FAILURES_FILE, narrator).work(tasks, executor, stop)
    remove_dead(points)  # of children that were ended


def _local(request: Request, count: int) -> Callable[[Path, Narrator], Executor]:
    slots = min(request.jobs or usable_cores(), count)

    def make(folder: Path, narrator: Narrator) -> Executor:
        narrator.say(f"{count} points, {slots} at a time, in {folder}")
        return LocalPool(slots, request.deterministic)

    return make


def _unlike(points: Sequence[Point], tasks: Sequence[Task]) -> list[Task]:
    """A point for each combination of what is no number: others of its kind need the same kernels."""
    found: dict[tuple[str, ...], Task] = {}
    for point, task in zip(points, tasks, strict=True):
        kind = tuple(one.text for one in point.settings if isinstance(one.value, str))
        found.setdefault(kind, task)
    return list(found.values())[:_WARMED]


def _withdraw_failed(points: Path, mine: Sequence[Point], narrator: Narrator) -> None:
    failed = [
        point.id for point in mine if is_done(points, point.id) and Result.read(points / point.id).exit_code
    ]
    for id in failed:
        withdraw(points, id)
    if failed:
        narrator.say(f"{len(failed)} points that did not end well are run again")


def _tabulate(folder: Path, name: str, whole: Sequence[Point], results: Mapping[str, Result]) -> None:
    """Make table and report anew."""
    ended = [results[point.id] for point in whole if point.id in results]
    made = table.columns(ended)
    table.write_csv(folder / CSV_FILE, made)
    table.write_hdf5(folder / HDF5_FILE, made)
    write_page(folder / PAGE_FILE, sweep_page(name, len(whole), ended, made))


def _ending(mine: Sequence[Point], own: Mapping[str, Result], stop: StopRequest) -> tuple[int, str]:
    """The largest class of all points; a sweep that is not whole is interrupted, whatever they say."""
    missing = len(mine) - len(own)
    if stop.requested:
        return stop.exit_code, f"stopped with {missing} of {len(mine)} points to do: --resume goes on"
    if missing:
        return Exit.INTERRUPTED, f"{missing} of {len(mine)} points have no result: --resume runs them"
    worst = max((result.exit_code for result in own.values()), default=Exit.DONE)
    count = sum(result.exit_code != Exit.DONE for result in own.values())
    return worst, f"{count} of {len(mine)} points did not end well" if count else ""
