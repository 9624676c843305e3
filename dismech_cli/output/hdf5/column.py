"""HDF5 datasets that grow by the same number of rows with every frame."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...frozen import frozen

# Frames smaller than this share a chunk: a chunk per two-node frame would be mostly bookkeeping.
_SMALLEST_CHUNK = 4096


@frozen
class Column:
    """A growing dataset.

    Attributes:
        dataset: The open ``h5py.Dataset``, shape (frames * rows, *tail).
        rows: Rows added by each frame.
        tail: Shape of one row.
        dtype: Type of the numbers on disk.
        chunk: Shape of the pieces that the file grows by.
    """

    dataset: Any
    rows: int
    tail: tuple[int, ...]
    dtype: np.dtype[Any]
    chunk: tuple[int, ...]

    @property
    def frames(self) -> int:
        """Number of whole frames held."""
        return int(self.dataset.shape[0]) // self.rows if self.rows else np.iinfo(np.int64).max

    def put(self, frame: int, values: Sequence[ArrayLike]) -> None:
        """Store values as the frames from number ``frame`` on; frames before it must exist.

        Raises:
            ValueError: If a value has the wrong number of entries.
        """
        # The low-level calls take a fifth of the time of ``dataset.resize`` and ``dataset[...] =``.
        from h5py import h5s

        shape = (len(values) * self.rows, *self.tail)
        block = np.array(values, dtype=self.dtype).reshape(shape)
        handle = self.dataset.id
        handle.set_extent(((frame + len(values)) * self.rows, *self.tail))
        if block.size:
            target = handle.get_space()
            target.select_hyperslab((frame * self.rows, *(0 for _ in self.tail)), shape)
            handle.write(h5s.create_simple(shape), target, block)

    def truncate(self, frames: int) -> None:
        """Keep the first ``frames`` frames."""
        self.dataset.resize(frames * self.rows, axis=0)

    def room(self, frames: int) -> int:
        """Bytes of the chunks that so many more frames take at most."""
        per_chunk = self.chunk[0] // max(self.rows, 1)
        return prod(self.chunk) * self.dtype.itemsize * -(-frames // per_chunk)


def create_column(
    group: Any, name: str, rows: int, tail: tuple[int, ...] = (), dtype: str = "f8", **attributes: str | int
) -> Column:
    """Make an empty growing dataset whose chunk holds one frame (several, when a frame is tiny).

    Args:
        group: The open ``h5py.Group``.
        name: Path of the dataset inside the group.
        rows: Rows added by each frame.
        tail: Shape of one row.
        dtype: NumPy type code.
        **attributes: Attributes such as ``units`` and ``long_name``.
    """
    # The low-level calls take a third of the time of ``create_dataset`` and ``attrs[...] =``.
    import h5py
    from h5py import h5a, h5d, h5p, h5s, h5t

    frame_bytes = max(rows, 1) * prod(tail) * np.dtype(dtype).itemsize
    per_chunk = max(1, _SMALLEST_CHUNK // max(frame_bytes, 1))
    links = h5p.create(h5p.LINK_CREATE)
    links.set_create_intermediate_group(True)
    storage = h5p.create(h5p.DATASET_CREATE)
    # A dimension of a chunk must not be zero, even where the row is empty.
    chunk = (max(rows, 1) * per_chunk, *(max(size, 1) for size in tail))
    storage.set_chunk(chunk)
    storage.set_obj_track_times(False)
    space = h5s.create_simple((0, *tail), (h5s.UNLIMITED, *tail))
    handle = h5d.create(
        group.id, name.encode(), h5t.py_create(np.dtype(dtype)), space, dcpl=storage, lcpl=links
    )
    for key, told in attributes.items():
        value = np.array(told, dtype=h5py.string_dtype() if isinstance(told, str) else np.int64)
        kind = h5t.py_create(value.dtype, logical=True)
        h5a.create(handle, key.encode(), kind, h5s.create(h5s.SCALAR)).write(value)
    return Column(h5py.Dataset(handle), rows, tail, np.dtype(dtype), chunk)


def open_column(dataset: Any, rows: int) -> Column:
    """Describe a dataset that exists as a column of ``rows`` rows per frame."""
    tail = tuple(int(size) for size in dataset.shape[1:])
    return Column(dataset, rows, tail, dataset.dtype, tuple(int(size) for size in dataset.chunks))
