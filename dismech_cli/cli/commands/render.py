"""``dismech render``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from .. import completion, options

SUMMARY = "Draw a run, finished or not: film, pictures, diagrams."
EXAMPLES = """
dismech render results/...                          what the scenario asks for, else a film
dismech render results/... --view xz --format gif
dismech render results/... --format png --color-by curvature --size 1920x1080
dismech render results/... --times '0, 0.5 s, 1 s' --set layout=panels
dismech render results/... --ground floor --camera '{from: [1, -2, 1], to: [0, 0, 0]}'
"""


class Format(StrEnum):
    """Kinds of pictures."""

    MP4 = "mp4"
    GIF = "gif"
    PNG = "png"


def _text(name: str, help: str, metavar: str | None = None):  # type: ignore[no-untyped-def]
    return typer.Option(name, metavar=metavar, help=help, show_default=False)


def render(
    run_dir: options.RunDir,
    view: Annotated[str | None, _text("--view", "xy, xz, yz or iso.", "VIEW")] = None,
    color_by: Annotated[
        str | None,
        typer.Option(
            "--color-by",
            metavar="FIELD",
            help="Field shown as colour, stored or not; or none.",
            show_default=False,
            autocompletion=completion.fields,
        ),
    ] = None,
    fps: Annotated[str | None, _text("--fps", "Pictures per second of a film.", "N")] = None,
    speed: Annotated[
        str | None, _text("--speed", "Time of the run over time of the film; 1 is real time.", "X")
    ] = None,
    size: Annotated[str | None, _text("--size", "Such as 1280x720.", "WIDTHxHEIGHT")] = None,
    format: Annotated[
        Format | None, typer.Option("--format", help="Only this: a film, or stills.", show_default=False)
    ] = None,
    times: Annotated[str | None, _text("--times", "Times of stills, such as '0, 0.5 s'.", "T,T,...")] = None,
    camera: Annotated[
        str | None, _text("--camera", "fixed, tracking, or a mapping as in the scenario.", "CAMERA")
    ] = None,
    ground: Annotated[str | None, _text("--ground", "none, grid or floor.", "GROUND")] = None,
    background: Annotated[
        str | None, _text("--background", "white, grey, dark or transparent.", "COLOR")
    ] = None,
    set_: Annotated[
        list[str] | None, _text("--set", "Any other key of output.render; repeatable.", "KEY=VALUE")
    ] = None,
    output: Annotated[Path | None, _text("-o", "Needs --format or --times.", "FILE")] = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Entry point of the command."""
    if output is not None and format is None and times is None:
        raise typer.BadParameter("needs --format or --times", param_hint="-o")
    if times is not None and format not in (None, Format.PNG):
        raise typer.BadParameter("--times are of stills: choose --format png", param_hint="--times")
    from ...output.jsonable import dumps
    from ...session.drawing import Wishes, draw
    from ..console import Console, emit

    given = {
        "view": view,
        "fps": fps,
        "speed": speed,
        "size": None if size is None else str(list(options.size(size))),
        "times": None if times is None else f"[{times}]",
        "camera": camera,
        "ground": ground,
        "background": background,
    }
    wishes = Wishes(
        changes=(*(f"{key}={value}" for key, value in given.items() if value is not None), *(set_ or ())),
        color_by=color_by,
        format="png" if format is None and times is not None else None if format is None else format.value,
        output=output,
    )
    files = [str(file) for file in draw(run_dir, wishes, Console(options.level(quiet, False)))]
    emit(dumps({"files": files}, indent=2) if json else "\n".join(files))
    return 0
