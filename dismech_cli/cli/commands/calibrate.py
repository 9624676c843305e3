"""``dismech calibrate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ...session.threads import use_threads
from .. import options

SUMMARY = "Fit values of a scenario to measured curves, or to a shape that is wanted."
EXAMPLES = """
dismech calibrate swinging_arm.yaml
dismech calibrate swinging_arm.yaml -o fit --json
dismech calibrate rest_in_arc.yaml --set numerics.newton.tolerance=1e-10
"""


def calibrate(
    scenario: options.Scenario,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            parser=options.folder,
            help="Where the report goes; a fit that was stopped there goes on. "
            "Default: results/<name>/calibration.",
            show_default=False,
        ),
    ] = None,
    no_finer: Annotated[
        bool, typer.Option("--no-dt-check", help="Skip the second fit, at half the time step.")
    ] = False,
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
    from ...studies.calibrate.calibrate import calibrate
    from ...studies.calibrate.fit_page import write_fit_page
    from ...studies.calibrate.report import as_json, as_text, write_report
    from ...studies.source import Source
    from ..console import emit

    chosen = None if profile is None else profile.value
    source = Source.of(scenario, tuple(overrides or ()), chosen, allow_outside=allow_outside)
    folder = output or Path("results") / source.load().scenario.name / "calibration"
    with options.narrator(options.Shown.NONE, quiet, verbose) as console:
        fit = calibrate(source, folder, console, finer=not no_finer)
        for doubt in fit.doubts:
            console.warn(doubt)
    write_report(folder, source, fit)
    write_fit_page(folder, source, fit)
    emit(dumps(as_json(fit), indent=2) if json else f"{as_text(fit)}\n{folder}")
    return Exit.DONE
