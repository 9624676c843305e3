"""The scenarios that come with the program."""

from __future__ import annotations

from pathlib import Path

from ..errors import DismechError, ScenarioError
from ..frozen import frozen
from ..scenario.text.files import parse_source, read_source
from ..words import hint

_PACKAGE = Path(__file__).resolve().parents[1]


@frozen
class Example:
    """A shipped scenario.

    Attributes:
        name: Stem of its file.
        path: Its file.
        description: From the file; the fault if it cannot be read.
    """

    name: str
    path: Path
    description: str


def folder() -> Path:
    """Where the examples lie: inside an installed package, beside it in a checkout."""
    installed = _PACKAGE / "examples"
    return installed if installed.is_dir() else _PACKAGE.parent / "scenarios"


def list_examples() -> list[Example]:
    """All examples by name."""
    files = sorted(file for file in folder().glob("*.*") if file.suffix in (".yaml", ".yml", ".toml"))
    return [Example(file.stem, file, _description(file)) for file in files]


def find_example(name: str) -> Example:
    """The example called ``name``.

    Raises:
        ScenarioError: There is none.
    """
    examples = {example.name: example for example in list_examples()}
    if name not in examples:
        known = ", ".join(examples) or "none"
        raise ScenarioError(f"no example is called {name!r}{hint(name, examples)} (there are: {known})")
    return examples[name]


def _description(file: Path) -> str:
    try:
        node = parse_source(read_source(file, file.name), file.suffix).child("description")
    except DismechError as error:
        return str(error).splitlines()[0]
    return " ".join(str(node.value).split()) if node is not None else ""
