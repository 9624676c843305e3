"""``dismech init``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .. import completion

SUMMARY = "Copy an example, with the files it names and the schema for editors, to start from."
EXAMPLES = """
dismech init
dismech init cantilever --output my_arm.yaml
"""


def init(
    template: Annotated[
        str,
        typer.Argument(
            metavar="[TEMPLATE]",
            help="Name of an example: dismech examples.",
            autocompletion=completion.templates,
        ),
    ] = "cantilever",
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE", help="The new file; default: its name here.", show_default=False
        ),
    ] = None,
) -> int:
    """Entry point of the command."""
    from ...session.copying import copy_example
    from ...session.gallery import find_example
    from ..console import Console, emit

    example = find_example(template)
    files = copy_example(example.path, output or Path(example.path.name))
    emit("\n".join(str(file) for file in files))
    Console().say(f"next: dismech check {files[0]} && dismech run {files[0]}")
    return 0
