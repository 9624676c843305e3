"""Drawing in other processes: a crash of the graphics library ends them, not the program."""

from __future__ import annotations

import itertools
import os
import queue
import subprocess
import tempfile
import threading
from collections.abc import Callable
from typing import IO

import numpy as np

from ..errors import RenderError
from . import child
from .job import Job
from .probe import RendererName, find_renderer

# Starting a process costs as much as drawing some dozens of frames.
_MANY_FRAMES = 200
# What draws unless it cannot; trying it out beforehand would cost as much as drawing some dozens of frames.
_PREFERRED: RendererName = "pyvista"

Progress = Callable[[int, int], None]
"""Called with the number of frames drawn and the number of all."""


def shares(count: int) -> list[slice]:
    """Consecutive parts of the frames, one for each process."""
    processes = 1 if count < _MANY_FRAMES else os.cpu_count() or 1
    bounds = np.linspace(0, count, processes + 1).round().astype(int).tolist()
    return [slice(low, high) for low, high in itertools.pairwise(bounds) if high > low]


def draw(jobs: Callable[[RendererName], list[Job]], progress: Progress | None) -> None:
    """Draw with the preferred renderer, or with the best one that works."""
    try:
        _draw_all(jobs(_PREFERRED), progress)
    except RenderError:
        working = find_renderer()
        if working == _PREFERRED:
            raise
        _draw_all(jobs(working), progress)


def _draw_all(jobs: list[Job], progress: Progress | None) -> None:
    """Run one process per job; stop them all when one fails."""
    lines: queue.Queue[tuple[int, str | None]] = queue.Queue()
    total = sum(len(job.frames) for job in jobs)
    done = 0
    with tempfile.TemporaryFile("w+") as errors:
        children = [_start(job, errors) for job in jobs]
        try:
            for number, process in enumerate(children):
                threading.Thread(target=_listen, args=(number, process, lines), daemon=True).start()
            running = len(children)
            while running:
                number, line = lines.get()
                if line is not None:
                    done += 1
                    if progress is not None:
                        progress(done, total)
                    continue
                running -= 1
                code = children[number].wait()
                if code != 0:
                    errors.seek(0)
                    last = errors.read().strip().splitlines()[-1:] or ["no message"]
                    raise RenderError(f"drawing ended with {child.describe_exit(code)}: {last[0]}")
        finally:
            for process in children:
                if process.poll() is None:
                    process.kill()
                    process.wait()


def _start(job: Job, errors: IO[str]) -> subprocess.Popen[str]:
    process = subprocess.Popen(
        child.command("worker"),
        env=child.environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=errors,
        text=True,
    )
    assert process.stdin is not None
    try:
        with process.stdin:
            process.stdin.write(job.to_json())
    except BrokenPipeError:
        # The process died before it read its job: its exit code tells more than the pipe.
        pass
    return process


def _listen(number: int, process: subprocess.Popen[str], lines: queue.Queue[tuple[int, str | None]]) -> None:
    assert process.stdout is not None
    with process.stdout:
        for line in process.stdout:
            lines.put((number, line))
    lines.put((number, None))
