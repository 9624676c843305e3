"""Films and stills of a run, drawn in other processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import field
from pathlib import Path

import numpy as np

from ..arrays import FloatArray
from ..errors import RenderError, ScenarioError
from ..frozen import frozen
from ..output.durable import output_errors
from ..output.read import read
from ..output.run_directory import RENDER_FOLDER
from .coloring import Field, stored_field
from .drawing import draw, processes_for
from .encode import Take, gif_file, gif_rate, mp4_file, require_encoder, write_png
from .framing import frame_motion
from .job import Job
from .panels import side_by_side
from .scales import make_scale
from .settings import Format, Image, Layout, Settings
from .timeline import Film, Shot, film, stills

Progress = Callable[[int, int], None]
"""Called with the number of pictures drawn and the number of all."""

_PLAIN = "OpenGL does not work here: the plain renderer draws, without shadows and occlusion"


@frozen(kw_only=True)
class Wanted:
    """Files that are asked for.

    Attributes:
        formats: Kinds of files, each once.
        fps: Pictures per second of a film.
        speed: Time of the run over time of the film; None is real time where that makes a film to look at.
        times: Of stills, the nearest frames [s]; none is the last frame.
        layout: Whether stills stand in files of their own or side by side in one.
        output: The file, or a folder for several stills, of one format; None is inside ``<run_dir>/render``.
    """

    formats: tuple[Format, ...] = ("mp4",)
    fps: float = 25.0
    speed: float | None = None
    times: tuple[float, ...] = ()
    layout: Layout = "separate"
    output: Path | None = None


@frozen
class Drawn:
    """What came of it.

    Attributes:
        files: Made, in the order of the formats.
        notes: What the user should know about them.
    """

    files: list[Path] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def render(
    run_dir: Path,
    settings: Settings,
    wanted: Wanted,
    *,
    field: Field | None = None,
    progress: Progress | None = None,
) -> Drawn:
    """Make films and stills of a run, finished or not; each picture is drawn once.

    Args:
        run_dir: The run directory.
        settings: What the pictures show.
        wanted: Which files.
        field: The field that colours the bodies, if the run does not have it.
        progress: Called after each picture.

    Raises:
        ScenarioError: If the choices do not go together, or the run does not have the field.
        OutputError: If the run cannot be read or a file cannot be written.
        RenderError: If this machine cannot draw or encode.
    """
    _check(settings, wanted)
    with read(run_dir) as run:
        if not len(run):
            raise RenderError(f"{run_dir} has no frames to draw")
        times = run.t
        if settings.color_by is not None and field is None:
            field = stored_field(run, settings.color_by)
        films: dict[Format, Film] = {
            format: film(times, rate_of(format, wanted.fps), wanted.speed)
            for format in wanted.formats
            if format != "png"
        }
        shots = {format: list(movie.shots) for format, movie in films.items()}
        if "png" in wanted.formats:
            shots["png"] = stills(times, wanted.times)
        order = sorted({*(shot for part in shots.values() for shot in part)}, key=lambda shot: shot.t)
        job = Job(
            run_dir=run_dir.resolve(),
            renderer="",
            settings=settings,
            framing=frame_motion(run, settings, order),
            field=field,
            scale=None
            if field is None
            else make_scale(field.spec, field.values(run), settings.limits, settings.colormap),
            shots=tuple(order),
            decimals=time_decimals(np.array([shot.t for shot in order]) if films else times),
        )
    drawn = Drawn(notes=list(dict.fromkeys(note for movie in films.values() for note in movie.notes)))
    with ExitStack() as open_files:
        takes: list[tuple[set[Shot], Take]] = []
        for format in wanted.formats:
            part = shots[format]
            files = _output_files(run_dir, wanted, settings, format, part)
            with output_errors(files[0].parent, "create"):
                files[0].parent.mkdir(parents=True, exist_ok=True)
            takes.append((set(part), open_files.enter_context(_opened(format, files, job, wanted))))
            drawn.files.extend(files)
        images = draw(job, lambda: drawn.notes.append(_PLAIN))
        for number, (shot, image) in enumerate(zip(order, images, strict=True), start=1):
            for mine, take in takes:
                if shot in mine:
                    take(image)
            if progress is not None:
                progress(number, len(order))
    return drawn


def rate_of(format: Format, fps: float) -> float:
    """Pictures per second of a film in this format."""
    return gif_rate(fps) if format == "gif" else fps


def _check(settings: Settings, wanted: Wanted) -> None:
    """Refuse what cannot be, before anything is drawn."""
    if wanted.output is not None and len(wanted.formats) != 1:
        raise ScenarioError("a file for the output takes one format")
    if settings.background == "transparent" and set(wanted.formats) - {"png"}:
        raise ScenarioError("films cannot be transparent: choose --format png, or another background")
    if "mp4" in wanted.formats:
        require_encoder()


def _opened(format: Format, files: list[Path], job: Job, wanted: Wanted) -> AbstractContextManager[Take]:
    match format:
        case "mp4":
            # as many threads encode as processes draw
            threads = processes_for(len(job.shots))
            return mp4_file(files[0], job.settings.size, wanted.fps, threads)
        case "gif":
            return gif_file(files[0], job.settings.size, gif_rate(wanted.fps))
        case "png":
            return _stills(files, wanted.layout)


@contextmanager
def _stills(files: list[Path], layout: Layout) -> Iterator[Take]:
    """Collect stills, and write them one by one or in one file."""
    taken: list[Image] = []
    yield taken.append
    pictures = [side_by_side(taken)] if layout == "panels" else taken
    for picture, file in zip(pictures, files, strict=True):
        write_png(picture, file)


def _output_files(
    run_dir: Path, wanted: Wanted, settings: Settings, format: Format, shots: Sequence[Shot]
) -> list[Path]:
    view, output = settings.camera.view, wanted.output
    stem = view if settings.color_by is None else f"{view}-{settings.color_by}"
    if format != "png":
        return [run_dir / RENDER_FOLDER / f"{stem}.{format}" if output is None else output]
    one = len(shots) == 1 or wanted.layout == "panels"
    if output is not None and one and output.suffix.lower() == ".png":
        return [output]
    folder = run_dir / RENDER_FOLDER if output is None else output
    if wanted.layout == "panels":
        return [folder / f"{stem}-panels.png"]
    return [folder / f"{stem}-{shot.lower:06d}.png" for shot in shots]


def time_decimals(times: FloatArray) -> int:
    """Digits after the point that tell neighbouring times apart, at most six."""
    if len(times) < 2:
        return 3
    step = float(np.median(np.diff(times)))
    return int(np.clip(np.ceil(-np.log10(step) - 1e-6), 1, 6)) if step > 0 else 3
