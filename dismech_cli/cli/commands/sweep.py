"""``dismech sweep``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer

from ...session.threads import use_threads
from .. import completion, options

SUMMARY = "Run a scenario with many values; table, report and plots go to results/sweeps/<name>/."
EXAMPLES = """
dismech sweep arm.yaml                                    what its section 'sweep' says
dismech sweep arm.yaml --over parameters.E=1e5,1e6,1e7 -j 4
dismech sweep arm.yaml --over 'parameters.E=1 kPa:1 MPa:7:log' --over geometry[0].generate.nodes=21,41
dismech sweep arm.yaml --lhs 50 --range parameters.E=1e5:1e7:log --range 'parameters.r=1 mm:3 mm' --seed 1
dismech sweep arm.yaml --shard 1/4 -o part --resume
dismech sweep arm.yaml --executor dask://10.0.0.1:8786
"""

_SHARD = re.compile(r"(\d{1,6})/(\d{1,6})")


def shard(text: str) -> tuple[int, int]:
    """Part and number of parts of ``2/4``."""
    match = _SHARD.fullmatch(text.strip())
    if match is None or not 1 <= int(match[1]) <= int(match[2]):
        raise typer.BadParameter(f"expected PART/PARTS such as 2/4, got {text!r}", param_hint="--shard")
    return int(match[1]), int(match[2])


def sweep(
    scenario: options.Scenario,
    over: Annotated[
        list[str] | None,
        typer.Option(
            "--over",
            metavar="KEY=V1,V2",
            help="Vary a value; also KEY=FROM:TO:COUNT[:log]; repeatable.",
            autocompletion=completion.set_keys,
        ),
    ] = None,
    zipped: Annotated[
        list[str] | None,
        typer.Option("--zip", metavar="KEY=V1,V2", help="Lists gone through side by side; repeatable."),
    ] = None,
    csv: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="A table: keys in its first line, a point in each row."),
    ] = None,
    lhs: Annotated[
        int | None, typer.Option("--lhs", metavar="N", min=1, help="Points of a Latin hypercube.")
    ] = None,
    ranges: Annotated[
        list[str] | None,
        typer.Option(
            "--range", metavar="KEY=FROM:TO", help="An interval of --lhs; also with :log; repeatable."
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Seed of --lhs; default 0.")] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", parser=options.folder, help="The folder of the sweep."),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option("-j", "--jobs", min=1, max=1024, help="Points at a time; default: one for each core."),
    ] = None,
    part: Annotated[
        str, typer.Option("--shard", metavar="I/N", help="Only part I of N.", show_default=False)
    ] = "1/1",
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on in a folder that holds points: only what is missing runs.")
    ] = False,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Run those again that did not end well; with --resume.")
    ] = False,
    no_run: Annotated[
        bool, typer.Option("--no-run", help="Run nothing: table and report of what is there; with --resume.")
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Check and list the points only.")] = False,
    light: Annotated[bool, typer.Option("--light", help="Keep the result of each point, no frames.")] = False,
    wall_limit: Annotated[
        float | None,
        typer.Option(
            "--wall-limit",
            metavar="TIME",
            parser=options.duration,
            help="Wall time of each point, such as 10m; one that hangs is killed.",
            show_default=False,
        ),
    ] = None,
    executor: Annotated[
        str | None,
        typer.Option("--executor", metavar="dask://HOST:PORT", help="Run the points on a Dask cluster."),
    ] = None,
    gather: Annotated[
        bool,
        typer.Option("--gather", help="With --executor: bring results by network, not by a shared folder."),
    ] = False,
    overrides: options.Set = None,
    profile: options.ProfileOption = None,
    plugin: options.Plugin = None,
    deterministic: Annotated[
        bool, typer.Option("--deterministic", help="The same bits on every run of this machine.")
    ] = False,
    allow_outside: options.AllowOutside = False,
    junit: options.JUnit = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> int:
    """Entry point of the command."""
    if (retry_failed or no_run) and not resume:
        name = "--retry-failed" if retry_failed else "--no-run"
        raise typer.BadParameter("needs --resume: it is about points that are there", param_hint=name)
    if gather and executor is None:
        raise typer.BadParameter("needs --executor: points of this machine are here", param_hint="--gather")
    if jobs is not None and executor is not None:
        raise typer.BadParameter(
            "is of this machine: the workers of --executor count there", param_hint="--jobs"
        )
    piece = shard(part)
    use_threads(None, deterministic)
    from ...studies.sweep.given_axes import Given
    from ...studies.sweep.points import Base
    from ...studies.sweep.sweep import Request
    from ...studies.sweep.sweep import sweep as run
    from ..junit import failures_in_junit, write_sweep
    from ..sweep_result import show, show_points

    given = Given(over=over or (), zip=zipped or (), csv=csv, lhs=lhs, ranges=ranges or (), seed=seed)
    base = Base(
        path=scenario,
        overrides=tuple(overrides or ()),
        profile=None if profile is None else profile.value,
        allow_outside=allow_outside,
        plugins=tuple(plugin or ()),
    )
    with (
        options.narrator(options.Shown.NONE, quiet, verbose) as console,
        failures_in_junit(junit, scenario.stem),
    ):
        axes = given.axes(scenario.parent)
        if dry_run:
            return show_points(base, axes, piece, json)
        elsewhere = None
        if executor is not None:
            from ...studies.sweep.dask_pool import executor_at

            elsewhere = executor_at(executor, deterministic, gather)
        request = Request(
            base=base,
            axes=axes,
            folder=output,
            shard=piece,
            jobs=jobs,
            resume=resume,
            retry=retry_failed,
            limit=wall_limit,
            light=light,
            run=not no_run,
            deterministic=deterministic,
            executor=elsewhere,
        )
        swept = run(request, console)
    if junit is not None:
        write_sweep(junit, swept)
    return show(swept, json, console)
