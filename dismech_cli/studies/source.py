"""A scenario that is read again and again, with a few of its values changed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..scenario.load import LoadedScenario, load


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A scenario file as given on the command line.

    Attributes:
        path: The file.
        overrides: ``KEY=VALUE`` texts.
        profile: ``draft``, ``normal``, ``accurate`` or None.
        allow_outside: Whether files may lie outside the folder of the scenario.
    """

    path: Path
    overrides: tuple[str, ...] = ()
    profile: str | None = None
    allow_outside: bool = False

    def load(self, *changes: str) -> LoadedScenario:
        """The scenario with more ``KEY=VALUE`` texts.

        Raises:
            ScenarioError: It cannot be read so.
        """
        return load(
            self.path,
            overrides=(*self.overrides, *changes),
            profile=self.profile,
            allow_outside=self.allow_outside,
        )
