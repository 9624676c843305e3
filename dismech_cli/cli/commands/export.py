"""``dismech export``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from .. import options

SUMMARY = "Write the frames of a run in another format."
EXAMPLES = """
dismech export results/... --to vtu
dismech export results/... --to npz -o frames
dismech export results/... --to glb              one moving body for Blender, slides, web pages
"""


class Target(StrEnum):
    """Formats."""

    VTU = "vtu"
    CSV = "csv"
    NPZ = "npz"
    OBJ = "obj"
    GLB = "glb"


def export(
    run_dir: options.RunDir,
    to: Annotated[Target, typer.Option("--to", help="The format.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Default: RUN_DIR/export-FORMAT.", show_default=False
        ),
    ] = None,
    json: options.Json = False,
) -> int:
    """Entry point of the command."""
    from ...output.jsonable import dumps
    from ...session.exporting import export as write
    from ..console import NORMAL, Console, emit

    files = [str(file) for file in write(run_dir, to.value, output, Console(NORMAL))]
    emit(dumps({"files": files}, indent=2) if json else "\n".join(files))
    return 0
