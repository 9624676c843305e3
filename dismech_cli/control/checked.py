"""Controllers of plugins: held to the protocol, since nobody else has read them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arrays import FloatArray
from ..errors import ControlError
from ..frozen import frozen
from .controller import Controller, Memory
from .limits import UNLIMITED, Limits

_COMMAND = "command"


@frozen
class Checked:
    """A controller of a plugin within limits.

    Attributes:
        name: Name of the controller in the scenario.
        inner: What the plugin made.
        n: Length of its command.
        limits: Of the command.
    """

    name: str
    inner: Controller
    n: int
    limits: Limits = UNLIMITED

    def start(self, n: int) -> Memory:
        """That of the plugin, and no command.

        Raises:
            ControlError: The plugin fails.
        """
        try:
            memory = self.inner.start(n)
        except Exception as error:
            raise ControlError(f"controller '{self.name}' fails in start: {_told(error)}") from error
        return {_COMMAND: np.zeros(n), **self._kept(memory, "in start")}

    def sample(self, t: float, y: FloatArray, r: FloatArray, memory: Memory) -> tuple[FloatArray, Memory]:
        """The command.

        Raises:
            ControlError: The plugin fails, or commands what is no command.
        """
        when = f"at t = {t:g} s"
        before = memory[_COMMAND]
        own = {key.removeprefix("of."): values.copy() for key, values in memory.items() if key != _COMMAND}
        try:
            wanted, kept = self.inner.sample(t, y.copy(), r.copy(), own)
            command = np.array(wanted, dtype=np.float64)
        except Exception as error:
            raise ControlError(f"controller '{self.name}' fails {when}: {_told(error)}") from error
        if command.shape != (self.n,):
            raise ControlError(
                f"controller '{self.name}' commands {when} values of shape {command.shape}, not ({self.n},)"
            )
        if not np.isfinite(command).all():
            raise ControlError(f"controller '{self.name}' commands {when} a value that is not finite")
        told = self._kept(kept, when)
        if told.keys() != {key for key in memory if key != _COMMAND}:
            raise ControlError(
                f"controller '{self.name}' remembers {when} other names than start gave: {', '.join(kept)}"
            )
        command = self.limits.applied(command, before)
        return command, {_COMMAND: command, **told}

    def _kept(self, memory: Any, when: str) -> dict[str, FloatArray]:
        if not isinstance(memory, Mapping) or not all(isinstance(key, str) for key in memory):
            raise ControlError(
                f"the memory of controller '{self.name}' {when} is no mapping of names to arrays"
            )
        kept = {}
        for key, values in memory.items():
            if not isinstance(values, np.ndarray) or values.dtype != np.float64:
                raise ControlError(
                    f"controller '{self.name}' remembers {when} as {key!r} what is no array of float64"
                )
            kept[f"of.{key}"] = values.copy()
        return kept


def _told(error: Exception) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
