"""Opening what a scenario names: regular files inside its own tree, of bounded size."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Final

from ...errors import ScenarioError
from ...file_text import UNFETCHED, decode, is_lfs_pointer
from ...words import hint
from .problems import Problem, ProblemsError
from .toml_text import parse_toml
from .tree import MAX_BYTES, Mark, Node, Source
from .yaml_text import parse_yaml

_PARSERS: Final = {".yaml": parse_yaml, ".yml": parse_yaml, ".toml": parse_toml}

_LIMIT: Final = f"{MAX_BYTES // 1024**2} MB"
_TOO_LARGE: Final = (
    f"larger than {_LIMIT}, the limit for a scenario: give long curves and tables as CSV files"
)


def resolve_file(name: str, directory: Path, tree: Path | None, *, folders: bool = False) -> Path:
    """The absolute path of an existing regular file.

    Args:
        name: As written, relative to ``directory`` or absolute.
        directory: Where relative names start.
        tree: Folder that the file must be in, links followed; None allows any.
        folders: Allows a folder in its place.

    Raises:
        ScenarioError: if the file is missing, no regular file, or outside ``tree``.
    """
    try:
        path = (directory / name).resolve()
        mode = path.stat().st_mode
    except (OSError, ValueError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or "not a usable path"
        raise ScenarioError(f"cannot open {name!r}: {reason.lower()}") from None
    if not stat.S_ISREG(mode) and not (folders and stat.S_ISDIR(mode)):
        raise ScenarioError(f"{name!r} is not a regular file")
    if tree is not None and not path.is_relative_to(tree.resolve()):
        raise ScenarioError(f"{name!r} lies outside the folder of the scenario; --allow-outside permits that")
    return path


def read_source(path: Path, name: str, note: str = "") -> Source:
    """The text of a scenario file.

    Raises:
        ScenarioError: if it cannot be read, is no regular file, larger than 4 MB, no text in UTF-8 or
            UTF-16, or not fetched from Git LFS.
    """
    try:
        # Opening a FIFO for reading would wait for a writer for ever.
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
        with os.fdopen(descriptor, "rb") as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise ScenarioError(f"{name}: not a regular file")
            data = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not a usable path"
        raise ScenarioError(f"{name}: cannot read: {reason.lower()}{_near(path)}") from None
    if len(data) > MAX_BYTES:
        raise ScenarioError(f"{name}: {_TOO_LARGE}")
    if is_lfs_pointer(data):
        raise ScenarioError(f"{name}:1: {UNFETCHED}")
    try:
        text = decode(data)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ScenarioError(f"{name}:{line}: not a text file in UTF-8") from None
    if "\0" in text:
        raise ScenarioError(f"{name}:{text.count(chr(10), 0, text.index(chr(0))) + 1}: not a text file")
    return Source(name, text, note)


def _near(path: Path) -> str:
    """The scenario in the folder that may have been meant, where there is none of this name."""
    try:
        names = [] if path.exists() else sorted(file.name for file in path.parent.iterdir())
    except (OSError, ValueError):
        names = []
    return hint(path.name, (name for name in names if Path(name).suffix.lower() in _PARSERS))


def parse_source(source: Source, suffix: str) -> Node:
    """The tree of a scenario text, whose root must be a mapping.

    Raises:
        ScenarioError: for an unknown suffix; as :class:`ProblemsError` for every fault found.
    """
    parser = _PARSERS.get(suffix.lower())
    if len(source.text) > MAX_BYTES:
        raise ScenarioError(f"{source.name}: {_TOO_LARGE}")
    if parser is None:
        raise ScenarioError(
            f"{source.name}: a scenario ends in .yaml, .yml or .toml, not {suffix or 'nothing'!r}"
        )
    tree = parser(source)
    if not isinstance(tree.value, dict):
        raise ProblemsError([Problem(Mark(source, 1, 1), (), "a scenario is a mapping of keys to values")])
    return tree
