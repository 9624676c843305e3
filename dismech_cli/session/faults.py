"""Why a session could not begin or go on, for programs: file, line, column, key, message."""

from __future__ import annotations

from ..output.jsonable import Json
from ..scenario.text.problems import ProblemsError
from ..scenario.text.tree import format_path


def faults(error: BaseException) -> list[dict[str, Json]]:
    """Every fault that an error tells; what is not known of its place is None."""
    match error:
        case ProblemsError(problems=problems):
            return [
                {
                    "file": problem.mark.source.name,
                    "line": problem.mark.line if problem.mark.source.positions else None,
                    "column": problem.mark.column,
                    "key": format_path(problem.path) or None,
                    "message": problem.message,
                }
                for problem in problems
            ]
        case _:
            return [fault(str(error) or type(error).__name__)]


def fault(message: str) -> dict[str, Json]:
    """A fault without a place."""
    return {"file": None, "line": None, "column": None, "key": None, "message": message}
