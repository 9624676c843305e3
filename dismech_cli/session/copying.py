"""An example copied to where the user works."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from ..errors import ScenarioError
from ..output.durable import output_errors, write_bytes
from ..scenario.load import load
from ..scenario.text.files import parse_source, read_source
from ..scenario.views.walk import leaves


def copy_example(example: Path, target: Path) -> list[Path]:
    """Copy a scenario to ``target`` and the files it names beside it, under the names it gives them.

    Returns:
        The files made, the scenario first.

    Raises:
        ScenarioError: A file exists already, or the suffix is another one.
        OutputError: A file cannot be written.
    """
    if target.suffix != example.suffix:
        raise ScenarioError(f"{target}: expected a name that ends in {example.suffix}, like the example")
    pairs = {target: example}
    for name in _names(example):
        pairs[target.parent / name] = example.parent / name
    taken = [str(new) for new in pairs if new.exists()]
    if taken:
        raise ScenarioError(
            f"{', '.join(taken)}: exists already and is never overwritten; choose another --output"
        )
    for new, old in pairs.items():
        with output_errors(new.parent, "create"):
            new.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(new, old.read_bytes())
    return list(pairs)


def _names(example: Path) -> list[str]:
    """Files that a scenario names and includes, relative to its folder."""
    named = [leaf.value for leaf in leaves(load(example).scenario) if leaf.file]
    root = example.parent.resolve()
    included = [str(file.resolve().relative_to(root)) for file in _included(example)]
    return list(dict.fromkeys([*included, *named]))


def _included(file: Path) -> Iterator[Path]:
    """The files that a scenario file includes, and those that they include."""
    node = parse_source(read_source(file, file.name), file.suffix).child("include")
    for name in () if node is None else node.plain():
        yield file.parent / name
        yield from _included(file.parent / name)
