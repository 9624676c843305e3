"""Drawing in other processes: a crash of the graphics library ends them, not the program."""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import IO

import numpy as np

from ..errors import RenderError
from . import child
from .job import Job
from .pipes import widen
from .probe import RendererName, find_renderer
from .settings import Image

# Starting a process costs as much as drawing some dozens of frames.
_WORTH = 30
# What draws unless it cannot; trying it out beforehand would cost as much as drawing some dozens of frames.
_PREFERRED: RendererName = "pyvista"
# A process that is ahead of the others may go on by this many pictures.
_AHEAD = 6

Plain = Callable[[], None]
"""Called when the plain renderer takes over."""


def draw(job: Job, plain: Plain) -> Iterator[Image]:
    """Yield the pictures of a job in order, by the preferred renderer, or by the best one that works.

    Args:
        job: What to draw; its renderer is chosen here.
        plain: Called when the plain renderer takes over.

    Raises:
        RenderError: If a drawing process fails, or this machine cannot draw.
    """
    begun = False
    try:
        for image in _draw_all(replace(job, renderer=_PREFERRED)):
            begun = True
            yield image
    except RenderError:
        working = find_renderer()
        if begun or working == _PREFERRED:
            raise
        plain()
        yield from _draw_all(replace(job, renderer=working))


def processes_for(count: int) -> int:
    """How many draw a number of pictures: one for each core, none for less than its start is worth."""
    return max(1, min(_cores(), count // _WORTH))


def _cores() -> int:
    """Cores that this process may use, which may be fewer than there are."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _draw_all(job: Job) -> Iterator[Image]:
    """Deal the shots to processes in turn, and collect them in the same order."""
    count = processes_for(len(job.shots))
    width, height = job.settings.size
    shape = (height, width, job.channels)
    with tempfile.TemporaryFile("w+") as errors:
        workers = [_Worker(job.share(slice(k, None, count)), shape, errors, count) for k in range(count)]
        try:
            for number in range(len(job.shots)):
                worker = workers[number % count]
                image = worker.take()
                if image is None:
                    errors.seek(0)
                    last = errors.read().strip().splitlines()[-1:] or ["no message"]
                    raise RenderError(f"drawing ended with {worker.exit}: {last[0]}")
                yield image
        finally:
            for worker in workers:
                worker.stop()


class _Worker:
    """A process that draws some of the pictures, and a thread that takes them from it."""

    def __init__(self, job: Job, shape: tuple[int, int, int], errors: IO[str], processes: int) -> None:
        self._shape = shape
        self._images: queue.Queue[Image | None] = queue.Queue(_AHEAD)
        self._stopped = False
        self._process = subprocess.Popen(
            child.command("worker"),
            env=child.environment() if processes == 1 else child.environment(LP_NUM_THREADS="0"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        widen(self._process.stdout)
        try:
            with self._process.stdin:
                self._process.stdin.write(job.to_json().encode())
        except BrokenPipeError:
            # The process died before it read its job: its exit code tells more than the pipe.
            pass
        threading.Thread(target=self._listen, daemon=True).start()

    def take(self) -> Image | None:
        """The next picture; None if there is none because the process ended."""
        return self._images.get()

    @property
    def exit(self) -> str:
        """How the process ended."""
        return child.describe_exit(self._process.wait())

    def stop(self) -> None:
        """End the process if it has not ended."""
        self._stopped = True
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        while not self._images.empty():
            self._images.get()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        size = int(np.prod(self._shape))
        with self._process.stdout as pictures:
            while not self._stopped:
                data = pictures.read(size)
                if len(data) < size:
                    break
                self._images.put(np.frombuffer(data, dtype=np.uint8).reshape(self._shape))
        self._images.put(None)
