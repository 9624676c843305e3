"""``dismech check``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from ...session.threads import use_threads
from .. import options

SUMMARY = "Read and build scenarios without stepping: plan with reasons, warnings, cost."
EXAMPLES = """
dismech check cantilever.yaml
dismech check scenarios/*.yaml --junit report.xml
dismech check cantilever.yaml --set geometry[0].generate.nodes=1001 --json
"""


def check(
    scenarios: Annotated[
        list[Path], typer.Argument(metavar="SCENARIO...", help="YAML or TOML files.", show_default=False)
    ],
    overrides: options.Set = None,
    profile: options.ProfileOption = None,
    plugins: options.Plugin = None,
    allow_outside: options.AllowOutside = False,
    junit: options.JUnit = None,
    json: options.Json = False,
) -> int:
    """Entry point of the command."""
    use_threads(None, False)
    from ...errors import DismechError
    from ...output.jsonable import Json, dumps
    from ...session.exit_codes import Exit
    from ...session.faults import faults
    from ...session.inspect import inspect
    from ..console import Console, emit
    from ..junit import write_checks

    console = Console()
    found: list[Mapping[str, Json]] = []
    bad: dict[str, str] = {}
    for path in scenarios:
        try:
            finding = inspect(
                path,
                overrides=tuple(overrides or ()),
                profile=None if profile is None else profile.value,
                allow_outside=allow_outside,
                plugins=tuple(plugins or ()),
            )
        except DismechError as error:
            console.error(str(error))
            found.append({"scenario": str(path), "ok": False, "error": str(error), "errors": faults(error)})
            bad[str(path)] = str(error)
            continue
        found.append(finding.as_json())
        for warning in finding.warnings:
            console.warn(warning)
        if not json:
            emit(str(finding))
    if junit is not None:
        write_checks(junit, {str(path): bad.get(str(path), "") for path in scenarios})
    if json:
        emit(dumps(found, indent=2))
    return Exit.INPUT if bad else Exit.DONE
