"""An example copied to where the user works."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from ..errors import ScenarioError
from ..output.durable import output_errors, write_bytes
from ..scenario.load import load
from ..scenario.text.files import parse_source, read_source
from ..scenario.views.editor import TITLE, editor_schema
from ..scenario.views.walk import leaves

SCHEMA_FILE = "dismech.schema.json"
_FOR_EDITORS = "# yaml-language-server: $schema="


def copy_example(example: Path, target: Path) -> list[Path]:
    """Copy a scenario to ``target`` and the files it names beside it, under the names it gives them.

    A scenario in YAML tells editors its schema, which is written beside it, in place of an older one.

    Returns:
        The files made, the scenario first and the schema last.

    Raises:
        ScenarioError: A file exists already, or the suffix is another one.
        OutputError: A file cannot be written.
    """
    if target.suffix != example.suffix:
        raise ScenarioError(f"{target}: expected a name that ends in {example.suffix}, like the example")
    pairs = {target: example}
    for name in _names(example):
        pairs[target.parent / name] = example.parent / name
    schema = target.parent / SCHEMA_FILE
    taken = [str(new) for new in pairs if new.exists()]
    if schema.exists() and not _is_ours(schema):
        taken.append(str(schema))
    if taken:
        raise ScenarioError(
            f"{', '.join(taken)}: exists already and is never overwritten; choose another --output"
        )
    for new, old in pairs.items():
        with output_errors(new.parent, "create"):
            new.parent.mkdir(parents=True, exist_ok=True)
        data = old.read_bytes()
        write_bytes(new, _told(data) if new == target and target.suffix != ".toml" else data)
    write_bytes(schema, json.dumps(editor_schema(), indent=1).encode())
    return [*pairs, schema]


def _told(data: bytes) -> bytes:
    """A scenario in YAML whose first line names the schema beside it."""
    lines = data.splitlines(keepends=True)
    if lines and lines[0].startswith(_FOR_EDITORS.encode()):
        lines = lines[1:]
    return b"".join([f"{_FOR_EDITORS}{SCHEMA_FILE}\n".encode(), *lines])


def _is_ours(schema: Path) -> bool:
    """Whether a file is a schema that this program wrote."""
    with output_errors(schema, "read"):
        return schema.is_file() and f'"title": "{TITLE}"'.encode() in schema.read_bytes()[:1000]


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
