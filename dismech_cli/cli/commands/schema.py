"""``dismech schema``."""

from __future__ import annotations

from typing import Annotated

import typer

SUMMARY = "Print the JSON Schema of the scenario language, for editors, or its reference."
EXAMPLES = """
dismech schema > dismech.schema.json
dismech schema --markdown > scenario.md
"""


def schema(
    markdown: Annotated[bool, typer.Option("--markdown", help="The reference as Markdown.")] = False,
) -> int:
    """Entry point of the command."""
    import json

    from ...scenario.views.reference import json_schema, markdown_reference
    from ..console import emit

    emit(markdown_reference() if markdown else json.dumps(json_schema(), indent=2))
    return 0
