"""Payloads."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..values.quantity import Quantity
from ..values.selection import SelectedNodes
from ..values.spec import Spec


class PointMass(Spec):
    """A mass on each selected node: it has weight and inertia."""

    where: SelectedNodes = Field(description="Nodes.")
    mass: Annotated[float, Quantity("mass", gt=0)] = Field(description="Mass on each node.")
