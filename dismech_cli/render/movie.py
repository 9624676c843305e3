"""Videos and stills of a run, drawn in other processes."""

from __future__ import annotations

import itertools
import os
import queue
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, Literal

import numpy as np

from ..arrays import FloatArray
from ..errors import RenderError, ScenarioError
from ..output.durable import output_errors, staged
from ..output.read import read
from ..output.run_directory import RENDER_FOLDER
from . import child
from .coloring import make_scale
from .encode import require_encoder, write_gif, write_mp4
from .framing import frame_motion
from .job import Job
from .probe import RendererName, find_renderer
from .settings import Format, Settings, check_format, make_settings

# Starting a process costs as much as drawing some dozens of frames.
_MANY_FRAMES = 200
# What draws unless it cannot; trying it out beforehand would cost as much as drawing some dozens of frames.
_PREFERRED: RendererName = "pyvista"

Progress = Callable[[int, int], None]
"""Called with the number of frames drawn and the number of all."""

Times = Literal["first", "last"] | Sequence[float] | None


def render(
    run_dir: Path,
    *,
    view: str = "iso",
    color_by: str | None = None,
    fps: float | None = None,
    size: tuple[int, int] = (1280, 720),
    formats: Sequence[str] = ("mp4",),
    camera: str = "fixed",
    ground: str = "none",
    times: Times = None,
    output: Path | None = None,
    progress: Progress | None = None,
) -> list[Path]:
    """Make videos and stills of a run; each frame is drawn once.

    Args:
        run_dir: The run directory.
        view: ``xy``, ``xz``, ``yz`` or ``iso``.
        color_by: Field that colours the bodies; None gives each body a colour.
        fps: Frames per second of a video; None plays in real time, within 10 to 60.
        size: Width and height [pixel]; odd lengths are rounded up to even ones.
        formats: Any of ``mp4``, ``gif`` and ``png``.
        camera: ``fixed`` or ``tracking``.
        ground: ``none`` or ``grid``.
        times: Frames of stills: ``"first"``, ``"last"`` or times [s], the nearest frames; None means the
            last frame for stills and all frames for videos.
        output: The file, or a folder for several stills, of one format; default inside ``<run_dir>/render``.
        progress: Called after each frame.

    Returns:
        The files made.

    Raises:
        ScenarioError: If a choice does not exist.
        OutputError: If the run cannot be read or a file cannot be written.
        RenderError: If this machine cannot draw or encode.
    """
    chosen = [check_format(name) for name in formats]
    if output is not None and len(chosen) != 1:
        raise ScenarioError("a file for the output takes one format")
    settings = make_settings(view=view, color_by=color_by, size=size, camera=camera, ground=ground)
    if fps is not None and not 0.0 < fps <= 1000.0:
        raise ScenarioError(f"fps {fps:g}: expected a number above 0, up to 1000")
    if "mp4" in chosen:
        require_encoder()
    with read(run_dir) as run:
        if not len(run):
            raise RenderError(f"{run_dir} has no frames to draw")
        all_times = run.t
        selected = {format: select_frames(all_times, format, times) for format in chosen}
        framing = frame_motion(run, settings)
        scale = None if color_by is None else make_scale(run, color_by)
    speed = real_time_fps(all_times) if fps is None else fps
    made: list[Path] = []
    with tempfile.TemporaryDirectory(prefix="dismech-render-") as folder:
        pictures = {
            frame: Path(folder) / f"{frame:06d}.png"
            for frame in sorted({*itertools.chain(*selected.values())})
        }

        def jobs(renderer: RendererName) -> list[Job]:
            frames, files = tuple(pictures), tuple(pictures.values())
            return [
                Job(
                    run_dir=run_dir.resolve(),
                    renderer=renderer,
                    settings=settings,
                    framing=framing,
                    scale=scale,
                    frames=frames[part],
                    files=files[part],
                )
                for part in _shares(len(frames))
            ]

        _draw(jobs, progress)
        for format, frames in selected.items():
            files = _output_files(run_dir, output, settings, format, frames)
            with output_errors(files[0].parent, "create"):
                files[0].parent.mkdir(parents=True, exist_ok=True)
            _write(format, [pictures[frame] for frame in frames], files, speed)
            made += files
    return made


def _write(format: Format, pictures: list[Path], files: list[Path], fps: float) -> None:
    """Copy stills, encode a video."""
    if format == "png":
        for picture, file in zip(pictures, files, strict=True):
            with staged(file) as temporary:
                shutil.copyfile(picture, temporary)
    else:
        (write_mp4 if format == "mp4" else write_gif)(pictures, files[0], fps)


def select_frames(all_times: FloatArray, format: Format, times: Times) -> list[int]:
    """Frame numbers that the user asked for, in order and without repetition."""
    last = len(all_times) - 1
    if times is None:
        return [last] if format == "png" else list(range(last + 1))
    if isinstance(times, str):
        if times not in ("first", "last"):
            raise ScenarioError(f"no frames are called {times!r}; use 'first', 'last' or times in seconds")
        return [0] if times == "first" else [last]
    return sorted({int(np.abs(all_times - t).argmin()) for t in times})


def real_time_fps(all_times: FloatArray) -> float:
    """Frames per second at which the video runs as fast as the motion, within 10 and 60."""
    if len(all_times) < 2:
        return 30.0
    step = float(np.median(np.diff(all_times)))
    return float(np.clip(round(1.0 / step, 3), 10.0, 60.0)) if step > 0 else 30.0


def _output_files(
    run_dir: Path, output: Path | None, settings: Settings, format: Format, frames: list[int]
) -> list[Path]:
    stem = settings.view if settings.color_by is None else f"{settings.view}-{settings.color_by}"
    if format != "png":
        return [run_dir / RENDER_FOLDER / f"{stem}.{format}" if output is None else output]
    if output is not None and len(frames) == 1 and output.suffix.lower() == ".png":
        return [output]
    folder = run_dir / RENDER_FOLDER if output is None else output
    return [folder / f"{stem}-{frame:06d}.png" for frame in frames]


def _shares(count: int) -> list[slice]:
    """Consecutive parts of the frames, one for each process."""
    processes = 1 if count < _MANY_FRAMES else os.cpu_count() or 1
    bounds = np.linspace(0, count, processes + 1).round().astype(int).tolist()
    return [slice(low, high) for low, high in itertools.pairwise(bounds) if high > low]


def _draw(jobs: Callable[[RendererName], list[Job]], progress: Progress | None) -> None:
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
