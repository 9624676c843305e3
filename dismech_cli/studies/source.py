"""A scenario that is read once, and loaded again and again with a few of its values changed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Self

from ..frozen import frozen
from ..scenario.load import LoadedScenario, Written, read_file


@frozen
class Source:
    """A scenario file as given on the command line.

    Attributes:
        path: The file.
        written: Its text.
        overrides: ``KEY=VALUE`` texts.
        profile: ``draft``, ``normal``, ``accurate`` or None.
    """

    path: Path
    written: Written
    overrides: tuple[str, ...]
    profile: str | None

    @classmethod
    def of(cls, path: Path, overrides: tuple[str, ...], profile: str | None, *, allow_outside: bool) -> Self:
        """Read the file.

        Raises:
            ScenarioError: It cannot be read.
        """
        return cls(path, read_file(path, allow_outside=allow_outside), overrides, profile)

    def having(self, *changes: str) -> Self:
        """The same with more ``KEY=VALUE`` texts."""
        return replace(self, overrides=(*self.overrides, *changes))

    def load(self, *changes: str) -> LoadedScenario:
        """The scenario with more ``KEY=VALUE`` texts.

        Raises:
            ScenarioError: It is wrong.
        """
        return self.written.load((*self.overrides, *changes), self.profile)
