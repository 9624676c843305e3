"""The points of a sweep worked off: each once, by whoever comes first, the broken ones set aside."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from ...errors import OutputError
from ...output.durable import output_errors
from ...output.jsonable import dumps
from ...output.manifest import utc_now
from ...run.interrupt import StopRequest
from ...session.exit_codes import Exit
from ...session.narrator import Narrator
from .pool import Answer, Executor
from .publish import begin, discard, in_work, is_done, others_at, publish
from .task import Result, Status, Task

ATTEMPTS: Final = 2
"""How often a point may kill its process."""

_LOOK: Final = 0.2  # s between looks at what ended
_SAY: Final = 5.0  # s between lines of progress


@dataclass
class Worker:
    """Works off tasks.

    Attributes:
        points: Where results go.
        failures: The file that tells what did not end well.
        narrator: Told what happens.
    """

    points: Path
    failures: Path
    narrator: Narrator
    _attempts: Counter[str] = field(default_factory=Counter)
    _flying: dict[str, Task] = field(default_factory=dict)
    _done: int = 0
    _said: float = 0.0

    def work(self, tasks: Iterable[Task], executor: Executor, stop: StopRequest) -> None:
        """Run all tasks, until a signal comes.

        Raises:
            OutputError: A result cannot be written.
        """
        queue = deque(tasks)
        if others_at(self.points, frozenset()):
            queue.reverse()  # two sweeps in one folder meet in the middle
        total = len(queue)
        while (queue or self._flying) and not stop.requested:
            self._submit(queue, executor)
            if not self._flying and queue and executor.room:
                self._say(f"waiting for another sweep in this folder, which is at {len(queue)} points")
            for answer in executor.answers(_LOOK):
                self._flying.pop(answer.task.id, None)
                if self._settled(answer):
                    self._count(answer, total)
                else:
                    queue.append(answer.task)

    def _submit(self, queue: deque[Task], executor: Executor) -> None:
        """Give out what nobody has done or does; what others are at comes last, for they may fail."""
        if not queue or not executor.room:
            return
        others = others_at(self.points, frozenset(self._flying))
        for _ in range(len(queue)):
            if not executor.room:
                return
            task = queue.popleft()
            if is_done(self.points, task.id):
                self._done += 1
            elif task.id in others:
                queue.append(task)
            else:
                self._flying[task.id] = task
                executor.submit(task)

    def _settled(self, answer: Answer) -> bool:
        """Whether a point need not be tried again."""
        task = answer.task
        if not answer.fault:
            if answer.exit_code not in (Exit.DONE, Exit.EXPECTATION):
                self._note(task, Result.read(self.points / task.id).message, "")
            return True
        if answer.exit_code == Exit.OUTPUT:
            raise OutputError(answer.fault)
        self._attempts[task.id] += 1
        self._note(task, answer.fault, answer.log)
        if answer.late:
            self._set_aside(task, "timeout", Exit.SOLVER, answer.fault)
        elif self._attempts[task.id] >= ATTEMPTS:
            times = f" ({self._attempts[task.id]} attempts)"
            self._set_aside(task, "broken", Exit.BUG, f"{answer.fault}{times}\n{answer.log}".strip())
        else:
            _clear_up(self.points, task.id, None)
            return False
        return True

    def _set_aside(self, task: Task, status: Status, code: int, message: str) -> None:
        """Publish that a point has no result, with what its process left."""
        work = begin(self.points, task.id)
        _clear_up(self.points, task.id, None if task.light else work.folder)
        with output_errors(work.folder, "create"):
            work.folder.mkdir(exist_ok=True)
        Result(
            id=task.id,
            settings=task.settings,
            status=status,
            exit_code=int(code),
            message=message,
            probes={},
            units=task.units,
            counters={},
            cpu=0.0,
            wall=0.0,
            light=task.light,
        ).save(work.folder)
        publish(work)

    def _note(self, task: Task, reason: str, log: str) -> None:
        """Append what happened to the file of failures."""
        settings = {str(one["key"]): one["text"] for one in task.settings}
        entry: Mapping[str, object] = {
            "time": utc_now(),
            "id": task.id,
            "settings": settings,
            "attempt": self._attempts[task.id] or 1,
            "reason": reason,
            "log": log,
        }
        with output_errors(self.failures), self.failures.open("a", encoding="utf-8") as file:
            file.write(dumps(entry) + "\n")
        self.narrator.warn(f"{_label(task)}: {reason.partition(chr(10))[0]}")

    def _count(self, answer: Answer, total: int) -> None:
        self._done += 1
        self.narrator.detail(f"{answer.status}: {_label(answer.task)}")
        self._say(f"{self._done} of {total} points")

    def _say(self, text: str) -> None:
        """A line of progress, now and then."""
        now = time.monotonic()
        if now - self._said > _SAY:
            self._said = now
            self.narrator.say(text)


def _label(task: Task) -> str:
    return ", ".join(task.overrides) or task.id


def _clear_up(points: Path, id: str, keep_in: Path | None) -> None:
    """Remove what dead processes left of a point; the first of it goes to ``keep_in``, if that is given."""
    for work in in_work(points):
        owner = work.owner
        if work.id == id and owner is not None and owner.is_dead:
            if keep_in is not None and not keep_in.exists():
                with suppress(OSError):
                    work.folder.rename(keep_in)
            discard(work)
