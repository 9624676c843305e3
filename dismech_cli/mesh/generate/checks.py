"""What generators ask of their arguments; ``where`` names the generator in messages."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import FloatArray
from ...errors import MeshError
from ..limits import MAX_COORDINATE, MAX_GENERATED, check_count


def vector(value: ArrayLike, name: str, where: str) -> FloatArray:
    """Three finite numbers, shape (3,).

    Raises:
        MeshError: If it is anything else.
    """
    triple = np.asarray(value, dtype=np.float64)
    if triple.shape != (3,) or not (np.abs(triple) <= MAX_COORDINATE).all():
        raise MeshError(f"{where}: {name} {value!r}; expected three finite numbers")
    return triple


def unit(triple: FloatArray, name: str, where: str) -> FloatArray:
    """The direction of a vector, shape (3,).

    Raises:
        MeshError: If it has none.
    """
    size = float(np.linalg.norm(triple))
    if not size > 1e-12:
        raise MeshError(f"{where}: {name} has no direction; expected a vector that is not zero")
    direction: FloatArray = triple / size
    return direction


def check_positive(value: float, name: str, where: str) -> None:
    """Refuse sizes that are not positive or beyond all measure.

    Raises:
        MeshError: Naming the size.
    """
    if not 0.0 < value <= MAX_COORDINATE:
        raise MeshError(f"{where}: {name} {value}; expected a positive number")


def check_nodes(count: int, least: int, where: str) -> None:
    """Refuse too few nodes and too many.

    Raises:
        MeshError: Naming the count.
    """
    if count < least:
        raise MeshError(f"{where}: {count} nodes; expected at least {least}")
    check_count(count, "nodes", where)


def check_divisions(count: int, where: str) -> None:
    """Refuse fewer than one edge along a side.

    Raises:
        MeshError: Naming the count.
    """
    if count < 1:
        raise MeshError(f"{where}: {count} divisions; expected at least 1")


def check_triangles(count: float, where: str) -> None:
    """Refuse surfaces of too many triangles, from a count that is known before they are made.

    Raises:
        MeshError: Naming the count.
    """
    if not count <= MAX_GENERATED:
        raise MeshError(
            f"{where}: {count:.3g} triangles; a generated surface may have {MAX_GENERATED}; make it coarser"
        )
