"""One quantity of a run over all its frames."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray


class FrameArray:
    """One quantity over all frames, read from the file one frame at a time.

    ``array[i]`` is frame i, ``array[a:b]`` several frames stacked, ``numpy.asarray(array)`` all.
    """

    def __init__(self, dataset: Any, frames: int, rows: int | None) -> None:
        self._dataset = dataset
        self._frames = frames
        self._rows = rows

    def __len__(self) -> int:
        return self._frames

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape with the frames first."""
        tail = tuple(int(size) for size in self._dataset.shape[1:])
        return (self._frames, *tail) if self._rows is None else (self._frames, self._rows, *tail)

    @overload
    def __getitem__(self, frame: int) -> FloatArray: ...
    @overload
    def __getitem__(self, frame: slice) -> FloatArray: ...
    def __getitem__(self, frame: int | slice) -> FloatArray:
        if isinstance(frame, slice):
            start, stop, step = frame.indices(self._frames)
            if step != 1:
                chosen = [self[i] for i in range(start, stop, step)]
                return np.stack(chosen) if chosen else np.empty((0, *self.shape[1:]))
            return self._read(start, max(stop, start))
        index = frame + self._frames if frame < 0 else frame
        if not 0 <= index < self._frames:
            raise IndexError(f"frame {frame} of {self._frames}")
        block: FloatArray = self._read(index, index + 1)[0]
        return block

    def _read(self, start: int, stop: int) -> FloatArray:
        rows = 1 if self._rows is None else self._rows
        values = np.asarray(self._dataset[start * rows : stop * rows], dtype=np.float64)
        return values.reshape(stop - start, *self.shape[1:])

    def __iter__(self) -> Iterator[FloatArray]:
        return (self[i] for i in range(self._frames))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.asarray(self[:], dtype=dtype)
