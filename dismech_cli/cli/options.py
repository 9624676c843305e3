"""Options that several commands share, and the small texts they parse."""

from __future__ import annotations

import os
import re
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from . import completion
from .console import NORMAL, QUIET, VERBOSE, Console
from .progress import make_display

_SECONDS = {"ms": 1e-3, "s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
_DURATION = re.compile(r"(?P<number>\d+(\.\d*)?|\.\d+)\s*(?P<unit>[a-z]*)")
_SIZE = re.compile(r"(\d{1,5})\s*[xX×]\s*(\d{1,5})")


def duration(text: str | float) -> float:
    """Wall time [s] of ``60s``, ``10m``, ``1.5h`` or a bare number of seconds."""
    if isinstance(text, float):
        return text
    match = _DURATION.fullmatch(text.strip())
    if match is None or (match["unit"] or "s") not in _SECONDS:
        raise typer.BadParameter(f"expected a time such as 60s, 10m or 2h, got {text!r}")
    seconds = float(match["number"]) * _SECONDS[match["unit"] or "s"]
    if seconds <= 0.0:
        raise typer.BadParameter(f"expected a time above zero, got {text!r}")
    return seconds


def folder(text: str | Path) -> Path:
    """A folder; no text is none, not the folder one is in."""
    if not str(text).strip():
        raise typer.BadParameter("expected the name of a folder, got nothing")
    return Path(text)


def size(text: str) -> tuple[int, int]:
    """Width and height of ``1280x720``."""
    match = _SIZE.fullmatch(text.strip())
    if match is None:
        raise typer.BadParameter(f"expected WIDTHxHEIGHT such as 1280x720, got {text!r}", param_hint="--size")
    return int(match[1]), int(match[2])


class Profile(StrEnum):
    """Built-in trades of speed against accuracy."""

    DRAFT = "draft"
    NORMAL = "normal"
    ACCURATE = "accurate"


class Shown(StrEnum):
    """How progress is shown."""

    AUTO = "auto"
    BAR = "bar"
    LINES = "lines"
    NONE = "none"


Scenario = Annotated[Path, typer.Argument(metavar="SCENARIO", help="YAML or TOML file.", show_default=False)]
RunDir = Annotated[
    Path,
    typer.Argument(
        metavar="RUN_DIR",
        help="results/<name>/<run-id>.",
        exists=True,
        file_okay=False,
        show_default=False,
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Set a value, as in numerics.dt='5 ms'; repeatable.",
        autocompletion=completion.set_keys,
    ),
]
ProfileOption = Annotated[
    Profile | None, typer.Option("--profile", help="Trade speed for accuracy.", show_default=False)
]
Plugin = Annotated[
    list[Path] | None,
    typer.Option(
        "--plugin",
        metavar="FILE.py",
        help="Controllers in Python, which run as a program; repeatable.",
        show_default=False,
    ),
]
AllowOutside = Annotated[
    bool, typer.Option("--allow-outside", help="Permit files outside the folder of the scenario.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Until = Annotated[
    str | None,
    typer.Option("--until", metavar="T", help="Stop at this simulated time, such as '0.5 s'; resumable."),
]
CheckpointEvery = Annotated[
    float,
    typer.Option(
        "--checkpoint-every",
        metavar="TIME",
        parser=duration,
        help="Wall time between checkpoints.",
        show_default="60s",
    ),
]
WallLimit = Annotated[
    float | None,
    typer.Option(
        "--wall-limit",
        metavar="TIME",
        parser=duration,
        help="Stop with a checkpoint after this wall time, such as 10m.",
        show_default=False,
    ),
]
NoRender = Annotated[
    bool, typer.Option("--no-render", help="Draw no pictures, whatever the scenario asks for.")
]
JUnit = Annotated[
    Path | None,
    typer.Option("--junit", metavar="FILE", help="Write the result as JUnit XML.", show_default=False),
]
Progress = Annotated[Shown, typer.Option("--progress", help="How progress is shown.")]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="Only warnings, errors and the run directory.")]
Verbose = Annotated[bool, typer.Option("-v", "--verbose", help="The plan with its reasons, and every event.")]


def level(quiet: bool, verbose: bool) -> int:
    """How much to say; being quiet wins."""
    return QUIET if quiet else VERBOSE if verbose else NORMAL


def narrator(progress: Shown, quiet: bool, verbose: bool) -> Console:
    """The terminal of a run."""
    return Console(level(quiet, verbose), make_display(progress.value, sys.stderr, os.environ.get("TERM")))
