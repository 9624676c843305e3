"""Bytes of a text file as text, however the program that wrote it encodes text and ends lines."""

from __future__ import annotations

import codecs
from typing import Final

UNFETCHED: Final = "a Git LFS pointer stands in place of the file; fetch it with 'git lfs pull'"
"""What to say about a file for which :func:`is_lfs_pointer` holds."""

_POINTER: Final = b"version https://git-lfs.github.com/spec/"
_UTF16: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def is_lfs_pointer(data: bytes) -> bool:
    """True if Git has left its note of a large file where the file should be."""
    return data.startswith(_POINTER)


def decode(data: bytes, errors: str = "strict") -> str:
    r"""Text in UTF-8, or in UTF-16 if its byte order mark says so; every line ends in ``\n``.

    Args:
        data: The file.
        errors: As for :meth:`bytes.decode`.

    Raises:
        UnicodeDecodeError: If the bytes are no such text and ``errors`` is strict.
    """
    text = data.decode("utf-16" if data.startswith(_UTF16) else "utf-8-sig", errors)
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text
