"""Whether two parts of models are the same, number by number.

Of two models of one scene at neighbouring values of a parameter most terms are equal: only the others have
to be evaluated to find the slope. Where this cannot tell, parts count as different, which costs time alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import partial, singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray


def alike(one: Any, other: Any) -> bool:
    """Whether two objects hold the same numbers in the same places."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if is_dataclass(one):
        return all(alike(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    return _alike(one, other)


@singledispatch
def _alike(one: Any, other: Any) -> bool:
    return bool(one == other)


@_alike.register(np.ndarray)
def _(one: NDArray[Any], other: NDArray[Any]) -> bool:
    return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


@_alike.register(tuple)
@_alike.register(list)
def _(one: tuple[Any, ...], other: tuple[Any, ...]) -> bool:
    return len(one) == len(other) and all(map(alike, one, other))


@_alike.register(Mapping)
def _(one: Mapping[Any, Any], other: Mapping[Any, Any]) -> bool:
    return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)


@_alike.register(partial)
def _(one: partial[Any], other: partial[Any]) -> bool:
    return alike((one.func, one.args, one.keywords), (other.func, other.args, other.keywords))
