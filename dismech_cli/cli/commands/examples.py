"""``dismech examples``."""

from __future__ import annotations

from .. import options

SUMMARY = "List the scenarios that come with the program."
EXAMPLES = """
dismech examples
dismech init helix
"""


def examples(json: options.Json = False) -> int:
    """Entry point of the command."""
    from ...output.jsonable import dumps
    from ...session.gallery import list_examples
    from ..console import emit
    from ..tables import table

    found = list_examples()
    if json:
        rows = [{"name": e.name, "path": str(e.path), "description": e.description} for e in found]
        emit(dumps(rows, indent=2))
    else:
        emit(table((), [(e.name, e.description) for e in found]))
    return 0
