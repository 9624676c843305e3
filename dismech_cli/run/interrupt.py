"""Ctrl-C, SIGTERM, a closed terminal: finish the step, keep a checkpoint, stop; a second stops at once."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class StopRequest:
    """Whether a signal asked the run to stop, and which one."""

    def __init__(self) -> None:
        self.signal: int | None = None

    @property
    def requested(self) -> bool:
        """Whether to stop after this step."""
        return self.signal is not None

    @property
    def exit_code(self) -> int:
        """128 + signal number, as shells expect."""
        return 128 + (self.signal or 0)

    def handle(self, number: int, frame: FrameType | None) -> None:
        """Signal handler."""
        if self.signal is not None:
            raise KeyboardInterrupt
        self.signal = number


@contextmanager
def stop_on_signals() -> Iterator[StopRequest]:
    """Catch SIGINT, SIGTERM and SIGHUP inside the block; does nothing outside the main thread."""
    request = StopRequest()
    if threading.current_thread() is not threading.main_thread():
        yield request
        return
    numbers = [signal.SIGINT, signal.SIGTERM]
    # not on every system; ignored where a terminal is meant to be closed, as by nohup
    if hangup := getattr(signal, "SIGHUP", None):
        numbers += [hangup] if signal.getsignal(hangup) is not signal.SIG_IGN else []
    before = [signal.signal(number, request.handle) for number in numbers]
    try:
        yield request
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)
