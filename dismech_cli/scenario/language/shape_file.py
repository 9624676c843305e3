"""The shape of a body in a file."""

from __future__ import annotations

from typing import Annotated

from annotated_types import Len
from pydantic import Field, Strict

from ..values.quantity import Column, FileName
from ..values.spec import Spec


class ShapeFile(Spec):
    """Positions of the nodes of a body in a CSV file [m], one row per node."""

    file: FileName = Field(description="CSV file; its first line may name the columns.")
    columns: Annotated[tuple[Column, ...], Len(3, 3), Strict(False)] = Field(
        default=("x", "y", "z"), description="Columns of x, y and z, by name or number from 0."
    )
