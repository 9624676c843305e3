"""Errors that a user can cause or mend; each class fixes the exit code of the command line.

Anything that is not a :class:`DismechError` is a bug in this program: it keeps its traceback and
ends with exit code 1.
"""

from __future__ import annotations

from typing import ClassVar


class DismechError(Exception):
    """A failure with one clear message and no traceback."""

    exit_code: ClassVar[int] = 1


class ScenarioError(DismechError):
    """The scenario file, a ``--set`` argument or the command line is wrong (exit 2)."""

    exit_code = 2


class MeshError(ScenarioError):
    """A mesh file or generator gives an unusable mesh (exit 2)."""


class LawError(DismechError):
    """A law of time has no value where a run needs it (exit 3)."""

    exit_code = 3


class ControlError(DismechError):
    """A controller fails in the middle of a run (exit 3)."""

    exit_code = 3


class SolverError(DismechError):
    """The solver gave up, or the motion blew up (exit 3)."""

    exit_code = 3


class ExpectationError(DismechError):
    """A run came to its end and missed what its scenario expects (exit 4)."""

    exit_code = 4


class UnfinishedError(DismechError):
    """A run was stopped before its end (exit 130)."""

    exit_code = 130


class OutputError(DismechError):
    """A result could not be written or read (exit 5)."""

    exit_code = 5


class RenderError(DismechError):
    """No picture can be made on this machine (exit 6)."""

    exit_code = 6
