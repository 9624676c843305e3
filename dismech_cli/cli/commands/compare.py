"""``dismech compare``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ...session.threads import use_threads
from .. import options

SUMMARY = (
    "Compare two runs, field by field: greatest and mean difference, where and when; exit 4 if too large."
)
EXAMPLES = """
dismech compare results/arm/before results/arm/after
dismech compare before after --tol 1e-6
dismech compare before after --tol 1e-6 --tol positions='1 um' --tol tip='1 %' --json
"""


def _run_dir(metavar: str) -> typer.models.ArgumentInfo:
    return typer.Argument(  # type: ignore[no-any-return]
        metavar=metavar, help="results/<name>/<run-id>.", exists=True, file_okay=False, show_default=False
    )


def compare(
    first: Annotated[Path, _run_dir("RUN_A")],
    second: Annotated[Path, _run_dir("RUN_B")],
    tolerance: Annotated[
        list[str] | None,
        typer.Option(
            "--tol",
            metavar="[NAME=]TOL",
            help="Greatest difference, of the size of the quantity or with a unit; default 0; repeatable.",
        ),
    ] = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Entry point of the command."""
    use_threads(None, False)
    from ...studies.compare.compare import compare as run
    from ..compare_result import show

    return show(run(first, second, tuple(tolerance or ())), json, quiet)
