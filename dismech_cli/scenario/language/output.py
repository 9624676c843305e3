"""What is written and drawn."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias, get_args

from annotated_types import Len
from pydantic import Field, Strict, field_validator

from ..values.quantity import Name, PositiveTime
from ..values.spec import Spec, problem
from .probe import Probe
from .render import ColorField, Render

FieldName: TypeAlias = Literal["positions", ColorField]
WriterName: TypeAlias = Literal["hdf5", "vtu", "csv"]


class Output(Spec):
    """What is written during the run."""

    every: PositiveTime | None = Field(
        default=None, description="Time between frames; default: t_end / 100, and every step of a static run."
    )
    fields: Annotated[tuple[FieldName, ...], Strict(False)] = Field(
        default=("velocity",), description="Fields in every frame; `positions` are always there."
    )
    writers: Annotated[tuple[WriterName, ...], Len(1, len(get_args(WriterName))), Strict(False)] = Field(
        default=("hdf5", "csv"), description="File formats."
    )
    probes: dict[Name, Probe] = Field(default={}, description="Extra columns of scalars.csv, by name.")
    render: Render = Field(default=Render.unsaid(), description="Pictures.")

    @field_validator("fields", "writers")
    @classmethod
    def _once(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(names)) < len(names):
            raise problem("each name at most once")
        return names
