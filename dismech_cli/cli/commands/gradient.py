"""``dismech gradient``."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from ...session.threads import use_threads
from .. import options

SUMMARY = "Differentiate a number that a run gives by values of its scenario."
EXAMPLES = """
dismech gradient cantilever.yaml --of tip --by materials.rubber.youngs_modulus
dismech gradient arm.yaml --of tip_z --by parameters.E --by geometry[0].radius --json
dismech gradient gripper.yaml --of grip --by parameters.stiffness --method differences
"""


class How(StrEnum):
    """How to differentiate."""

    AUTO = "auto"
    FORWARD = "forward"
    ADJOINT = "adjoint"
    DIFFERENCES = "differences"


def gradient(
    scenario: options.Scenario,
    of: Annotated[
        str,
        typer.Option(
            "--of", metavar="NAME", help="A probe of the output, or an expectation.", show_default=False
        ),
    ],
    by: Annotated[
        list[str] | None,
        typer.Option(
            "--by",
            metavar="KEY",
            help="Key path of a number, such as parameters.E; repeatable. Default: all parameters.",
            show_default=False,
            autocompletion=options.completion.set_keys,
        ),
    ] = None,
    method: Annotated[How, typer.Option("--method", help="How to differentiate.")] = How.AUTO,
    no_check: Annotated[bool, typer.Option("--no-check", help="Skip the comparison with runs.")] = False,
    overrides: options.Set = None,
    profile: options.ProfileOption = None,
    allow_outside: options.AllowOutside = False,
    json: options.Json = False,
    progress: options.Progress = options.Shown.AUTO,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> int:
    """Entry point of the command."""
    use_threads(None, False)
    from ...output.jsonable import dumps
    from ...session.exit_codes import Exit
    from ...studies.gradient.gradient import Method, gradient
    from ...studies.gradient.report import as_json, as_text
    from ...studies.source import Source
    from ..console import emit

    chosen = None if profile is None else profile.value
    source = Source.of(scenario, tuple(overrides or ()), chosen, allow_outside=allow_outside)
    with options.narrator(progress, quiet, verbose) as console:
        found = gradient(
            source, of, tuple(by or ()), console, method=Method(method.value), checked=not no_check
        )
    emit(dumps(as_json(found), indent=2) if json else as_text(found))
    if found.check is not None and not found.check.agrees:
        console.error("the gradient and the difference of runs disagree: trust neither")
        return Exit.EXPECTATION
    return Exit.DONE
