"""The command ``dismech``: one line per subcommand; nothing heavy is imported before one of them runs."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from types import ModuleType
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

_COMMANDS: Mapping[str, ModuleType] = {
    module.__name__.rpartition(".")[2]: module
    for module in (
        run,
        check,
        explain,
        resume,
        study,
        sweep,
        compare,
        render,
        report,
        export,
        gradient,
        calibrate,
        init,
        examples,
        schema,
        doctor,
    )
}


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"dismech {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Options of the program itself."""


def _program(commands: Mapping[str, ModuleType]) -> typer.Typer:
    """The program with some subcommands, each of which has help that leads with examples."""
    made = typer.Typer(
        name="dismech",
        help=_HELP,
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
    )
    made.callback()(_root)
    for name, module in commands.items():
        lines = "\n".join(f"  {line.strip()}" for line in module.EXAMPLES.strip().splitlines())
        made.command(name, help=f"{module.SUMMARY}\n\n\b\n{lines}", short_help=module.SUMMARY)(
            getattr(module, name)
        )
    return made


app = _program(_COMMANDS)


def main(arguments: list[str] | None = None) -> Any:
    """Run the program and end the process with its exit code.

    Args:
        arguments: The command line without the program name; None takes that of the process.
    """
    # those of other packages have no business with scenarios; to search for them takes 5 ms
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")
    name = next(iter(sys.argv[1:] if arguments is None else arguments), "")
    # reading the options of all commands takes longer than reading a scenario
    leave(_program({name: _COMMANDS[name]}) if name in _COMMANDS else app, arguments)
