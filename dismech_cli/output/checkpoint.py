"""Everything needed to continue a run, in one file that is whole or absent.

A checkpoint is a plain NPZ file without pickled objects. It holds the caller's arrays, the caller's
metadata as JSON, and a SHA-256 of both.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import OutputError
from .durable import output_errors, write_bytes
from .jsonable import Json

_META = "__meta__"
_DIGEST = "__sha256__"
_KEPT = 2
NAME = re.compile(r"checkpoint-\d{6}\.npz")

Arrays = Mapping[str, NDArray[Any]]


def save(folder: Path, arrays: Arrays, meta: Mapping[str, Json]) -> Path:
    """Write the next checkpoint and remove all but the last two.

    Args:
        folder: The folder of checkpoints; made when missing.
        arrays: Arrays of numbers or booleans by name.
        meta: JSON values; floats come back bit by bit, NaN and infinity included.

    Returns:
        The file written.

    Raises:
        OutputError: If it cannot be written; the checkpoints before it are kept.
        ValueError: If an array holds objects or a name is reserved.
    """
    data = packed(arrays, meta)
    with output_errors(folder, "create"):
        folder.mkdir(parents=True, exist_ok=True)
    existing = _newest_first(folder)
    number = int(existing[0].stem.rpartition("-")[2]) + 1 if existing else 1
    path = folder / f"checkpoint-{number:06d}.npz"
    write_bytes(path, data)
    for old in _newest_first(folder)[_KEPT:]:
        old.unlink(missing_ok=True)
    return path


def packed(arrays: Arrays, meta: Mapping[str, Json]) -> bytes:
    """The content of a checkpoint; the same bytes for the same arrays and values.

    Raises:
        ValueError: If an array holds objects or a name is reserved.
    """
    if {_META, _DIGEST} & set(arrays):
        raise ValueError(f"array names {_META} and {_DIGEST} are reserved")
    text = json.dumps(meta, sort_keys=True).encode()
    content: dict[str, NDArray[Any]] = {name: np.asarray(array) for name, array in arrays.items()}
    if any(array.dtype.hasobject for array in content.values()):
        raise ValueError("a checkpoint holds numbers and booleans, not Python objects")
    digest = _digest(content, text)
    content[_META] = np.frombuffer(text, dtype=np.uint8)
    content[_DIGEST] = np.frombuffer(bytes.fromhex(digest), dtype=np.uint8)
    buffer = io.BytesIO()
    np.savez(buffer, **content)  # type: ignore[arg-type]
    return buffer.getvalue()


def newest(folder: Path) -> Path:
    """The newest checkpoint of a folder that is whole.

    Raises:
        OutputError: If there is none.
    """
    for path in _newest_first(folder):
        try:
            load(path)
        except OutputError:
            continue
        return path
    raise OutputError(f"no checkpoint in {folder} is readable")


def load_latest(
    folder: Path, fits: Callable[[Arrays, Mapping[str, Any]], bool] = lambda arrays, meta: True
) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """Load the newest checkpoint that is whole and fits.

    Args:
        folder: The folder of checkpoints.
        fits: Whether the arrays and the metadata of one will do.

    Returns:
        The arrays and the metadata given to :func:`save`.

    Raises:
        OutputError: If there is none, or none is readable; each file is named with its fault.
    """
    faults = []
    for path in _newest_first(folder):
        try:
            arrays, meta = load(path)
        except OutputError as error:
            faults.append(str(error))
            continue
        if fits(arrays, meta):
            return arrays, meta
        faults.append(f"{path} does not serve here")
    if faults:
        raise OutputError("no checkpoint is readable: " + "; ".join(faults))
    raise OutputError(f"no checkpoint in {folder}")


def load(path: Path) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """Load one checkpoint and verify it.

    Raises:
        OutputError: If it is missing or damaged.
    """
    with output_errors(path, "read"):
        data = path.read_bytes()
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            content = {name: file[name] for name in file.files}
        text = content.pop(_META).tobytes()
        stored = content.pop(_DIGEST).tobytes().hex()
    except Exception as error:
        # Damaged bytes can make the parsers of ZIP and NPY raise nearly anything, memory errors included.
        raise OutputError(f"{path} is damaged: {error}") from error
    if stored != _digest(content, text):
        raise OutputError(f"{path} is damaged: its SHA-256 does not match its content")
    return content, json.loads(text)


def _newest_first(folder: Path) -> list[Path]:
    """The checkpoints of a folder; other files in it, such as copies by hand, are left alone."""
    return sorted(
        (file for file in folder.glob("checkpoint-*.npz") if NAME.fullmatch(file.name)), reverse=True
    )


def _digest(arrays: Arrays, text: bytes) -> str:
    digest = hashlib.sha256(text)
    for name in sorted(arrays):
        array = arrays[name]
        digest.update(f"{name} {array.dtype.str} {array.shape}\n".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
