"""``dismech render``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from .. import completion, options

SUMMARY = "Draw a run: video, pictures, diagrams."
EXAMPLES = """
dismech render results/...                          what the scenario asks for, else a video
dismech render results/... --view xz --format gif
dismech render results/... --format png --color-by curvature --size 1920x1080
"""


class View(StrEnum):
    """Where the camera looks from."""

    XY = "xy"
    XZ = "xz"
    YZ = "yz"
    ISO = "iso"


class Format(StrEnum):
    """Kinds of pictures."""

    MP4 = "mp4"
    GIF = "gif"
    PNG = "png"


class Camera(StrEnum):
    """What the camera does."""

    FIXED = "fixed"
    TRACKING = "tracking"


def render(
    run_dir: options.RunDir,
    view: Annotated[View | None, typer.Option("--view", help="Where the camera looks from.")] = None,
    color_by: Annotated[
        str | None,
        typer.Option(
            "--color-by",
            metavar="FIELD",
            help="Field shown as colour, or none.",
            autocompletion=completion.fields,
        ),
    ] = None,
    fps: Annotated[float | None, typer.Option("--fps", help="Frames per second of a video.")] = None,
    size: Annotated[
        str | None, typer.Option("--size", metavar="WIDTHxHEIGHT", help="Such as 1280x720.")
    ] = None,
    format: Annotated[
        Format | None, typer.Option("--format", help="Only this: a video, or a picture of the last frame.")
    ] = None,
    camera: Annotated[Camera | None, typer.Option("--camera", help="Whether it follows the robot.")] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Needs --format.")
    ] = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Entry point of the command."""
    if output is not None and format is None:
        raise typer.BadParameter("needs --format", param_hint="-o")
    from ...output.jsonable import dumps
    from ...session.drawing import Wishes, draw
    from ..console import Console, emit

    wishes = Wishes(
        view=None if view is None else view.value,
        color_by=color_by,
        fps=fps,
        size=None if size is None else options.size(size),
        format=None if format is None else format.value,
        camera=None if camera is None else camera.value,
        output=output,
    )
    files = [str(file) for file in draw(run_dir, wishes, Console(options.level(quiet, False)))]
    emit(dumps({"files": files}, indent=2) if json else "\n".join(files))
    return 0
