"""Warm child processes on this machine, one per slot: started once, replaced when they die or hang."""

from __future__ import annotations

import json
import os
import selectors
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, Final, Protocol, Self

from ...errors import OutputError
from ...frozen import frozen
from ...output.jsonable import dumps
from ...output.threads import COUNTS, REPRODUCIBLE
from ...render.child import describe_exit
from .task import Task

# A run looks at the clock after each step; who does not come back some time after the limit hangs [s].
_GRACE: Final = 2.0
_COMPILES: Final = 300.0  # s that compiling may take beside that
_MOMENT: Final = 0.2  # s
_LOG_TAIL: Final = 20_000  # bytes looked at
_LOG_LINES: Final = 30
_MODULE: Final = f"{__package__}.child"


@frozen
class Answer:
    """What became of a task.

    Attributes:
        task: The task.
        exit_code: Of the point, if it was published.
        status: Of the point, if it was published.
        fault: Why nothing was published; empty if it was.
        died: Whether the process that ran it died.
        late: Whether it was ended because it hung.
        log: The last lines of the process that died.
    """

    task: Task
    exit_code: int = 0
    status: str = "done"
    fault: str = ""
    died: bool = False
    late: bool = False
    log: str = ""

    @classmethod
    def of(cls, task: Task, told: dict[str, Any]) -> Self:
        """The answer of a child that lives."""
        return cls(task, told["exit_code"], told.get("status", "failed"), told["fault"] or "")


class Executor(Protocol):
    """Runs tasks somewhere."""

    @property
    def room(self) -> int:
        """How many tasks it would take now."""

    def warm(self, tasks: Sequence[Task], stopped: Callable[[], bool]) -> None:
        """Compile what these need before anything runs, until ``stopped()``."""

    def submit(self, task: Task) -> None:
        """Take a task; only where there is room."""

    def answers(self, timeout: float) -> list[Answer]:
        """What has ended, within some time [s]; none if nothing has."""

    def close(self) -> None:
        """End at once; what is being run is thrown away."""


class Child:
    """One warm process.

    Args:
        deterministic: Whether MKL gives the same bits on every run.
    """

    def __init__(self, deterministic: bool) -> None:
        self._log: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115  lives as long as the child
        self._buffer = b""
        self.ready = False
        self.process = subprocess.Popen(
            # without the folder one is in, where a file may be called numpy.py
            [sys.executable, "-P", "-m", _MODULE, str(os.getpid())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            env=_environment(deterministic),
            # Ctrl-C is for the sweep, which ends its children
            start_new_session=True,
        )

    def ask(self, task: Task, *, warm: bool = False) -> None:
        """Give it a task; that it is dead shows when it does not answer."""
        assert self.process.stdin is not None
        with suppress(OSError):
            self.process.stdin.write((dumps({"task": task.as_json(), "warm": warm}) + "\n").encode())
            self.process.stdin.flush()

    @property
    def pipe(self) -> IO[bytes]:
        """Where its answers come from."""
        assert self.process.stdout is not None
        return self.process.stdout

    def read(self) -> list[dict[str, Any]] | None:
        """The lines that have come; None when there will be no more."""
        data = os.read(self.pipe.fileno(), 65536)
        if not data:
            return None
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        told = [json.loads(line) for line in lines]
        self.ready = self.ready or any("ready" in line for line in told)
        return told

    def end(self) -> str:
        """Kill it, if it still lives, and say how it ended."""
        with suppress(OSError):
            self.process.kill()
        code = self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            assert pipe is not None
            with suppress(OSError):
                pipe.close()
        return describe_exit(code)

    def last_lines(self) -> str:
        """The end of what it wrote to its log, without the long list of libraries after a crash."""
        size = self._log.seek(0, os.SEEK_END)
        self._log.seek(max(0, size - _LOG_TAIL))
        lines = self._log.read().decode("utf-8", "replace").splitlines()
        told = [line for line in lines if line.strip() and not line.startswith("Extension modules:")]
        return "\n".join(told[-_LOG_LINES:])

    def forget(self) -> None:
        """End it and throw its log away."""
        self.end()
        self._log.close()


@dataclass(slots=True)
class _Slot:
    """A place for a child.

    Attributes:
        child: The one that is there.
        task: What it runs, or None.
        deadline: When it must have answered.
    """

    child: Child
    task: Task | None = None
    deadline: float = field(default=float("inf"))

    @property
    def is_free(self) -> bool:
        """Whether it can be given a task."""
        return self.task is None and self.child.ready


class LocalPool:
    """Children on this machine.

    Args:
        slots: How many.
        deterministic: Whether MKL gives the same bits on every run.
    """

    def __init__(self, slots: int, deterministic: bool) -> None:
        self._deterministic = deterministic
        self._selector = selectors.DefaultSelector()
        self._slots: list[_Slot] = []
        for _ in range(slots):
            self._slots.append(_Slot(self._started()))

    @property
    def room(self) -> int:
        """How many children are ready and have nothing to do."""
        return sum(slot.is_free for slot in self._slots)

    def warm(self, tasks: Sequence[Task], stopped: Callable[[], bool]) -> None:
        """Compile by the first child, while the others import; if it dies or hangs, its points will tell."""
        slot = self._slots[0]
        for task in tasks:
            slot.child.ask(task, warm=True)
            deadline = (
                float("inf") if task.limit is None else time.monotonic() + _COMPILES + hard_limit(task.limit)
            )
            while not stopped():
                told = slot.child.read() if self._has_told(slot.child) else []
                if told is None or time.monotonic() > deadline:
                    self._replace(slot)
                    return
                if any("warm" in line for line in told):
                    break

    def submit(self, task: Task) -> None:
        """Give a task to a child that has nothing to do."""
        slot = next(slot for slot in self._slots if slot.is_free)
        slot.task = task
        slot.deadline = float("inf")
        if task.limit is not None:
            slot.deadline = time.monotonic() + hard_limit(task.limit)
        slot.child.ask(task)

    def answers(self, timeout: float) -> list[Answer]:
        """What has ended, within some time [s]; children that died or hang are replaced."""
        found: list[Answer] = []
        for key, _ in self._selector.select(timeout):
            slot = next(slot for slot in self._slots if slot.child is key.data)
            told = slot.child.read()
            if told is None:
                how = self._replace(slot)
                if slot.task is not None:
                    found.append(Answer(slot.task, fault=how[0], died=True, log=how[1]))
                slot.task = None
                continue
            for line in told:
                if "id" in line and slot.task is not None:
                    found.append(Answer.of(slot.task, line))
                    slot.task = None
        now = time.monotonic()
        for slot in self._slots:
            if slot.task is not None and now > slot.deadline:
                _, log = self._replace(slot)
                found.append(Answer(slot.task, fault=over(slot.task), late=True, died=True, log=log))
                slot.task = None
        return found

    def close(self) -> None:
        """Kill all children."""
        for slot in self._slots:
            slot.child.forget()
        self._selector.close()

    def _has_told(self, child: Child) -> bool:
        """Whether a child says something, or has died, within a moment; others are looked at later."""
        with selectors.DefaultSelector() as selector:
            selector.register(child.pipe, selectors.EVENT_READ)
            return bool(selector.select(_MOMENT))

    def _started(self) -> Child:
        child = Child(self._deterministic)
        self._selector.register(child.pipe, selectors.EVENT_READ, child)
        return child

    def _replace(self, slot: _Slot) -> tuple[str, str]:
        """End a child and start another; how it ended, and its last lines.

        Raises:
            OutputError: It could not even start, and neither will another.
        """
        self._selector.unregister(slot.child.pipe)
        how = slot.child.end()
        log = slot.child.last_lines()
        slot.child.forget()
        if not slot.child.ready:
            raise OutputError(f"cannot start a process for points: it ended by {how}\n{log}")
        slot.child = self._started()
        return death(how), log


def death(how: str) -> str:
    """What to say of a child that died by itself; the system kills those for whom there is no memory."""
    return f"its process ended by {how}" + ("; was there enough memory?" if how.endswith("SIGKILL") else "")


def hard_limit(limit: float) -> float:
    """When a child that was to stop after ``limit`` is killed [s]."""
    return limit + max(_GRACE, 0.1 * limit)


def over(task: Task) -> str:
    """What to say of a point that had to be killed."""
    return f"did not come back within the limit of {task.limit:g} s: killed"


def _environment(deterministic: bool) -> dict[str, str]:
    """One thread for each child, said before its libraries load; this very package, installed or not."""
    root = str(Path(__file__).resolve().parents[3])
    inherited = os.environ.get("PYTHONPATH")
    path = root if not inherited else os.pathsep.join([root, inherited])
    more = {REPRODUCIBLE: "AUTO"} if deterministic else {}
    return {**os.environ, **dict.fromkeys(COUNTS, "1"), "PYTHONPATH": path, **more}
