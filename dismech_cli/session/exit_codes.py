"""How a session ended, as the number with which a program ends."""

from __future__ import annotations

from enum import IntEnum

from ..errors import DismechError


class Exit(IntEnum):
    """Exit codes of the program, beside 128 + signal for an interruption."""

    DONE = 0
    BUG = 1
    INPUT = 2
    SOLVER = 3
    EXPECTATION = 4
    OUTPUT = 5
    RENDER = 6
    INTERRUPTED = 130
    CLOSED_PIPE = 141


def code_of(error: BaseException) -> int:
    """The code with which ``error`` will end the program, for the record of a run."""
    if isinstance(error, DismechError):
        return error.exit_code
    return Exit.INTERRUPTED if isinstance(error, KeyboardInterrupt) else Exit.BUG
