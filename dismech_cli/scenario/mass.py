"""Payloads."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from .quantity import Quantity
from .selection import Selection
from .spec import Spec


class PointMass(Spec):
    """A mass on each selected node: it has weight and inertia."""

    where: Selection = Field(description="Nodes.")
    mass: Annotated[float, Quantity("mass", gt=0)] = Field(description="Mass on each node.")
