"""Threads limited for as long as a run lasts, in a process that is not ours.

The command line sets environment variables before any library is loaded. In a user's process NumPy is
loaded already, so the libraries are told themselves, and told what they were told before when the run
is over.
"""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack
from types import TracebackType
from typing import Final, Self

from threadpoolctl import ThreadpoolController

from ..model.saved import Arrays, Numbers
from ..output.frame import Frame
from ..run.sink import Progress

# What each library reads, as on the command line; all others follow OpenMP.
_VARIABLES: Final = {"mkl": "MKL_NUM_THREADS", "openblas": "OPENBLAS_NUM_THREADS"}
_OPENMP: Final = "OMP_NUM_THREADS"
# The library that is loaded by the first solver that needs it, by the module that does so.
_LATE: Final = "pypardiso"


class ThreadLimits:
    """Gives each library the threads that the environment says, else one, inside a ``with`` block.

    It is also a sink of the run: MKL is loaded in the middle of one, at the latest before the first
    solve, and is limited from the next frame or step on.
    """

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._complete = False

    def __enter__(self) -> Self:
        self._limit()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._stack.close()

    def frame(self, frame: Frame) -> None:
        """Look for what was loaded."""
        self._look()

    def event(self, kind: str, t: float, **details: object) -> None:
        """Do nothing."""

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        """Do nothing."""

    def progress(self, progress: Progress) -> None:
        """Look for what was loaded."""
        self._look()

    def _look(self) -> None:
        if not self._complete and _LATE in sys.modules:
            self._limit()

    def _limit(self) -> None:
        self._complete = _LATE in sys.modules
        libraries = ThreadpoolController()
        for name in {library.internal_api for library in libraries.lib_controllers}:
            count = _count(_VARIABLES.get(name, _OPENMP))
            self._stack.enter_context(libraries.select(internal_api=name).limit(limits=count))


def _count(variable: str) -> int:
    """The number in a variable, of the outermost level where it lists several; one without a number."""
    text = os.environ.get(variable, "").partition(",")[0].strip()
    return max(int(text), 1) if text.isdecimal() else 1
