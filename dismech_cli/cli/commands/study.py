"""``dismech study``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ...session.threads import use_threads
from .. import options

SUMMARY = "Find the cheapest settings for an accuracy; tables and a page go to results/studies/<name>/."
EXAMPLES = """
dismech study arm.yaml --target 1%                        what its section 'study' says, or levels of its dt
dismech study arm.yaml --over 'numerics.dt=10 ms:5' --over geometry[0].generate.nodes=11:3
dismech study arm.yaml --over 'numerics.dt=10 ms:5' --over numerics.integrator=tr_bdf2,generalized_alpha
dismech study arm.yaml --quantity tip:rms --all
"""


def study(
    scenario: options.Scenario,
    over: Annotated[
        list[str] | None,
        typer.Option(
            "--over",
            metavar="KEY=FROM:LEVELS",
            help="Refine a value from the coarsest on; also KEY=A,B for alternatives; repeatable.",
        ),
    ] = None,
    quantity: Annotated[
        list[str] | None,
        typer.Option(
            "--quantity",
            metavar="PROBE[:NORM]",
            help="Whose error counts; NORM is max, rms, last, mean or period; repeatable.",
        ),
    ] = None,
    target: Annotated[
        str | None, typer.Option("--target", metavar="SHARE", help="Largest error allowed, such as 1%.")
    ] = None,
    reference: Annotated[
        str | None,
        typer.Option(
            "--reference",
            metavar="levels|finest",
            help="Know errors from differences between levels, or as distances from the finest run.",
        ),
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="Run every combination.")] = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", parser=options.folder, help="Where results go."),
    ] = None,
    overrides: options.Set = None,
    profile: options.ProfileOption = None,
    allow_outside: options.AllowOutside = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> int:
    """Entry point of the command."""
    use_threads(None, False)
    from ...output.jsonable import dumps
    from ...session.exit_codes import Exit
    from ...studies.study.given_study import given_over, given_quantities, given_reference, given_target
    from ...studies.study.study import PAGE_FILE, Request
    from ...studies.study.study import study as run
    from ...studies.study.study_text import as_json
    from ...studies.sweep.points import Base
    from ..console import QUIET, emit

    request = Request(
        base=Base(
            path=scenario,
            overrides=tuple(overrides or ()),
            profile=None if profile is None else profile.value,
            allow_outside=allow_outside,
        ),
        over=given_over(over or ()),
        quantities=given_quantities(quantity or ()),
        target=given_target(target),
        reference=given_reference(reference),
        every=every,
        folder=output,
    )
    with options.narrator(options.Shown.NONE, quiet, verbose) as console:
        studied = run(request, console)
        if json:
            emit(dumps(as_json(studied), indent=2))
        else:
            emit(studied.told)
            if console.level > QUIET:
                emit(f"page: {studied.folder / PAGE_FILE}")
    return Exit.DONE if studied.answer is not None else Exit.EXPECTATION
