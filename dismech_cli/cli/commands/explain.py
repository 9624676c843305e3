"""``dismech explain``."""

from __future__ import annotations

from typing import Annotated

import typer

from .. import options

SUMMARY = "Show every value of a scenario in SI units, and who set it."
EXAMPLES = """
dismech explain cantilever.yaml
dismech explain cantilever.yaml numerics
dismech explain cantilever.yaml geometry[0].radius --profile draft
"""


def explain(
    scenario: options.Scenario,
    path: Annotated[
        str | None, typer.Argument(metavar="[PATH]", help="A key, with all below it.", show_default=False)
    ] = None,
    overrides: options.Set = None,
    profile: options.ProfileOption = None,
    allow_outside: options.AllowOutside = False,
    json: options.Json = False,
) -> int:
    """Entry point of the command."""
    from dataclasses import asdict

    from ...output.jsonable import dumps
    from ...quantities import with_unit
    from ...session.explain import explain as trace
    from ..console import emit
    from ..tables import table

    found = trace(
        scenario,
        path,
        overrides=tuple(overrides or ()),
        profile=None if profile is None else profile.value,
        allow_outside=allow_outside,
    )
    if json:
        emit(dumps({key: asdict(value) for key, value in found.items()}, indent=2))
    else:
        rows = [(key, with_unit(str(p.value), p.unit), p.origin) for key, p in found.items()]
        emit(table(("key", "value", "set by"), rows))
    return 0
