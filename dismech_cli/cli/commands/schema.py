"""``dismech schema``."""

from __future__ import annotations

from typing import Annotated

import typer

SUMMARY = "Print the JSON Schema of the scenario language, for editors, its reference, or that of --json."
EXAMPLES = """
dismech schema > dismech.schema.json
dismech schema --markdown > scenario.md
dismech schema --results
"""


def schema(
    markdown: Annotated[bool, typer.Option("--markdown", help="The reference as Markdown.")] = False,
    results: Annotated[
        bool, typer.Option("--results", help="Schemas of what commands print with --json.")
    ] = False,
) -> int:
    """Entry point of the command."""
    if markdown and results:
        raise typer.BadParameter("does not go with --markdown", param_hint="--results")
    import json

    from ...scenario.views.editor import editor_schema
    from ...scenario.views.reference import markdown_reference
    from ..console import emit
    from ..result_schema import result_schema

    if markdown:
        emit(markdown_reference())
    else:
        emit(json.dumps(result_schema() if results else editor_schema(), indent=1))
    return 0
