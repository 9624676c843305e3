"""Values of the simulation as plain JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence, Set
from pathlib import PurePath
from typing import TypeAlias

import numpy as np

Json: TypeAlias = "bool | int | float | str | Sequence[Json] | Mapping[str, Json] | None"


def to_json(value: object) -> Json:
    """Convert arrays, NumPy scalars, paths and containers to plain JSON values.

    JSON has no NaN or infinity: they become the strings ``"nan"``, ``"inf"`` and ``"-inf"``.

    Raises:
        TypeError: If the value has no JSON form.
    """
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, np.ndarray):
        return to_json(value.tolist())
    if isinstance(value, np.generic):
        return to_json(value.item())
    if isinstance(value, int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): to_json(item) for key, item in value.items()}
    if isinstance(value, Set):
        return sorted((to_json(item) for item in value), key=str)
    if isinstance(value, Sequence) and not isinstance(value, bytes):
        return [to_json(item) for item in value]
    raise TypeError(f"no JSON form for {type(value).__name__}")


def dumps(value: object, *, indent: int | None = None) -> str:
    """Serialise ``value`` as strict JSON that any reader accepts."""
    return json.dumps(to_json(value), indent=indent, allow_nan=False, ensure_ascii=False)
