"""Pictures of a run: what its scenario asks for, changed by wishes."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from ..errors import DismechError
from ..output.run_directory import LOG_FILE, SCENARIO_FILE
from ..render.movie import render as make
from ..render.plot import plot_scalars
from ..scenario.language.output import Render
from ..scenario.load import load
from .conduct import Record
from .log import Logged
from .narrator import Narrator


@dataclass(frozen=True, slots=True, kw_only=True)
class Wishes:
    """Choices of the user; None leaves that of the scenario.

    Attributes:
        view: ``xy``, ``xz``, ``yz`` or ``iso``.
        color_by: Field, or ``none``.
        fps: Frames per second.
        size: Width and height [pixel].
        format: Only this kind: ``mp4``, ``gif`` or ``png``.
        camera: ``fixed`` or ``tracking``.
        output: The file, with ``format`` only.
    """

    view: str | None = None
    color_by: str | None = None
    fps: float | None = None
    size: tuple[int, int] | None = None
    format: str | None = None
    camera: str | None = None
    output: Path | None = None


@dataclass(frozen=True, slots=True)
class Finished:
    """A run after all that was asked for.

    Attributes:
        record: The run as recorded.
        pictures: Files drawn.
    """

    record: Record
    pictures: tuple[Path, ...] = ()


def draw_asked(record: Record, asked: Render, narrator: Narrator) -> Finished:
    """Draw what the scenario of a run asks for; a failure is a warning, as the run itself is done.

    Args:
        record: The run.
        asked: What is asked for.
        narrator: Told what is drawn and how long it took; the log of the run is too.
    """
    parts = _parts(asked, record.manifest.counters.get("frames", 0))
    if record.manifest.status != "done" or not parts:
        return Finished(record)
    logged = Logged(narrator, record.run_dir / LOG_FILE)
    logged.say(f"rendering {', '.join(parts)}")
    tick = time.perf_counter()
    try:
        pictures = draw(record.run_dir, Wishes(), logged)
    except DismechError as error:
        logged.warn(f"no pictures: {error}\n  later: dismech render {record.run_dir}")
        return Finished(record)
    logged.say(f"rendered in {time.perf_counter() - tick:.3g} s")
    return Finished(record, tuple(pictures))


def _parts(asked: Render, frames: int) -> list[str]:
    """What will be drawn, in words; nothing if no picture is asked for."""
    parts = [f"a video of {frames} frames"] if asked.video != "none" else []
    parts += ["a still"] if asked.still else []
    parts += ["diagrams"] if asked.plots else []
    return parts


def draw(run_dir: Path, wishes: Wishes, narrator: Narrator) -> list[Path]:
    """Draw a run.

    Raises:
        ScenarioError: A choice does not exist.
        OutputError: The run cannot be read or a file cannot be written.
        RenderError: This machine cannot draw or encode.
    """
    asked = _asked(run_dir)
    color_by = _field(wishes.color_by or asked.color_by)
    files: list[Path] = []
    if formats := [wishes.format] if wishes.format else _formats(asked):
        files += make(
            run_dir,
            view=wishes.view or asked.view,
            color_by=color_by,
            fps=asked.fps if wishes.fps is None else wishes.fps,
            size=wishes.size or (asked.size[0], asked.size[1]),
            formats=formats,
            camera=wishes.camera or asked.camera,
            output=wishes.output,
            progress=narrator.drawn,
        )
    if asked.plots and wishes.format is None:
        files.append(plot_scalars(run_dir, asked.plots))
    return files


def _asked(run_dir: Path) -> Render:
    """What the scenario of the run asks for; a run without one asks for nothing."""
    file = run_dir / SCENARIO_FILE
    return load(file).scenario.output.render if file.is_file() else Render()


def _formats(asked: Render) -> list[str]:
    """Kinds of pictures that the scenario asks for, or a video if it asks for nothing at all."""
    kinds = ["png"] if asked.still else []
    kinds += [asked.video] if asked.video != "none" else []
    return kinds if kinds or asked.plots else ["mp4"]


def _field(color_by: str) -> str | None:
    """The field of a colour: a vector is shown by its length, so speed is that of the velocity."""
    return {"none": None, "speed": "velocity"}.get(color_by, color_by)
