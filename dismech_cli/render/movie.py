"""Videos and stills of a run, drawn in other processes."""

from __future__ import annotations

import itertools
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ..errors import RenderError, ScenarioError
from ..output.durable import output_errors, staged
from ..output.read import read
from ..output.run_directory import RENDER_FOLDER
from .coloring import make_scale
from .drawing import Progress, draw, shares
from .encode import require_encoder, write_gif, write_mp4
from .framing import frame_motion
from .job import Job
from .probe import RendererName
from .selection import Times, real_time_fps, select_frames
from .settings import Format, Settings, check_format, make_settings


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
                for part in shares(len(frames))
            ]

        draw(jobs, progress)
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
