"""Ask the file system for room before HDF5 needs it.

HDF5 does not survive a failed write: it raises at the flush, again at the close, and may crash the
process at exit. Room reserved beforehand turns a full disk into an ordinary error while the file is
still whole.
"""

from __future__ import annotations

import contextlib
import errno
import os
from typing import Any

# Index nodes, object headers and aggregation blocks that HDF5 may touch per column and per file.
_METADATA_PER_COLUMN = 8 * 1024
_METADATA_PER_FILE = 64 * 1024


def room_for(chunk_bytes: list[int]) -> int:
    """Most bytes by which frames can enlarge the file, given those of the new chunks of each column."""
    return sum(chunk_bytes) + len(chunk_bytes) * _METADATA_PER_COLUMN + _METADATA_PER_FILE


def reserve(file: Any, size: int) -> None:
    """Reserve ``size`` bytes after the end of an open ``h5py.File``.

    Where the file system knows no reservation, nothing happens.

    Raises:
        OSError: If there is no room.
    """
    if not hasattr(os, "posix_fallocate"):
        return
    try:
        os.posix_fallocate(file.id.get_vfd_handle(), file.id.get_filesize(), size)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.EOPNOTSUPP, errno.ENOSYS):
            raise


def release(file: Any) -> None:
    """Give back what was reserved and not used."""
    with contextlib.suppress(OSError):
        os.ftruncate(file.id.get_vfd_handle(), file.id.get_filesize())
