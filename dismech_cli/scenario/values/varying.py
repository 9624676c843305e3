"""Values that may vary over a body at rest: by an expression, a table or groups of the mesh."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Annotated, Any, Final, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, Tag, ValidationInfo, field_validator

from ...laws.expression import ExpressionError, compile_expression
from ...units import KINDS
from .law_of import LawOf, PlaceRow, PositiveFieldValue
from .quantity import to_si
from .spec import Spec, problem, tag, told_by_key

ALONG: Final = ("s", "arc")
"""Variables along a rod that does not branch: 0 to 1, and length from its start [m], at rest."""

PLACES: Final = ("x", "y", "z", "r")
"""Variables of space: the position at rest [m], and r = sqrt(x^2 + y^2)."""


_UNIT: Final = re.compile(r"\d\s*[A-Za-zµ]")


class ByExpression(Spec):
    """Arithmetic in SI units, as in a law, of the place at rest: x, y, z, r = sqrt(x^2 + y^2), and on a rod
    that does not branch s, 0 to 1 along it, and arc, the length from its start."""  # noqa: D205, D209

    expression: str = Field(description="The text.")

    @field_validator("expression", mode="after")
    @classmethod
    def _parses(cls, text: str) -> str:
        try:
            compile_expression(text, (*ALONG, *PLACES))
        except ExpressionError as error:
            hint = "; its numbers are in SI units and carry none" if _UNIT.search(text) else ""
            raise problem(f"{error.reason} (at column {error.column} of the expression){hint}") from None
        return text


class ByTable(Spec):
    """Values at given places, held before the first and after the last."""

    of: Literal["s", "arc", "x", "y", "z", "r"] = Field(
        description="The place: s, 0 to 1 along a rod; arc, the length from its start; the position at rest."
    )
    table: Annotated[tuple[PlaceRow, ...], Len(1, 1_000_000), Strict(False)] = Field(
        description="Rows of place and value, the places increasing."
    )
    interpolation: Literal["linear", "step", "cubic"] = Field(
        default="linear",
        description="`step` holds each value until the next place; `cubic` is a natural spline.",
    )

    @field_validator("table", mode="before")
    @classmethod
    def _plain_fractions(cls, table: Any, info: ValidationInfo) -> Any:
        """The places of s are numbers, where those of all others are lengths."""
        if info.data.get("of") != "s" or not isinstance(table, list | tuple):
            return table
        return [
            [to_si(row[0], KINDS["ratio"]), *row[1:]] if isinstance(row, list | tuple) and row else row
            for row in table
        ]

    @field_validator("table", mode="after")
    @classmethod
    def _ascending(cls, table: tuple[tuple[float, ...], ...], info: ValidationInfo) -> Any:
        if len(table) < 2:
            raise problem("a table of places needs at least two rows; for one value write it alone")
        for (before, *_), (after, *_) in pairwise(table):
            if after <= before:
                raise problem(f"the places of a table must increase, but {after:g} follows {before:g}")
        if info.data.get("of") == "s" and (table[0][0] < 0.0 or table[-1][0] > 1.0):
            raise problem(f"s runs from 0 to 1, but the table from {table[0][0]:g} to {table[-1][0]:g}")
        return table


class ByGroup(Spec):
    """One value for the body, others for groups of its mesh."""

    value: PositiveFieldValue = Field(description="Value outside the groups.")
    groups: dict[str, PositiveFieldValue] = Field(
        min_length=1, description="Value of each group; where groups overlap, of the last."
    )


Varying: TypeAlias = Annotated[
    Annotated[PositiveFieldValue, Tag("<constant>")]
    | Annotated[ByExpression, Tag(tag("expression"))]
    | Annotated[ByTable, Tag(tag("table"))]
    | Annotated[ByGroup, Tag(tag("groups"))],
    told_by_key("expression", "table", "groups", scalar="<constant>"),
]

_BODY: Final = (*ALONG, *PLACES)
VaryingLength: TypeAlias = Annotated[Varying, LawOf("length", _BODY)]
VaryingModulus: TypeAlias = Annotated[Varying, LawOf("pressure", _BODY)]
VaryingDensity: TypeAlias = Annotated[Varying, LawOf("density", _BODY)]
VaryingTorsionConstant: TypeAlias = Annotated[Varying, LawOf("torsion constant", _BODY)]
VaryingForce: TypeAlias = Annotated[Varying, LawOf("force", _BODY)]
VaryingBendingStiffness: TypeAlias = Annotated[Varying, LawOf("bending stiffness", _BODY)]
VaryingMassPerLength: TypeAlias = Annotated[Varying, LawOf("mass per length", _BODY)]
VaryingInertiaPerLength: TypeAlias = Annotated[Varying, LawOf("inertia per length", _BODY)]


def written(value: Varying) -> tuple[float, ...]:
    """The numbers that are written, in SI units; none in an expression."""
    match value:
        case ByExpression():
            return ()
        case ByTable(table=rows):
            return tuple(row[1] for row in rows)
        case ByGroup(value=rest, groups=groups):
            return (rest, *groups.values())
        case number:
            return (number,)
