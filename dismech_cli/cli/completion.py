"""What a shell may complete: names of examples, keys of a scenario, fields of a run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer


def templates(incomplete: str) -> list[tuple[str, str]]:
    """Examples by name, each with its description."""
    from ..session.gallery import list_examples

    return [
        (example.name, example.description)
        for example in list_examples()
        if example.name.startswith(incomplete)
    ]


def set_keys(ctx: typer.Context, incomplete: str) -> list[str]:
    """Keys of the scenario on the command line, one step further: ``numerics.`` to ``numerics.dt=``."""
    if "=" in incomplete:
        return []
    return [key for key in _keys(_scenario(ctx), incomplete) if key.startswith(incomplete)]


def fields(ctx: typer.Context, incomplete: str) -> list[str]:
    """Fields of the run on the command line, and what else colours a picture."""
    from ..errors import DismechError
    from ..output.read import read

    found = ["none"]
    try:
        with read(_place(ctx)) as run:
            names = [field.name for field in run.topology.fields]
    except DismechError:
        return []
    found += ["speed"] if "velocity" in names else []
    return [name for name in [*found, *names] if name.startswith(incomplete)]


def _place(ctx: typer.Context) -> Path:
    """The file or folder that a command is about; while an option lacks its value nothing is told apart."""
    named = (ctx.params.get(key) for key in ("run_dir", "scenario", "scenarios"))
    found = next((value for value in named if value), None) or [a for a in ctx.args if a[:1] != "-"]
    first = found[0] if isinstance(found, list | tuple) and found else found
    return Path(str(first))


def _scenario(ctx: typer.Context) -> dict[str, Any]:
    """The scenario or the run that a command is about, every default filled in; empty if there is none."""
    from ..errors import DismechError
    from ..output.run_directory import SCENARIO_FILE
    from ..scenario.load import load
    from ..scenario.views.dump import resolved

    file = _place(ctx)
    if "run_dir" in ctx.params:
        file = file / SCENARIO_FILE
    try:
        return resolved(load(file, allow_outside=True).scenario)
    except (DismechError, OSError):
        return {}


def _keys(data: dict[str, Any], incomplete: str) -> Iterator[str]:
    """Keys one step below what is typed up to its last dot."""
    from ..scenario.checking.known_keys import known_keys
    from ..scenario.load import as_path

    parent, dot, _ = incomplete.rpartition(".")
    path = as_path(parent)
    try:
        node: Any = data
        for part in path:
            node = node[part]
        names = known_keys(data, path)
    except (KeyError, IndexError, TypeError):
        return
    mapping = node if isinstance(node, dict) else {}
    for name in sorted({*names, *mapping}):
        value = mapping.get(name)
        match value:
            case dict():
                yield f"{parent}{dot}{name}."
            case list() if any(isinstance(one, dict) for one in value):
                yield from (f"{parent}{dot}{name}[{k}]." for k in range(len(value)))
            case _:
                yield f"{parent}{dot}{name}="
