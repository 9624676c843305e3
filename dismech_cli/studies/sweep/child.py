"""A warm process that runs points, one after the other: it imports once, and its death hurts nobody else.

It reads a line of JSON for each task and answers with one; whatever libraries print goes to the log.
"""

from __future__ import annotations

import faulthandler
import json
import os
import sys
import time
import traceback
from contextlib import suppress
from pathlib import Path
from typing import Final

from ...compose.structure.kernels import among_many
from ...control.plugin import load_plugins
from ...errors import DismechError, OutputError
from ...output.durable import output_errors
from ...output.jsonable import Json, dumps
from ...output.manifest import Manifest
from ...output.run_directory import LOG_FILE
from ...run.loop import Limits, run
from ...session.composing import composed
from ...session.exit_codes import Exit, code_of
from ...session.narrator import Silent
from ...session.pause import Pause
from ...session.sinks import Latest
from ...session.start import Start, start
from .publish import Work, begin, discard, publish
from .task import Result, Status, Task

_KILLED_WITH_PARENT: Final = 1  # PR_SET_PDEATHSIG
# Frames that nobody keeps are not written.
_LIGHT: Final = ("output.writers=[csv]",)


def main(parent: int) -> None:
    """Serve tasks until there are no more.

    Args:
        parent: Number of the process that started this one.
    """
    _die_with(parent)
    faulthandler.enable()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    print(json.dumps({"ready": True}), file=answers, flush=True)
    for line in sys.stdin:
        order = json.loads(line)
        task = Task.of_json(order["task"])
        print(dumps(_warmed(task) if order["warm"] else _ran(task)), file=answers, flush=True)


def _die_with(parent: int) -> None:
    """End when the process that started this one ends, however that happens."""
    if sys.platform == "linux":
        import ctypes
        import signal

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_KILLED_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:  # it has ended before it could be asked for
            os._exit(1)


def _warmed(task: Task) -> dict[str, Json]:
    """Compile what a point needs: its first step, of which nothing is kept."""
    with suppress(DismechError):  # told when the point is run
        loaded = task.base.load(task.overrides)
        plugins = load_plugins(task.base.plugins)
        simulation = composed(loaded, None, Silent(), plugins).simulation
        run(simulation, Latest(), limits=Limits(until=1e-300))
    return {"warm": True}


def _ran(task: Task) -> dict[str, Json]:
    """Run a point and publish its result."""
    try:
        work = begin(task.points, task.id)
    except OutputError as error:
        return _fault(task, error)
    try:
        result = _result(task, work)
        if result is None:
            return {"id": task.id, "fault": "interrupted", "exit_code": int(Exit.INTERRUPTED)}
        result.save(work.folder)
        publish(work)
    except OutputError as error:
        return _fault(task, error)
    finally:
        discard(work)
    return {"id": task.id, "fault": None, "exit_code": result.exit_code, "status": result.status}


def _fault(task: Task, error: OutputError) -> dict[str, Json]:
    return {"id": task.id, "fault": str(error), "exit_code": error.exit_code}


def _result(task: Task, work: Work) -> Result | None:
    """Run a point into its hidden folder; None if a signal stopped it.

    Raises:
        OutputError: The folder cannot be written to.
    """
    tick, cpu = time.perf_counter(), time.process_time()
    run_dir = work.hidden / "run" if task.light else work.folder
    overrides = (*task.base.overrides, *task.overrides)
    # what the record of the run shows as its command line
    sys.argv = [
        "dismech",
        "run",
        str(task.base.path),
        *(word for text in overrides for word in ("--set", text)),
        *(word for file in task.base.plugins for word in ("--plugin", str(file))),
    ]
    manifest: Manifest | None = None
    try:
        finished = start(
            Start(
                path=task.base.path,
                overrides=(*overrides, *(_LIGHT if task.light else ())),
                profile=task.base.profile,
                allow_outside=task.base.allow_outside,
                output=run_dir,
                overwrite=False,
                draw=False,
                pause=Pause(None, task.limit, 60.0),
                repays=among_many,
                plugins=task.base.plugins,
            ),
            Silent(),
        )
        manifest = finished.record.manifest
        code, message = int(finished.record.ending.code), manifest.message
    except Exception as error:  # of this point; what keeps its result from being written shows below
        code, message = code_of(error), str(error) or repr(error)
        if code == Exit.BUG:
            message = f"{error!r}\n{traceback.format_exc()}"
    wall = time.perf_counter() - tick
    late = code == Exit.INTERRUPTED and task.limit is not None and wall >= task.limit
    if code >= Exit.INTERRUPTED and not late:
        return None
    status: Status = "timeout" if late else "failed" if code not in (Exit.DONE, Exit.EXPECTATION) else "done"
    work.folder.mkdir(exist_ok=True)
    _name_place(run_dir / LOG_FILE, work.folder, task.points / task.id)
    return Result(
        id=task.id,
        settings=task.settings,
        status=status,
        exit_code=int(Exit.SOLVER) if late else code,
        message=message.replace(str(work.folder), str(task.points / task.id)),
        expectations=() if manifest is None else manifest.expectations,
        probes={} if manifest is None else manifest.probes,
        units=task.units,
        energy_error=None if manifest is None else manifest.energy_error,
        penetration=None if manifest is None else manifest.penetration.get("share"),
        counters={} if manifest is None else manifest.counters,
        cpu=time.process_time() - cpu,
        wall=wall,
        light=task.light,
    )


def _name_place(log: Path, hidden: Path, shown: Path) -> None:
    """Advice in a log names the folder in which the point will be found."""
    if log.is_file():
        with output_errors(log):
            log.write_text(log.read_text(encoding="utf-8").replace(str(hidden), str(shown)), encoding="utf-8")


if __name__ == "__main__":
    main(int(sys.argv[1]))
