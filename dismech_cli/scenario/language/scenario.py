"""The whole scenario."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any, Final, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.quantity import FileName, Name
from ..values.spec import Spec
from .actuation import Actuation
from .calibrate import Calibrate
from .contact import Contact
from .control import Controller
from .expect import Expectation
from .force import Force
from .geometry import Body, Rod, Shell
from .imperfection import Imperfection
from .initial import Initial
from .joint import Joints
from .mass import PointMass
from .material import Material
from .motion import InitialVelocity, Motion
from .numerics import Numerics
from .obstacle import Obstacle
from .output import Output
from .sensor import Sensor
from .study import Study
from .sweep import Sweep

SCHEMA_VERSION: Final = 1

CONTACT_INTEGRATOR: Final = MappingProxyType({"type": "generalized_alpha", "spectral_radius": 0.0})
"""The integrator of scenes with contact that name none."""

BARRIER_INTEGRATOR: Final = MappingProxyType({"type": "implicit_euler"})
"""That of scenes whose contact is a barrier: impacts stop within small parts of a step."""

# A name becomes a folder: no separators, no leading dot, no trailing dot, no device names.
SafeName: TypeAlias = Annotated[
    str, Field(max_length=100, pattern=r"^[A-Za-z0-9_]([A-Za-z0-9._-]*[A-Za-z0-9_-])?$")
]
Bodies: TypeAlias = Annotated[tuple[Body, ...], Len(1, 10_000), Strict(False)]


class Scenario(Spec):
    """What the user said: a scene, how to step it, what to write. All numbers are SI."""

    schema_version: Literal[1] = Field(description="Version of this language.")
    name: SafeName = Field(description="Name of the scenario and of the folder of its results.")
    description: str = Field(default="", description="A sentence or two.")
    include: Annotated[tuple[FileName, ...], Strict(False)] = Field(
        default=(), description="Files merged beneath this one, relative to it; later over earlier."
    )
    profiles: dict[Literal["draft", "normal", "accurate"], dict[str, Any]] = Field(
        default={}, description="Partial mappings that replace the built-in profiles, merged over the file."
    )
    parameters: dict[str, Any] = Field(
        default={},
        description="Numbers with units by name, which values are computed from as `$name`: a value, or a "
        "mapping under [Parameter](#parameter).",
    )
    dimension: Literal[2, 3] = Field(default=3, description="2 for a planar scene.")
    plane: Literal["xz", "xy", "yz"] = Field(default="xz", description="Plane of a planar scene.")
    materials: dict[Name, Material] = Field(description="Materials by name.")
    geometry: Bodies = Field(description="Bodies.")
    joints: Joints = Field(
        default=(), description="Joints between bodies; `auto` joins all whose nodes coincide."
    )
    motions: Annotated[tuple[Motion, ...], Strict(False)] = Field(
        default=(), description="What is held or driven."
    )
    masses: Annotated[tuple[PointMass, ...], Strict(False)] = Field(
        default=(), description="Point masses on nodes, beside those of the bodies."
    )
    forces: Annotated[tuple[Force, ...], Strict(False)] = Field(default=(), description="Loads.")
    actuation: Annotated[tuple[Actuation, ...], Strict(False)] = Field(
        default=(), description="Natural strains that change in time."
    )
    sensors: dict[Name, Sensor] = Field(default={}, description="What controllers read, by name.")
    controllers: dict[Name, Controller] = Field(
        default={}, description="What commands natural strains, by name; `actuation` says which."
    )
    initial: Initial | None = Field(
        default=None, description="Where the run starts; default: at rest, in the rest shape."
    )
    obstacles: Annotated[tuple[Obstacle, ...], Len(0, 1_000), Strict(False)] = Field(
        default=(), description="Rigid bodies in the way; `contact` says who touches them."
    )
    contact: Contact | None = Field(default=None, description="Contact and friction; default: none.")
    initial_velocity: Annotated[tuple[InitialVelocity, ...], Strict(False)] = Field(
        default=(), description="Velocities at t = 0; everything else starts at rest, or as `initial` says."
    )
    imperfection: Imperfection | None = Field(
        default=None, description="A small deviation of the shape of the bodies; default: none."
    )
    numerics: Numerics = Field(description="Time stepping and solvers.")
    output: Output = Field(default=Output.unsaid(), description="Results.")
    expect: dict[Name, Expectation] = Field(
        default={}, description="Numbers that the run must give, by name."
    )
    study: Study | None = Field(default=None, description="What `dismech study` tries; no part of a run.")
    sweep: Sweep | None = Field(default=None, description="What `dismech sweep` varies; no part of a run.")
    calibrate: Calibrate | None = Field(
        default=None, description="What `dismech calibrate` fits to what; runs do not know of it."
    )

    @model_validator(mode="before")
    @classmethod
    def _default_integrator(cls, data: Any) -> Any:
        """Impacts must not make energy, and frames must not lie within others: see docs/contact.md."""
        if not isinstance(data, Mapping) or data.get("contact") is None:
            return data
        numerics = data.get("numerics")
        if not isinstance(numerics, Mapping) or "integrator" in numerics:
            return data
        contact = data["contact"]
        law = contact.get("law") if isinstance(contact, Mapping) else None
        barrier = isinstance(law, Mapping) and law.get("type") == "barrier"
        integrator = BARRIER_INTEGRATOR if barrier else CONTACT_INTEGRATOR
        return {**data, "numerics": {**numerics, "integrator": dict(integrator)}}

    @model_validator(mode="before")
    @classmethod
    def _strains_of_controllers(cls, data: Any) -> Any:
        """A controller's quantities are those of the strain that the actuation under it drives."""
        if not isinstance(data, Mapping) or not isinstance(data.get("controllers"), Mapping):
            return data
        strains = dict(_commanded(data.get("actuation")))
        told = {
            name: {**one, "strain": strains[name]}
            if isinstance(one, Mapping) and "strain" not in one and name in strains
            else one
            for name, one in data["controllers"].items()
        }
        return {**data, "controllers": told}

    @property
    def rods(self) -> dict[int, Rod]:
        """The rods by their place in ``geometry``."""
        return {index: body for index, body in enumerate(self.geometry) if isinstance(body, Rod)}

    @property
    def shells(self) -> dict[int, Shell]:
        """The shells by their place in ``geometry``."""
        return {index: body for index, body in enumerate(self.geometry) if isinstance(body, Shell)}


def _commanded(actuation: Any) -> Iterator[tuple[str, str]]:
    """Names of the controllers that entries of ``actuation`` as written follow, and what they drive."""
    for one in actuation if isinstance(actuation, list | tuple) else ():
        value = one.get("value") if isinstance(one, Mapping) else None
        name = value.get("controlled_by") if isinstance(value, Mapping) else None
        if isinstance(name, str) and isinstance(one.get("type"), str):
            yield name, one["type"]
