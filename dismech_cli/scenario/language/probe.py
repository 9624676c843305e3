"""Single numbers read from the running model; a selection of several nodes is averaged."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, Tag, field_validator

from ..values.quantity import DirectionTriple, Index, Name, TwoNames
from ..values.selection import SelectedEdges, SelectedNodes, TwoPlaces
from ..values.spec import Spec, problem, tag, told_by_key
from .shape_file import ShapeFile

Component: TypeAlias = Literal["x", "y", "z", "magnitude"]


class DisplacementProbe(Spec):
    """Displacement from rest."""

    displacement: SelectedNodes = Field(description="Nodes.")
    component: Component = Field(description="Component, or magnitude.")


class PositionProbe(Spec):
    """Position."""

    position: SelectedNodes = Field(description="Nodes.")
    component: Component = Field(description="Component, or magnitude.")


class VelocityProbe(Spec):
    """Velocity."""

    velocity: SelectedNodes = Field(description="Nodes.")
    component: Component = Field(description="Component, or magnitude.")


class DistanceProbe(Spec):
    """Distance of two places."""

    distance: TwoPlaces = Field(description="The two places.")


class MeanPositionProbe(Spec):
    """Mean position of the nodes of a body."""

    mean_position: Name = Field(description="Name of the body.")
    component: Component = Field(description="Component, or magnitude.")


class EnergyProbe(Spec):
    """An energy; `error` is the drift of the energy balance, `friction` what that has turned into heat."""

    energy: Literal["kinetic", "elastic", "gravitational", "contact", "friction", "total", "error"] = Field(
        description="Which one."
    )


class ReactionProbe(Spec):
    """Sum of the forces that hold the selected nodes; of a clamp `at: edge`, those on its whole edge."""

    reaction: SelectedNodes = Field(description="Held nodes.")
    component: Component = Field(description="Component, or magnitude.")


class TwistProbe(Spec):
    """Rotation of an edge about the rod, from rest."""

    twist: SelectedEdges = Field(description="An edge: the end of a rod, or one of its edges.")


class TurnProbe(Spec):
    """Angle between an edge and its direction at rest, 0 to 180 deg: at a rod's end, its slope."""

    turn: SelectedEdges = Field(description="An edge: the end of a rod, or one of its edges.")


class BendProbe(Spec):
    """How much a line through nodes of a body is bent: the mean of 2 tan(turn / 2) where it turns."""

    bend: Name = Field(description="Name of the body.")
    nodes: Annotated[tuple[Index, ...], Len(3), Strict(False)] = Field(
        description="Its nodes along the line, counted from 0; as of markers that are seen."
    )
    about: DirectionTriple = Field(description="Direction about which a turn counts as positive.")

    @field_validator("nodes", mode="after")
    @classmethod
    def _onwards(cls, nodes: tuple[int, ...]) -> tuple[int, ...]:
        twice = next((a for a, b in pairwise(nodes) if a == b), None)
        if twice is not None:
            raise problem(f"a line goes from node to node, but {twice} follows {twice}")
        return nodes


class LoadFactorProbe(Spec):
    """The load factor: the time of a static run, or the unknown of its path; static only."""

    load_factor: Literal[True] = Field(description="True.")


class ContactProbe(Spec):
    """How two bodies, or a body and an obstacle, touch; forces are those on the first."""

    contact: TwoNames = Field(description="Names of the two; a pair of `contact`.")
    measure: Literal["force", "normal", "friction", "load", "places", "depth"] = Field(
        description="`force` is the sum of `normal` and `friction` forces, `load` the sum of the magnitudes "
        "of normal forces, `places` the number of edges that touch, `depth` the deepest penetration as a "
        "share of the thickness."
    )
    component: Component = Field(
        default="magnitude", description="Component of a force, or magnitude; the others have none."
    )


class SensorProbe(Spec):
    """What a sensor would read without noise and delay, over all places where it reads."""

    sensor: Name = Field(description="Name of the sensor.")
    measure: Literal["mean", "rms", "max", "min"] = Field(
        default="mean", description="Over its places: `rms` is the root of the mean square."
    )


class ControlProbe(Spec):
    """How a controller does now: over all that it commands."""

    controller: Name = Field(description="Name of the controller.")
    measure: Literal["error", "command", "reading"] = Field(
        description="`error` is the target less the strain there is, `reading` that strain without noise or "
        "delay; `command` what is added to the natural strain."
    )
    over: Literal["rms", "max"] = Field(
        default="rms", description="Root of the mean square, or the largest size, over its places."
    )


class ShapeProbe(Spec):
    """Root mean square of the distances between the nodes of a body and where they shall be."""

    shape: Name = Field(description="Name of the body.")
    target: ShapeFile = Field(description="Where its nodes shall be.")


class StabilityProbe(Spec):
    """Number of negative eigenvalues of the stiffness: 0 for a stable equilibrium; static only."""

    negative_eigenvalues: Literal[True] = Field(description="True.")


Probe: TypeAlias = Annotated[
    Annotated[DisplacementProbe, Tag(tag("displacement"))]
    | Annotated[PositionProbe, Tag(tag("position"))]
    | Annotated[VelocityProbe, Tag(tag("velocity"))]
    | Annotated[DistanceProbe, Tag(tag("distance"))]
    | Annotated[MeanPositionProbe, Tag(tag("mean_position"))]
    | Annotated[EnergyProbe, Tag(tag("energy"))]
    | Annotated[ReactionProbe, Tag(tag("reaction"))]
    | Annotated[TwistProbe, Tag(tag("twist"))]
    | Annotated[TurnProbe, Tag(tag("turn"))]
    | Annotated[BendProbe, Tag(tag("bend"))]
    | Annotated[LoadFactorProbe, Tag(tag("load_factor"))]
    | Annotated[ContactProbe, Tag(tag("contact"))]
    | Annotated[SensorProbe, Tag(tag("sensor"))]
    | Annotated[ControlProbe, Tag(tag("controller"))]
    | Annotated[ShapeProbe, Tag(tag("shape"))]
    | Annotated[StabilityProbe, Tag(tag("negative_eigenvalues"))],
    told_by_key(
        "displacement",
        "position",
        "velocity",
        "distance",
        "mean_position",
        "energy",
        "reaction",
        "twist",
        "turn",
        "bend",
        "load_factor",
        "contact",
        "sensor",
        "controller",
        "shape",
        "negative_eigenvalues",
    ),
]


def quantity_of(probe: Probe) -> str:
    """What a probe measures: a key of :data:`.units.KINDS`."""
    match probe:
        case VelocityProbe():
            return "velocity"
        case EnergyProbe():
            return "energy"
        case ReactionProbe():
            return "force"
        case TwistProbe() | TurnProbe():
            return "angle"
        case ContactProbe(measure="places" | "depth"):
            return "ratio"
        case ContactProbe():
            return "force"
        case StabilityProbe() | LoadFactorProbe() | BendProbe():
            return "ratio"
        case SensorProbe() | ControlProbe():
            return "strain"
        case DisplacementProbe() | PositionProbe() | DistanceProbe() | MeanPositionProbe() | ShapeProbe():
            return "length"
