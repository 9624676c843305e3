"""The command ``dismech``: one line per subcommand; nothing heavy is imported before one of them runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import typer

from .. import __version__
from .commands import (
    calibrate,
    check,
    compare,
    doctor,
    examples,
    explain,
    export,
    gradient,
    init,
    render,
    report,
    resume,
    run,
    schema,
    study,
    sweep,
)
from .exits import leave

_HELP = """Simulate slender soft robots made of rods, in batch.

\b
  dismech init                      start from an example
  dismech check cantilever.yaml     what would be built, and what it would cost
  dismech run cantilever.yaml       simulate; results go to results/<name>/<run-id>/
  dismech render results/...        video, pictures, diagrams
"""

app = typer.Typer(
    name="dismech",
    help=_HELP,
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"dismech {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Options of the program itself."""


def _add(command: Callable[..., int], name: str, summary: str, examples: str) -> None:
    """Register a subcommand whose help leads with examples."""
    lines = "\n".join(f"  {line.strip()}" for line in examples.strip().splitlines())
    app.command(name, help=f"{summary}\n\n\b\n{lines}", short_help=summary)(command)


_add(run.run, "run", run.SUMMARY, run.EXAMPLES)
_add(check.check, "check", check.SUMMARY, check.EXAMPLES)
_add(explain.explain, "explain", explain.SUMMARY, explain.EXAMPLES)
_add(resume.resume, "resume", resume.SUMMARY, resume.EXAMPLES)
_add(study.study, "study", study.SUMMARY, study.EXAMPLES)
_add(sweep.sweep, "sweep", sweep.SUMMARY, sweep.EXAMPLES)
_add(compare.compare, "compare", compare.SUMMARY, compare.EXAMPLES)
_add(render.render, "render", render.SUMMARY, render.EXAMPLES)
_add(report.report, "report", report.SUMMARY, report.EXAMPLES)
_add(export.export, "export", export.SUMMARY, export.EXAMPLES)
_add(gradient.gradient, "gradient", gradient.SUMMARY, gradient.EXAMPLES)
_add(calibrate.calibrate, "calibrate", calibrate.SUMMARY, calibrate.EXAMPLES)
_add(init.init, "init", init.SUMMARY, init.EXAMPLES)
_add(examples.examples, "examples", examples.SUMMARY, examples.EXAMPLES)
_add(schema.schema, "schema", schema.SUMMARY, schema.EXAMPLES)
_add(doctor.doctor, "doctor", doctor.SUMMARY, doctor.EXAMPLES)


def main(arguments: list[str] | None = None) -> Any:
    """Run the program and end the process with its exit code.

    Args:
        arguments: The command line without the program name; None takes that of the process.
    """
    leave(app, arguments)
