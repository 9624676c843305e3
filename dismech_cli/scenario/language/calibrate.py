"""What is fitted to what: values of the scenario to measured curves, or to a shape that is wanted."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.quantity import Column, FileName, Index, Length, Name, Time
from ..values.spec import Spec, exactly_one, exclusive

Amount: TypeAlias = float | str
Letter: TypeAlias = Literal["x", "y", "z"]


class Fitted(Spec):
    """A value of the scenario that is fitted; it starts where the scenario has it."""

    of: Annotated[str, Field(min_length=1, max_length=200)] = Field(
        description="Its key path, such as `parameters.E` or `materials.rubber.youngs_modulus`."
    )
    min: Amount | None = Field(default=None, description="Least value: SI, or with a unit.")
    max: Amount | None = Field(default=None, description="Greatest value.")
    scale: Literal["linear", "log"] = Field(
        default="linear", description="`log` for what may be wrong by a factor, and cannot change its sign."
    )
    deviation: Amount | None = Field(
        default=None,
        description="How far it may be from the value of the scenario, as a standard deviation; default: "
        "nothing is known. `log` takes a ratio.",
    )


class Markers(Spec):
    """Points of a body whose positions are measured."""

    model_config = exclusive(("nodes", "arc"))

    of: Name = Field(description="Name of the body.")
    nodes: Annotated[tuple[Index, ...], Len(1), Strict(False)] | None = Field(
        default=None, description="Its nodes, counted from 0; this or `arc`."
    )
    arc: Annotated[tuple[Length, ...], Len(1), Strict(False)] | None = Field(
        default=None, description="Lengths along a rod from its start, at rest, anywhere between nodes."
    )
    columns: dict[Letter, str] = Field(
        min_length=1,
        description="Column of each coordinate, such as `x: 'x_{i}'`; `{i}` counts the markers. Without "
        "`time` each row is a marker instead.",
    )
    first: Index = Field(default=0, description="Number of the first marker in the names of columns.")
    predicted: Annotated[tuple[Index, ...], Strict(False)] = Field(
        default=(), description="Numbers of markers that are kept out of the fit, to be predicted by it."
    )
    camera: bool = Field(
        default=False,
        description="The columns are those of a picture, across and down, of two coordinates: scale, turn "
        "and place of the camera are fitted too.",
    )

    @model_validator(mode="after")
    def _one(self) -> Markers:
        exactly_one(self, "nodes", "arc")
        return self


class Samples(Spec):
    """A table of measured values; a cell that is empty or `nan` is a missing sample."""

    model_config = exclusive(("probes", "markers"))

    file: FileName = Field(description="CSV file, or HDF5 file (`.h5`) whose data sets are the columns.")
    time: Column | None = Field(
        default=None, description="Column of the times; default: all are values of the end of the run."
    )
    time_unit: str = Field(default="s", description="Unit of the times.")
    unit: str = Field(description="Unit of the values, such as mm; `1` for pictures and ratios.")
    deviation: Annotated[float, Field(gt=0)] | None = Field(
        default=None,
        description="Standard deviation of a sample, in that unit; default: as large as what the fit leaves.",
    )
    probes: dict[Name, Column] | None = Field(
        default=None, description="Column of each probe of the output; this or `markers`."
    )
    markers: Markers | None = Field(default=None, description="Positions of points.")
    after: Time | None = Field(default=None, description="Leaves out what was before this time.")
    before: Time | None = Field(default=None, description="Leaves out what was after this time.")
    hold_out: Annotated[int, Field(ge=2)] | None = Field(
        default=None, description="Keeps every so-manyeth row out of the fit, to be predicted by it."
    )

    @model_validator(mode="after")
    def _one(self) -> Samples:
        exactly_one(self, "probes", "markers")
        return self


class Calibrate(Spec):
    """A fit, made by `dismech calibrate`; a run does not know of it."""

    fit: Annotated[tuple[Fitted, ...], Len(0, 200), Strict(False)] = Field(description="What is fitted.")
    data: Annotated[tuple[Samples, ...], Len(1), Strict(False)] = Field(description="To what.")
    robust: bool = Field(
        default=False, description="Samples far off, beyond a few deviations, count by their distance only."
    )
