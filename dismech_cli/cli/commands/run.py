"""``dismech run``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ...session.threads import use_threads
from .. import options

SUMMARY = "Simulate a scenario; results go to results/<name>/<run-id>/."
EXAMPLES = """
dismech run cantilever.yaml
dismech run cantilever.yaml --set numerics.dt='1 ms' --profile draft
dismech run cantilever.yaml -o out --overwrite --json
dismech run following_arm.yaml --plugin follow.py
dismech run jellyfish.yaml --wall-limit 2h --checkpoint-every 5m
"""


def run(
    scenario: options.Scenario,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="DIR",
            parser=options.folder,
            help="The run directory itself.",
            show_default=False,
        ),
    ] = None,
    overrides: options.Set = None,
    profile: options.ProfileOption = None,
    until: options.Until = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the run that is in the directory of -o.")
    ] = False,
    checkpoint_every: options.CheckpointEvery = 60.0,
    wall_limit: options.WallLimit = None,
    threads: Annotated[
        int | None, typer.Option("--threads", min=1, max=1024, help="Threads of all libraries; default 1.")
    ] = None,
    deterministic: Annotated[
        bool, typer.Option("--deterministic", help="The same bits on every run of this machine.")
    ] = False,
    plugins: options.Plugin = None,
    allow_outside: options.AllowOutside = False,
    no_render: options.NoRender = False,
    junit: options.JUnit = None,
    json: options.Json = False,
    progress: options.Progress = options.Shown.AUTO,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> int:
    """Entry point of the command."""
    if overwrite and output is None:
        raise typer.BadParameter(
            "needs -o DIR: other run directories are new anyway", param_hint="--overwrite"
        )
    use_threads(threads, deterministic)
    from ...session.pause import Pause
    from ...session.start import Start, start
    from ..junit import failures_in_junit, write_junit
    from ..result import show

    request = Start(
        path=scenario,
        overrides=tuple(overrides or ()),
        profile=None if profile is None else profile.value,
        allow_outside=allow_outside,
        output=output,
        overwrite=overwrite,
        draw=not no_render,
        pause=Pause(until, wall_limit, checkpoint_every),
        plugins=tuple(plugins or ()),
    )
    with (
        options.narrator(progress, quiet, verbose) as console,
        failures_in_junit(junit, scenario.stem),
    ):
        finished = start(request, console)
    if junit is not None:
        write_junit(junit, finished)
    return show(finished, json, console.level)
