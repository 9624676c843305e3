"""Pictures of a run: what its scenario asks for, changed by the command line."""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from ..cli.console import QUIET
from ..output.run_directory import SCENARIO_FILE
from ..render.drawing import Progress
from ..render.movie import render as make
from ..render.plot import plot_scalars
from ..scenario.language.output import Render
from ..scenario.load import load


@dataclass(frozen=True, slots=True, kw_only=True)
class Wishes:
    """Choices of the command line; None leaves that of the scenario.

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


def draw(run_dir: Path, wishes: Wishes, level: int) -> list[Path]:
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
            progress=_progress(level),
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


def _progress(level: int) -> Progress | None:
    """A counter on a terminal, nothing elsewhere."""
    if level == QUIET or not sys.stderr.isatty() or os.environ.get("TERM") == "dumb":
        return None

    def show(done: int, total: int) -> None:
        with contextlib.suppress(OSError):
            end = "\r\x1b[K" if done == total else ""
            sys.stderr.write(f"\r\x1b[Kframe {done} of {total}{end}")
            sys.stderr.flush()

    return show
