"""What is wrong with a scenario, where, shown with its line and a caret."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from ...errors import ScenarioError
from ...frozen import frozen
from .tree import KeyPath, Mark, format_path

SHOWN: Final = 25
EXCERPT_WIDTH: Final = 96


@frozen
class Problem:
    """One fault: its place, the key path if there is one, and a message."""

    mark: Mark
    path: KeyPath
    message: str

    def line(self) -> str:
        """``scene.yaml:12:13: materials.steel.densty: unknown key``."""
        path = f"{format_path(self.path)}: " if self.path else ""
        return f"{self.mark}: {path}{self.message}"

    def __str__(self) -> str:
        return f"{self.line()}\n{excerpt(self.mark)}".rstrip("\n")


class ProblemsError(ScenarioError):
    """All faults found in one pass, each with its place.

    Args:
        problems: The faults.
        more: How many there are beside them.
    """

    def __init__(self, problems: Sequence[Problem], more: int = 0) -> None:
        unique = list(dict.fromkeys(problems))
        unique.sort(key=lambda p: (p.mark.source.name, p.mark.line, p.mark.column))
        text = "\n".join(str(problem) for problem in unique[:SHOWN])
        if len(unique) + more > SHOWN:
            text += f"\n... and {len(unique) + more - SHOWN} more"
        super().__init__(text)
        self.problems = tuple(unique)


def excerpt(mark: Mark) -> str:
    """The line of a mark with a caret under it; empty if the text has no such line."""
    lines = mark.source.text.splitlines()
    if not 1 <= mark.line <= len(lines) or not lines[mark.line - 1].strip():
        return ""
    line = "".join(c if c.isprintable() else " " for c in lines[mark.line - 1])
    start = max(0, mark.column - 1 - EXCERPT_WIDTH // 2) if len(line) > EXCERPT_WIDTH else 0
    shown = line[start : start + EXCERPT_WIDTH]
    column = mark.column - 1 - start
    caret = "^" * max(1, min(mark.width, len(shown) - column))
    gutter = str(mark.line) if mark.source.positions else ""
    blank = " " * len(gutter)
    return f"  {gutter} | {shown}\n  {blank} | {' ' * column}{caret}"
