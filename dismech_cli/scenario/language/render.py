"""What is drawn."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.quantity import DirectionTriple, LengthTriple, Name, Quantity, Time
from ..values.selection import SelectedNodes, TextToo
from ..values.spec import Spec, problem

RodField: TypeAlias = Literal[
    "curvature", "twist", "axial_strain", "axial_force", "bending_moment", "director", "contact_line_load"
]
ShellField: TypeAlias = Literal["area_strain", "bending_energy_density", "contact_pressure"]
ContactField: TypeAlias = Literal["contact_force", "contact_line_load", "contact_pressure"]
"""Fields that follow from how stiff contact was at each step, which frames do not tell."""
ColorField: TypeAlias = Literal["velocity", "displacement", "contact_force", RodField, ShellField]
ComputedField: TypeAlias = Literal[
    "velocity", "displacement", "curvature", "axial_strain", "axial_force", "area_strain"
]
"""Fields that positions and velocities tell in any scene: pictures need not find them in the frames."""

Pixels: TypeAlias = Annotated[int, Field(ge=64, le=7680)]
HexColor: TypeAlias = Annotated[str, Field(pattern=r"^#[0-9a-fA-F]{6}$")]
Limit: TypeAlias = Annotated[float, Quantity("ratio")]

WHOLE = "all"
_NAMED: dict[str, dict[str, str]] = {"fixed": {}, "tracking": {"follow": WHOLE}}


class Camera(Spec):
    """Where the eye is; `fixed` is short for a camera that frames all that is shown, `tracking` for one that
    follows the robot."""  # noqa: D205, D209

    from_: LengthTriple | None = Field(
        default=None, alias="from", description="Position of the eye; default: in the direction of `view`."
    )
    to: LengthTriple | None = Field(
        default=None, description="What it looks at; default: the middle of the motion."
    )
    up: DirectionTriple | None = Field(
        default=None, description="Direction that is up in the picture; default: that of `view`, or z."
    )
    angle: Annotated[float, Quantity("angle", ge=0, lt=3.0)] | None = Field(
        default=None,
        description="Height of the field of view. 0 is a parallel projection, whose length scale holds"
        " everywhere; default: 30 deg with `from`, else 0.",
    )
    follow: Name | None = Field(
        default=None, description="Body that the camera moves along with; `all` is the whole robot."
    )

    @model_validator(mode="before")
    @classmethod
    def _shorthand(cls, value: Any) -> Any:
        if isinstance(value, str):
            if value not in _NAMED:
                raise problem(
                    f"expected 'fixed', 'tracking' or a mapping such as {{from: ...}}, got {value!r}"
                )
            return _NAMED[value]
        return value

    @model_validator(mode="after")
    def _looks_somewhere(self) -> Camera:
        if self.from_ is not None and self.from_ == self.to:
            raise problem("'from' and 'to' must be different points")
        return self


class Render(Spec):
    """Pictures and films made after the run."""

    view: Literal["auto", "xy", "xz", "yz", "iso"] = Field(
        default="auto",
        description="Plane of the picture, or `iso` for an oblique view; `auto` is the plane of a planar"
        " scene, else `iso`.",
    )
    video: Literal["mp4", "gif", "none"] = Field(default="none", description="Film of the run.")
    still: bool = Field(default=False, description="A picture of the last frame; `times` ask for theirs.")
    times: Annotated[tuple[Time, ...], Len(0, 1000), Strict(False)] = Field(
        default=(), description="Times of stills, the nearest frames, in place of the last."
    )
    layout: Literal["separate", "panels"] = Field(
        default="separate", description="Stills in files of their own, or side by side in one."
    )
    color_by: Literal["none", "speed", ColorField] = Field(
        default="none",
        description="Field shown as colour; `none` gives each body a colour, `speed` is that of `velocity`."
        " Fields of contact and those that depend on how cross-sections turn must be among `fields`.",
    )
    range: Annotated[tuple[Limit, ...], Len(2, 2), Strict(False)] | None = Field(
        default=None,
        description="Values of the first and last colour in SI units; default: the range of the run without"
        " short peaks, which the colour bar tells.",
    )
    colors: dict[Name, HexColor] = Field(
        default={}, description="Colours of bodies by name, such as `'#2e7da6'`."
    )
    ends: Literal["extended", "stored", "marked"] = Field(
        default="extended",
        description="Colour of the ends of rods, where curvature, twist and moment are stored as zero because"
        " no joint is there: `extended` from the joint beside them, as `stored`, or `marked`, dark where a"
        " rod starts and red where it ends.",
    )
    size: Annotated[tuple[Pixels, ...], Len(2, 2), Strict(False)] = Field(
        default=(1280, 720), description="Width and height in pixels; odd ones are rounded up."
    )
    text: Annotated[float, Quantity("ratio", ge=0, le=5)] = Field(
        default=1.0, description="Size of the labels, which grow with the picture; 0 writes none."
    )
    fps: Annotated[int, Field(ge=1, le=240)] = Field(
        default=25, description="Pictures per second of the film."
    )
    speed: Annotated[float, Quantity("ratio", gt=0)] | None = Field(
        default=None,
        description="Time of the run over time of the film. Default: 1, real time; runs under 1 s are slowed"
        " to films of some 4 s, runs over 120 s hastened, and the film says so.",
    )
    camera: Annotated[Camera, TextToo()] = Field(
        default=Camera.unsaid(), description="`fixed` frames all that is shown, `tracking` follows the robot."
    )
    ground: Literal["none", "grid", "floor"] = Field(
        default="none",
        description="At the lowest point of the motion: `grid` lines, or a `floor` with soft shadows, which"
        " also darkens corners where light does not get.",
    )
    background: Literal["white", "grey", "dark", "transparent"] = Field(
        default="white", description="Behind everything; `transparent` for stills only."
    )
    shading: Literal["smooth", "flat"] = Field(
        default="smooth", description="Smooth over the facets, or each as it is."
    )
    mesh: Literal["hidden", "shown"] = Field(
        default="hidden", description="Edges of the triangles of shells."
    )
    joints: Literal["hidden", "shown"] = Field(
        default="hidden",
        description="Balls where bodies are joined: dark where bending passes, pale at hinges.",
    )
    contacts: Literal["hidden", "shown"] = Field(
        default="hidden",
        description="Arrows for the forces of contact on the nodes, the longest for the largest of the run;"
        " `contact_force` must be among `fields`.",
    )
    ghosts: Annotated[tuple[Time, ...], Len(0, 50), Strict(False)] = Field(
        default=(), description="Times of earlier shapes that stay in the picture, pale."
    )
    trails: Annotated[tuple[SelectedNodes, ...], Len(0, 50), Strict(False)] = Field(
        default=(), description="Nodes that leave a line."
    )
    plots: Annotated[tuple[Name, ...], Strict(False)] = Field(
        default=(), description="Names of probes drawn over time."
    )

    @property
    def stills(self) -> bool:
        """Whether single pictures are asked for."""
        return self.still or bool(self.times)
