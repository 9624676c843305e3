"""Points on the workers of a Dask scheduler (extra ``[cluster]``).

The scheduler gives out, and gives out again what a dead worker had; what a point is worth is ours: it runs
in a child of the worker, is published by rename into a shared folder, and few are in flight, since each
point that a dead worker had in its queue counts against it.
"""

from __future__ import annotations

import io
import re
import time
import uuid
import zipfile
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from ...control.plugin import load_plugins
from ...errors import OutputError, ScenarioError, UnfinishedError
from ...output.durable import write_bytes
from ...output.manifest import installed_versions
from ...output.run_directory import SCENARIO_FILE
from ...session.exit_codes import Exit
from ...session.inputs import gather_inputs
from ...session.narrator import Narrator
from . import dask_worker
from .pool import Answer, Executor
from .publish import begin, discard, is_done, publish
from .task import Task

_ADDRESS: Final = re.compile(r"dask://([^/\s]+:\d{1,5})/?")
_CONNECT: Final = "20s"
_POLL: Final = 0.02  # s
_COUNTED: Final = 1.0  # s between looks at how many workers there are
_APPEARS: Final = 10.0  # s within which a folder of another machine shows on this one


def executor_at(text: str, deterministic: bool, gather: bool) -> Callable[[Path, Narrator], Executor]:
    """What makes the executor of ``dask://HOST:PORT``.

    Raises:
        ScenarioError: It is no such address, or Dask is not installed.
    """
    match = _ADDRESS.fullmatch(text.strip())
    if match is None:
        raise ScenarioError(f"--executor {text!r}: expected dask://HOST:PORT")
    try:
        _distributed()
    except ImportError:
        raise ScenarioError(f"--executor {text}: needs Dask: pip install 'dismech[cluster]'") from None

    def make(folder: Path, narrator: Narrator) -> Executor:
        return DaskPool(f"tcp://{match[1]}", folder, narrator, deterministic=deterministic, gather=gather)

    return make


class DaskPool:
    """Workers of a scheduler.

    Args:
        address: Of the scheduler.
        folder: Of the sweep.
        narrator: Told what happens.
        deterministic: Whether MKL gives the same bits on every run.
        gather: Whether results come by network instead of a shared folder.

    Raises:
        ScenarioError: There is no scheduler, or a worker does not fit.
    """

    def __init__(
        self, address: str, folder: Path, narrator: Narrator, *, deterministic: bool, gather: bool
    ) -> None:
        self._narrator, self._deterministic, self._gather = narrator, deterministic, gather
        self._sweep = uuid.uuid4().hex
        self._token = folder.resolve() / f".token.{self._sweep}"
        self._attempts: Counter[str] = Counter()
        self._flying: dict[Any, Task] = {}
        self._workers: Mapping[str, int] = {}
        self._looked = float("-inf")
        try:
            self._client = _distributed().Client(address, timeout=_CONNECT, set_as_default=False)
        except (OSError, TimeoutError) as error:
            raise ScenarioError(f"no Dask scheduler answers at {address}: {error}") from None
        write_bytes(self._token, self._sweep.encode())
        try:
            self._check(address)
        except BaseException:
            self.close()
            raise

    @property
    def room(self) -> int:
        """Two tasks in flight for each worker of one thread: one that runs and one that waits."""
        now = time.monotonic()
        if now - self._looked > _COUNTED:
            self._looked = now
            before, self._workers = self._workers, self._client.nthreads()
            if before and not self._workers:
                self._narrator.warn(
                    "no worker is left: waiting for one; Ctrl-C ends the sweep, --resume goes on"
                )
        return max(0, sum(self._workers.values()) + len(self._workers) - len(self._flying))

    def warm(self, tasks: Sequence[Task], stopped: Callable[[], bool]) -> None:
        """Compile on one worker of each machine."""
        workers = self._client.scheduler_info(n_workers=-1)["workers"]
        first = {facts["host"]: address for address, facts in reversed(list(workers.items()))}
        futures = [
            self._client.submit(dask_worker.run, self._order(task, warm=True), workers=[address], pure=False)
            for address in first.values()
            for task in tasks
        ]
        # what goes wrong is told by the points themselves
        while not (stopped() or all(future.done() for future in futures)):
            time.sleep(_POLL)

    def submit(self, task: Task) -> None:
        """Send a task to the scheduler."""
        self._attempts[task.id] += 1
        key = f"dismech-{self._sweep[:8]}-{task.id}-{self._attempts[task.id]}"
        future = self._client.submit(dask_worker.run, self._order(task, warm=False), key=key, pure=False)
        self._flying[future] = task

    def answers(self, timeout: float) -> list[Answer]:
        """What has ended, within some time [s]."""
        end = time.monotonic() + timeout
        ended: list[Any] = []
        while not ended and time.monotonic() < end:
            time.sleep(_POLL)
            self._refuse_lost()
            ended = [future for future in self._flying if future.done()]
        return [self._answer(future, self._flying.pop(future)) for future in ended]

    def close(self) -> None:
        """End what runs, and leave."""
        with suppress(Exception):  # the scheduler may be gone
            if self._flying:
                self._client.cancel(list(self._flying))
                self._client.run(dask_worker.stop, self._sweep, on_error="ignore")
        with suppress(Exception):
            self._client.close(timeout=5)
        self._token.unlink(missing_ok=True)

    def _refuse_lost(self) -> None:
        """Points of a scheduler that is gone are not broken: they are to be run elsewhere.

        Raises:
            UnfinishedError: It is gone.
        """
        if self._client.status != "running":
            raise UnfinishedError("the Dask scheduler is gone: --resume goes on, here or on another")

    def _check(self, address: str) -> None:
        """Refuse workers of another version, and those that do not see the folder of the sweep.

        Raises:
            ScenarioError: naming one.
        """
        try:
            found = self._client.run(dask_worker.facts, self._token, self._sweep)
        except Exception as error:  # whatever a worker raises comes here as it is
            raise ScenarioError(f"the workers of {address} cannot run dismech: {error!r}") from None
        ours = dask_worker.facts(self._token, self._sweep)
        for worker, theirs in found.items():
            if (theirs["version"], theirs["schema"]) != (ours["version"], ours["schema"]):
                raise ScenarioError(
                    f"worker {worker} has another dismech, {theirs['version']}: here is {ours['version']}"
                )
            if not (theirs["shares"] or self._gather):
                raise ScenarioError(
                    f"worker {worker} does not see {self._token.parent}: share it, "
                    "or bring results by --gather"
                )
        if not found:
            self._narrator.warn(f"{address} has no workers yet: waiting for some")

    def _order(self, task: Task, *, warm: bool) -> dict[str, Any]:
        return {
            "task": task.as_json(),
            "warm": warm,
            "sweep": self._sweep,
            "deterministic": self._deterministic,
            "version": installed_versions()["dismech"],
            "token": str(self._token),
            "text": self._sweep,
            "files": _files(task) if self._gather else None,
        }

    def _answer(self, future: Any, task: Task) -> Answer:
        if future.status == "error":  # KilledWorker: those that had it died
            why = f"its worker died: {future.exception()}"
            return Answer(task, exit_code=Exit.BUG, fault=why, died=True)
        if future.status != "finished":
            self._refuse_lost()
            raise UnfinishedError(f"the Dask scheduler lost a point ({future.status}): --resume goes on")
        told = future.result()
        data = told.get("data")
        if data is not None:
            _unpack(task, data)
        elif not told["fault"] and not _appears(task):
            raise OutputError(f"a worker published {task.id}, which does not show in {task.points}")
        return Answer(
            task,
            exit_code=told["exit_code"],
            status=told["status"],
            fault=told["fault"] or "",
            died=told["died"],
            late=told["late"],
            log=told["log"],
        )


def _distributed() -> Any:
    """The library, which takes seconds to import.

    Raises:
        ImportError: It is not installed.
    """
    return import_module("distributed")


def _files(task: Task) -> dict[str, bytes]:
    """A scenario that stands on its own, first, and the files that it names.

    Raises:
        ScenarioError: It starts from another run, whose folder stays here.
    """
    inputs = gather_inputs(task.base.load(task.overrides), plugins=load_plugins(task.base.plugins))
    for original in inputs.files.values():
        if original.is_dir():
            raise ScenarioError(
                f"{original} is a folder: --gather takes no scenario that starts from another run"
            )
    files = {name: original.read_bytes() for name, original in inputs.files.items()}
    return {SCENARIO_FILE: inputs.text.encode(), **files}


def _unpack(task: Task, data: bytes) -> None:
    """Publish a point that came by network."""
    work = begin(task.points, task.id)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            archive.extractall(work.folder)
        publish(work)
    finally:
        discard(work)


def _appears(task: Task) -> bool:
    end = time.monotonic() + _APPEARS
    while not is_done(task.points, task.id):
        if time.monotonic() > end:
            return False
        time.sleep(0.1)
    return True
