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
    checkpoint_every: options.CheckpointEvery = 60.0,
    wall_limit: options.WallLimit = None,
    json: options.Json = False,
    progress: options.Progress = options.Shown.AUTO,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> int:
    """Entry point of the command."""
    use_threads_of(run_dir)
    from ...session.pause import Pause
    from ...session.resume import proceed
    from ..result import show

    with options.narrator(progress, quiet, verbose) as console:
        finished = proceed(
            run_dir, Pause(until, wall_limit, checkpoint_every), console, tuple(overrides or ())
        )
    return show(finished, json, console.level)
