"""Files that are either whole or absent, and write failures told in one sentence.

HDF5 on a full disk fails twice: at the flush and again while its own clean-up runs at interpreter
exit, where it can crash the process. A caller that catches an :class:`OutputError` from a writer
should therefore write its error record and leave with ``os._exit``.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO

from ..errors import OutputError

_REASONS = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the disk quota is used up",
    errno.EFBIG: "the file size limit is reached",
    errno.EROFS: "the file system is read-only",
    errno.EACCES: "permission denied",
    errno.EPERM: "permission denied",
    errno.ENOENT: "the folder does not exist",
    errno.ENOTDIR: "a part of the path is not a folder",
    errno.EEXIST: "it exists already and is never overwritten",
}


@contextlib.contextmanager
def output_errors(path: Path, action: str = "write") -> Iterator[None]:
    """Turn what the system or HDF5 raises inside the block into an :class:`OutputError`.

    Args:
        path: The file or folder named in the message.
        action: Verb of the message: ``cannot <action> <path>: ...``.

    Raises:
        OutputError: For any ``OSError`` and for the plain ``RuntimeError`` of h5py.
    """
    try:
        yield
    except OSError as error:
        raise OutputError(f"cannot {action} {path}: {_reason(error)}") from error
    except RuntimeError as error:
        # h5py raises exactly RuntimeError; its subclasses (recursion, not implemented) are bugs of ours.
        if type(error) is not RuntimeError:
            raise
        raise OutputError(f"cannot {action} {path}: {_reason(error)}") from error


def _reason(error: OSError | RuntimeError) -> str:
    number = error.errno if isinstance(error, OSError) else None
    if number is None:
        # HDF5 hides the system's error number inside its own text.
        found = re.search(r"errno = (\d+)", str(error))
        number = int(found.group(1)) if found else None
    if number in _REASONS:
        return _REASONS[number]
    return os.strerror(number) if number is not None else str(error)


@contextlib.contextmanager
def staged(path: Path) -> Iterator[Path]:
    """Give a temporary path beside ``path``; move it into place when the block succeeds.

    Readers see the old file or the new one, never a part. The temporary file is removed on failure.

    Raises:
        OutputError: If the file cannot be written.
    """
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        with output_errors(path):
            yield temporary
            temporary.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise


def write_bytes(path: Path, data: bytes) -> None:
    """Replace ``path`` by ``data``, atomically, and safe against loss of power.

    Raises:
        OutputError: If the file cannot be written.
    """
    with staged(path) as temporary, temporary.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    sync_folder(path.parent)


def write_fully(file: IO[bytes], data: bytes) -> None:
    """Write all of ``data`` at the position of an unbuffered file.

    The system may take a part only; writing the rest then shows the reason.

    Raises:
        OSError: If not all could be written; a part may be in the file.
    """
    rest = memoryview(data)
    while rest:
        rest = rest[file.write(rest) :]


def size_up_to(path: Path, lines: Iterable[bytes], t: float, time_of: Callable[[bytes], float]) -> int:
    """Bytes of the whole lines, in order of time, up to a time.

    Args:
        path: The file, for messages.
        lines: Of the file, each with its line end; the last may be cut.
        t: The time [s].
        time_of: The time of a whole line [s].

    Raises:
        OutputError: If a whole line has no time.
    """
    size = 0
    for number, line in enumerate(lines, start=1):
        if not line.endswith(b"\n"):
            break
        try:
            late = time_of(line) > t
        except (ValueError, TypeError, LookupError) as error:
            raise OutputError(f"cannot go on with {path}: line {number} is damaged") from error
        if late:
            break
        size += len(line)
    return size


def sync_folder(folder: Path) -> None:
    """Make renames inside ``folder`` durable; a no-op where folders cannot be synchronised."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
