"""``dismech report``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .. import options

SUMMARY = "Write one HTML page of a run: pictures, expectations, probes, energy, convergence, settings."
EXAMPLES = """
dismech report results/arm/20261122T101500Z-1a2b3c
dismech report out --video -o arm.html
dismech report out --no-pictures
"""


def report(
    run_dir: options.RunDir,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE", help="Default: report.html in RUN_DIR.", show_default=False
        ),
    ] = None,
    no_pictures: Annotated[bool, typer.Option("--no-pictures", help="Draw no stills.")] = False,
    video: Annotated[
        bool, typer.Option("--video", help="Draw a film into the page, which gets large.")
    ] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Entry point of the command."""
    from ...output.jsonable import dumps
    from ...studies.report import Wanted
    from ...studies.report import report as write
    from ..console import Console, emit

    wanted = Wanted(pictures=not no_pictures, video=video, output=output)
    file = write(run_dir, wanted, Console(options.level(quiet, False)))
    emit(dumps({"files": [str(file)]}, indent=2) if json else str(file))
    return 0
