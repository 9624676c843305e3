"""Centrelines that are generated rather than read from a mesh."""

from __future__ import annotations

import math
from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.quantity import (
    Angle,
    Column,
    DirectionTriple,
    FileName,
    LengthTriple,
    NodeCount,
    PositiveLength,
    Quantity,
)
from ..values.spec import Spec, problem


class Line(Spec):
    """A straight line with evenly spaced nodes."""

    shape: Literal["line"] = Field(description="Kind of curve.")
    start: LengthTriple = Field(alias="from", description="First node.")
    end: LengthTriple = Field(alias="to", description="Last node.")
    nodes: NodeCount = Field(description="Number of nodes.")

    @model_validator(mode="after")
    def _extended(self) -> Line:
        if self.start == self.end:
            raise problem("a line must not end where it starts")
        return self


class Arc(Spec):
    """A circular arc with evenly spaced nodes."""

    shape: Literal["arc"] = Field(description="Kind of curve.")
    center: LengthTriple = Field(description="Centre of the circle.")
    radius: PositiveLength = Field(description="Radius of the circle.")
    normal: DirectionTriple = Field(description="Normal of its plane; angles turn right-handed about it.")
    start: DirectionTriple = Field(description="Direction from the centre to the first node.")
    angle: Angle = Field(description="Angle from the first to the last node, signed, at most a full turn.")
    nodes: NodeCount = Field(description="Number of nodes.")
    closed: bool = Field(
        default=False, description="A ring: a full turn whose last edge returns to the first node."
    )

    @model_validator(mode="after")
    def _sound(self) -> Arc:
        turn = abs(self.angle) / (2 * math.pi)
        if not 0 < turn <= 1 + 1e-12:
            raise problem(
                f"the angle of an arc must be more than 0 and at most 360 deg, got {360 * turn:g} deg"
            )
        if self.closed and abs(turn - 1) > 1e-12:
            raise problem(f"a closed arc turns through 360 deg, got {360 * turn:g} deg")
        n, s = self.normal, self.start
        cross = (n[1] * s[2] - n[2] * s[1], n[2] * s[0] - n[0] * s[2], n[0] * s[1] - n[1] * s[0])
        if math.hypot(*cross) <= 1e-9 * math.hypot(*n) * math.hypot(*s):
            raise problem("the start of an arc must not lie along its normal")
        return self


class Helix(Spec):
    """A helix with evenly spaced nodes."""

    shape: Literal["helix"] = Field(description="Kind of curve.")
    origin: LengthTriple = Field(description="Point of the axis at the height of the first node.")
    axis: DirectionTriple = Field(description="Direction of the axis.")
    radius: PositiveLength = Field(description="Distance of the nodes from the axis.")
    pitch: Annotated[float, Quantity("length", ge=0)] = Field(description="Advance along the axis per turn.")
    turns: Annotated[float, Quantity("ratio", gt=0)] = Field(
        description="Number of turns, not necessarily whole."
    )
    handedness: Literal["right", "left"] = Field(description="Right- or left-handed.")
    phase: Angle = Field(default=0.0, description="Angle of the first node about the axis.")
    nodes: NodeCount = Field(description="Number of nodes.")


class Polyline(Spec):
    """A curve of straight pieces, divided evenly if a number of nodes or a spacing is given."""

    shape: Literal["polyline"] = Field(description="Kind of curve.")
    points: Annotated[tuple[LengthTriple, ...], Len(2, 1_000_000), Strict(False)] = Field(
        description="Corners."
    )
    nodes: NodeCount | None = Field(default=None, description="Number of nodes; default: the corners.")
    spacing: PositiveLength | None = Field(default=None, description="Aim for the edge length.")
    closed: bool = Field(default=False, description="Joins the last point to the first.")

    @model_validator(mode="after")
    def _sound(self) -> Polyline:
        if self.nodes is not None and self.spacing is not None:
            raise problem("give 'nodes' or 'spacing', not both")
        if self.closed and len(self.points) < 3:
            raise problem("a closed polyline needs at least 3 points")
        return self


class CsvCurve(Spec):
    """Nodes from a CSV file, in metres."""

    shape: Literal["csv"] = Field(description="Kind of curve.")
    file: FileName = Field(description="CSV file; its first line may name the columns.")
    columns: Annotated[tuple[Column, ...], Len(3, 3), Strict(False)] = Field(
        default=(0, 1, 2), description="Columns of x, y and z, by name or number from 0."
    )
    closed: bool = Field(default=False, description="Joins the last node to the first.")


Shape: TypeAlias = Annotated[Line | Arc | Helix | Polyline | CsvCurve, Field(discriminator="shape")]
