"""``dismech resume``."""

from __future__ import annotations

from ...session.threads import use_threads_of
from .. import options

SUMMARY = "Continue a run from its last checkpoint; the result is that of an uninterrupted run."
EXAMPLES = """
dismech resume results/cantilever/20261122T101500Z-1a2b3c
dismech resume out --wall-limit 1h
dismech resume out --until '2 s'
dismech resume out --set numerics.dt='0.5 ms'
"""


def resume(
    run_dir: options.RunDir,
    until: options.Until = None,
    overrides: options.Set = None,
    plugins: options.Plugin = None,
    checkpoint_every: options.CheckpointEvery = 60.0,
    wall_limit: options.WallLimit = None,
    no_render: options.NoRender = False,
    junit: options.JUnit = None,
    json: options.Json = False,
    progress: options.Progress = options.Shown.AUTO,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> int:
    """Entry point of the command."""
    use_threads_of(run_dir)
    from ...session.pause import Pause
    from ...session.resume import proceed
    from ..junit import failures_in_junit, write_junit
    from ..result import show

    with (
        options.narrator(progress, quiet, verbose) as console,
        failures_in_junit(junit, run_dir.name),
    ):
        pause = Pause(until, wall_limit, checkpoint_every)
        finished = proceed(
            run_dir,
            pause,
            console,
            tuple(overrides or ()),
            draw=not no_render,
            plugins=tuple(plugins or ()),
        )
    if junit is not None:
        write_junit(junit, finished)
    return show(finished, json, console.level)
