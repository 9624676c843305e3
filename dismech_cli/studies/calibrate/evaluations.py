"""Evaluations that a fit has made, kept on disk too: one that was stopped goes on from there."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import FloatArray
from ...output.durable import staged


@dataclass(slots=True)
class Evaluation:
    """What a run predicts.

    Attributes:
        predicted: For each table, shape (R, C).
        slopes: Their derivatives, shape (R, C, P); None until they are asked for.
    """

    predicted: list[FloatArray]
    slopes: list[FloatArray] | None = None


@dataclass(slots=True)
class Evaluations:
    """All of them, by the bytes of their values.

    Attributes:
        folder: Where they are kept.
        tables: How many tables each predicts.
    """

    folder: Path
    tables: int
    _known: dict[bytes, Evaluation] = field(default_factory=dict, init=False)

    def get(self, key: bytes) -> Evaluation | None:
        """The one at some values; None if there is none."""
        if key not in self._known and (found := self._read(key)) is not None:
            self._known[key] = found
        return self._known.get(key)

    def keep(self, key: bytes, one: Evaluation) -> None:
        """Keep one, in place of what was known at these values."""
        self._known[key] = one
        arrays: dict[str, Any] = {f"predicted_{k}": x for k, x in enumerate(one.predicted)}
        arrays |= {f"slopes_{k}": x for k, x in enumerate(one.slopes or ())}
        with staged(self._file(key)) as temporary, temporary.open("wb") as stream:
            np.savez(stream, values=np.frombuffer(key), **arrays)

    def _read(self, key: bytes) -> Evaluation | None:
        file = self._file(key)
        if not file.exists():
            return None
        with np.load(file) as found:
            if found["values"].tobytes() != key:
                return None
            predicted = [found[f"predicted_{k}"] for k in range(self.tables)]
            slopes = [found[f"slopes_{k}"] for k in range(self.tables)] if "slopes_0" in found else None
        return Evaluation(predicted, slopes)

    def _file(self, key: bytes) -> Path:
        return self.folder / f"{hashlib.sha256(key).hexdigest()[:16]}.npz"
