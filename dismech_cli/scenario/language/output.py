"""What is written and drawn."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias, get_args

from annotated_types import Len
from pydantic import Field, Strict, field_validator

from ..values.quantity import Name, PositiveTime
from ..values.spec import Spec, problem
from .probe import Probe

RodField: TypeAlias = Literal[
    "curvature", "twist", "axial_strain", "axial_force", "bending_moment", "director"
]
ShellField: TypeAlias = Literal["area_strain", "bending_energy_density"]
ColorField: TypeAlias = Literal["velocity", RodField, ShellField]
FieldName: TypeAlias = Literal["positions", ColorField]
WriterName: TypeAlias = Literal["hdf5", "vtu", "csv"]
Pixels: TypeAlias = Annotated[int, Field(ge=16, le=8192)]


class Render(Spec):
    """Pictures and films made after the run."""

    view: Literal["xy", "xz", "yz", "iso"] = Field(default="iso", description="Where the camera looks from.")
    video: Literal["mp4", "gif", "none"] = Field(default="none", description="Film of the run.")
    still: bool = Field(default=False, description="A picture of the last frame.")
    color_by: Literal["none", "speed", ColorField] = Field(
        default="none",
        description="Field shown as colour; it must be among `fields` (`speed` needs velocity).",
    )
    size: Annotated[tuple[Pixels, ...], Len(2, 2), Strict(False)] = Field(
        default=(1280, 720), description="Width and height in pixels."
    )
    fps: Annotated[int, Field(ge=1, le=240)] = Field(default=25, description="Frames per second of the film.")
    camera: Literal["fixed", "tracking"] = Field(
        default="fixed", description="`tracking` follows the robot; `fixed` frames the whole motion."
    )
    plots: Annotated[tuple[Name, ...], Strict(False)] = Field(
        default=(), description="Names of probes drawn over time."
    )


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
    render: Render = Field(default=Render(), description="Pictures.")

    @field_validator("fields", "writers")
    @classmethod
    def _once(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(names)) < len(names):
            raise problem("each name at most once")
        return names
