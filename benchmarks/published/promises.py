"""Expectations of shipped scenarios: value, tolerance and source stand there and nowhere else."""

from __future__ import annotations

from dataclasses import dataclass

from .row import Row, RunError, command, verdicts


@dataclass(frozen=True, slots=True)
class Promises:
    """Those expectations of a scenario that are numbers of the literature; implements :class:`~.row.Case`.

    Attributes:
        file: Name of the scenario, from `scenarios/` on.
        only: Names of the expectations; all if empty.
        changes: What is set in it.
    """

    file: str
    only: tuple[str, ...] = ()
    changes: tuple[str, ...] = ()

    @property
    def command(self) -> str:
        """The line that runs it."""
        return command(self.file, self.changes)

    def rows(self) -> list[Row]:
        """Run it.

        Raises:
            RunError: It does not come to its end, or has no such expectation.
        """
        judged = {one.name: one for one in verdicts(self.file, self.changes)}
        if absent := set(self.only) - set(judged):
            raise RunError(f"{self.file} does not expect {', '.join(sorted(absent))}")
        names = self.only or tuple(judged)
        rows, source = [], ""
        for name, one in judged.items():
            # 'as above' speaks of the expectation before it
            source = source if one.source == "as above" else one.source
            if name in names:
                rows.append(
                    Row(
                        self.command,
                        name,
                        one.expected,
                        one.measured,
                        one.unit,
                        one.tolerance,
                        source,
                        one.passed,
                    )
                )
        return rows
