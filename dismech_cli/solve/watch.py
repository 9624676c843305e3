"""How long something takes in all."""

from __future__ import annotations

import time
from types import TracebackType


class Watch:
    """Runs while it is entered.

    Attributes:
        seconds: Wall time so far [s].
    """

    def __init__(self) -> None:
        self.seconds = 0.0
        self._since = 0.0

    def __enter__(self) -> None:
        self._since = time.perf_counter()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.seconds += time.perf_counter() - self._since
