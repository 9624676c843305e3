"""Data arrays of VTK's XML files: text, base64 or raw bytes, compressed or not, of bounded size."""

from __future__ import annotations

import base64
import binascii
import lzma
import zlib
from collections.abc import Callable
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from ...arrays import IntArray
from ...errors import MeshError
from ...frozen import frozen

MAX_ARRAY_BYTES = 1 << 27
"""Largest array once it is unpacked [bytes]: a small file may announce very much."""

_TYPES = {f"Int{bits}": f"i{bits // 8}" for bits in (8, 16, 32, 64)}
_TYPES |= {f"U{name}": kind.replace("i", "u") for name, kind in _TYPES.items()}
_TYPES |= {"Float32": "f4", "Float64": "f8"}


def _zlib(block: bytes, size: int) -> bytes:
    return zlib.decompressobj().decompress(block, size)


def _lzma(block: bytes, size: int) -> bytes:
    return lzma.LZMADecompressor().decompress(block, size)


_UNPACK: dict[str, Callable[[bytes, int], bytes]] = {
    "vtkZLibDataCompressor": _zlib,
    "vtkLZMADataCompressor": _lzma,
}


@frozen
class ArrayReader:
    """Reads the data arrays of one file.

    Attributes:
        appended: Data behind the elements.
        raw: Whether these are bytes rather than base64.
        order: Byte order, ``<`` or ``>``.
        size: Type of the sizes before data.
        compressor: Name of the compressor, empty for none.
        where: File, for messages.
    """

    appended: bytes
    raw: bool
    order: str
    size: np.dtype[Any]
    compressor: str
    where: str

    @classmethod
    def of(cls, root: ET.Element, appended: bytes, raw: bool, where: str) -> ArrayReader:
        """Read how arrays are stored.

        Raises:
            MeshError: They are stored in a way that is not read here.
        """
        order = ">" if root.get("byte_order") == "BigEndian" else "<"
        size = root.get("header_type", "UInt32")
        compressor = root.get("compressor", "")
        if size not in ("UInt32", "UInt64"):
            raise MeshError(f"{where}: sizes of type {size[:40]!r}; expected UInt32 or UInt64")
        if compressor and compressor not in _UNPACK:
            raise MeshError(f"{where}: packed by {compressor[:40]}; save it uncompressed or by zlib")
        return cls(appended, raw, order, np.dtype(order + _TYPES[size]), compressor, where)

    def named(self, piece: ET.Element, parent: str, name: str) -> IntArray:
        """The whole numbers of an array by name.

        Raises:
            MeshError: There is none.
        """
        for array in piece.findall(f"{parent}/DataArray"):
            if array.get("Name") == name:
                found = self.read(array)
                if found.dtype.kind == "f":
                    raise MeshError(
                        f"{self.where}: {name} of type {array.get('type')}; expected whole numbers"
                    )
                return found.astype(np.int64)
        raise MeshError(f"{self.where}: {parent} without an array {name!r}")

    def read(self, array: ET.Element) -> NDArray[Any]:
        """The numbers of an array, shape (count,).

        Raises:
            MeshError: They are damaged or too many.
        """
        name, kind = array.get("Name", "Points")[:40], array.get("type", "")
        if kind not in _TYPES:
            raise MeshError(f"{self.where}: array {name!r} of type {kind[:40]!r}")
        dtype = np.dtype(self.order + _TYPES[kind])
        text = (array.text or "").strip()
        try:
            match array.get("format"):
                case "ascii":
                    return _numbers(text, dtype)
                case "binary":
                    data = self._unpacked(_Base64(text.encode("ascii", "replace")))
                case "appended":
                    at = int(array.get("offset", ""))
                    if not 0 <= at <= len(self.appended):
                        raise ValueError(f"offset {at} is out of the appended data")
                    body = self.appended[at:]
                    data = self._unpacked(_Raw(body) if self.raw else _Base64(body))
                case other:
                    raise ValueError(f"format {other!r}")
            return np.frombuffer(data, dtype)
        except (ValueError, OverflowError, binascii.Error, zlib.error, lzma.LZMAError, EOFError) as error:
            raise MeshError(f"{self.where}: array {name!r} is damaged ({error})") from None

    def _unpacked(self, source: _Raw | _Base64) -> bytes:
        """The bytes of an array; sizes come before them."""
        width = self.size.itemsize
        if not self.compressor:
            (size,) = self._sizes(source.head(width), 1)
            return source.body(width, self._bounded(size))
        blocks, _, _ = self._sizes(source.head(3 * width), 3)
        if blocks > MAX_ARRAY_BYTES // width:
            raise ValueError(f"{blocks} packed blocks")
        head = (3 + blocks) * width
        _, size, last, *packed = self._sizes(source.head(head), 3 + blocks)
        self._bounded(size * blocks)
        data = source.packed(head, sum(packed))
        parts, at = [], 0
        for number, length in enumerate(packed, start=1):
            whole = last if number == blocks and last else size
            parts.append(_UNPACK[self.compressor](data[at : at + length], whole) if whole else b"")
            if len(parts[-1]) != whole:
                raise ValueError(f"packed block {number} is {len(parts[-1])} bytes, not {whole}")
            at += length
        return b"".join(parts)

    def _sizes(self, data: bytes, count: int) -> list[int]:
        if len(data) < count * self.size.itemsize:
            raise ValueError("it ends within its sizes")
        found: list[int] = np.frombuffer(data, self.size, count).tolist()
        return found

    def _bounded(self, size: int) -> int:
        if size > MAX_ARRAY_BYTES:
            raise ValueError(f"{size} bytes; up to {MAX_ARRAY_BYTES} are read")
        return size


@frozen
class _Raw:
    """Bytes as they are."""

    data: bytes

    def head(self, count: int) -> bytes:
        """The first bytes."""
        return self.data[:count]

    def body(self, start: int, count: int) -> bytes:
        """Bytes behind a head that is stored with them."""
        return _all(self.data[start : start + count], count)

    def packed(self, start: int, count: int) -> bytes:
        """Bytes behind a head that is stored by itself."""
        return self.body(start, count)


@frozen
class _Base64:
    """Bytes in base64."""

    data: bytes

    def head(self, count: int) -> bytes:
        """The first bytes."""
        return base64.b64decode(self.data[: _encoded(count)])[:count]

    def body(self, start: int, count: int) -> bytes:
        """Bytes behind a head that is encoded with them."""
        return _all(base64.b64decode(self.data[: _encoded(start + count)])[start : start + count], count)

    def packed(self, start: int, count: int) -> bytes:
        """Bytes behind a head that is encoded by itself."""
        at = _encoded(start)
        return _all(base64.b64decode(self.data[at : at + _encoded(count)])[:count], count)


def _encoded(count: int) -> int:
    """Characters of base64 for a number of bytes."""
    return -(-count // 3) * 4


def _all(data: bytes, count: int) -> bytes:
    if len(data) < count:
        raise ValueError(f"{count} bytes announced, {len(data)} follow")
    return data


def _numbers(text: str, dtype: np.dtype[Any]) -> NDArray[Any]:
    tokens = text.split()
    if dtype.kind == "f":
        return np.array([float(token) for token in tokens], dtype=np.float64)
    return np.array([int(token) for token in tokens], dtype=np.int64)
