"""Who may touch whom, and what happens then."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from annotated_types import Len
from pydantic import Field, Strict, model_validator

from ..values.quantity import Quantity, TwoNames
from ..values.spec import Spec, problem

Coefficient: TypeAlias = Annotated[float, Quantity("ratio", ge=0)]


class ContactPair(Spec):
    """Two that may touch each other; a body named twice may touch itself."""

    between: TwoNames = Field(description="Names of two bodies, or of a body and an obstacle.")
    friction: Coefficient | None = Field(
        default=None, description="Coefficient of friction of this pair; default: that of `contact.friction`."
    )


class PenaltyLaw(Spec):
    """Bodies push each other apart as far as they overlap: a force 2 kappa delta per length of rod.

    Takes a tolerance or a stiffness, by default a tolerance of 5 %.
    """

    type: Literal["penalty"] = Field(default="penalty", description="Kind of law.")
    tolerance: Annotated[float, Quantity("ratio", gt=0, le=0.5)] | None = Field(
        default=None,
        description="Penetration that is allowed, as a share of the thickness. The stiffness follows from "
        "the weights and impacts that must be carried, and is changed between steps.",
    )
    stiffness: Annotated[float, Quantity("pressure", gt=0)] | None = Field(
        default=None, description="kappa, whatever the penetration then is; of a rod per length."
    )
    core: Literal["auto", "on", "off"] = Field(
        default="auto",
        description="A barrier from three quarters to half of the distance at which things touch: it holds "
        "where the stiffness falls short. `auto` has it where shells are touched.",
    )

    @model_validator(mode="after")
    def _one(self) -> PenaltyLaw:
        if self.tolerance is not None and self.stiffness is not None:
            raise problem("takes a tolerance or a stiffness, not both")
        return self

    @property
    def allowed(self) -> float | None:
        """The tolerance that decides on the stiffness; None where that is given."""
        if self.stiffness is not None:
            return None
        return 0.05 if self.tolerance is None else self.tolerance

    @property
    def reach(self) -> float:
        """Distance at which forces begin, as a share of that at which surfaces touch."""
        return 1.0


class BarrierLaw(Spec):
    """Nothing ever comes nearer than `stop`, at whatever stiffness; the force begins at `gap` before that.

    The outer half of the gap bears weights and impacts, as soft as may be; below it the energy grows without
    bounds.
    """

    type: Literal["barrier"] = Field(description="Kind of law.")
    gap: Annotated[float, Quantity("ratio", gt=0, le=0.5)] = Field(
        default=0.02, description="Distance from the stop on which forces act, as a share of the thickness."
    )
    stop: Annotated[float, Quantity("ratio", gt=0, le=1)] = Field(
        default=1.0,
        description="Distance that all keep, as a share of that at which surfaces touch. What starts nearer "
        "is refused.",
    )

    @property
    def reach(self) -> float:
        """Distance at which forces begin, as a share of that at which surfaces touch."""
        return self.stop + self.gap

    @property
    def allowed(self) -> float:
        """How deep lines may come, as a share of the reach: above the barrier, at obstacles too.

        There half of the thickness makes the gap.
        """
        return 0.25 * self.gap / self.reach


class CompatLaw(Spec):
    """The law of the DisMech family, to compare with its data.

    Every pair of edges, of nodes and triangles, and of nodes and planes has a force of its own, so that it
    depends on the mesh. A family that scales lengths by h and has an energy k_c in joules has k = k_c / h^2.
    """

    type: Literal["compat"] = Field(description="Kind of law.")
    stiffness: Annotated[float, Quantity("force per length", gt=0)] = Field(
        description="k of each pair: a force 2 k times the depth."
    )
    width: Annotated[float, Quantity("length", gt=0)] = Field(
        description="Distance before touching at which the force sets in (delta); deeper than as much it is "
        "all but linear."
    )
    normal_force: Literal["implicit", "lagged"] = Field(
        default="implicit",
        description="What friction goes by: the normal force of the moment, or that at the end of the last "
        "step, which errs by as much as it changes in a step.",
    )

    @property
    def reach(self) -> float:
        """Distance at which surfaces touch."""
        return 1.0


Law: TypeAlias = Annotated[PenaltyLaw | BarrierLaw | CompatLaw, Field(discriminator="type")]


class FrictionLaw(Spec):
    """Coulomb friction, full from a small slip speed on and smooth below: there bodies creep."""

    coefficient: Coefficient = Field(description="Coefficient of friction, the same at rest and in motion.")
    slip_speed: Annotated[float, Quantity("velocity", gt=0)] = Field(
        default=1e-3, description="Speed from which on friction is full; what should stick creeps below it."
    )
    tangent: Literal["auto", "full", "symmetric"] = Field(
        default="auto",
        description="What Newton's method is told of friction: `full` converges in fewer iterations, "
        "`symmetric` keeps the matrix symmetric, which large scenes factorise in half the time. `auto` takes "
        "it where bodies touch each other, and `full` where they touch obstacles only.",
    )

    stick: Literal["creeping", "anchored"] = Field(
        default="creeping",
        description="What holds below the threshold: friction at a small speed, or anchors that are dragged "
        "behind, where nothing creeps.",
    )
    slip_length: Annotated[float, Quantity("length", gt=0)] | None = Field(
        default=None,
        description="Way from the anchor on which friction becomes full; default: a thousandth of the least "
        "thickness.",
    )

    @model_validator(mode="after")
    def _anchored(self) -> FrictionLaw:
        if self.slip_length is not None and self.stick != "anchored":
            raise problem("'slip_length' has a meaning with stick: anchored only")
        return self


class Contact(Spec):
    """Contact of bodies with each other and with obstacles."""

    pairs: Annotated[tuple[ContactPair, ...], Len(1, 10_000), Strict(False)] | None = Field(
        default=None,
        description="Who may touch whom; default: every body every other, itself and every obstacle.",
    )
    law: Law = Field(
        default=PenaltyLaw.unsaid(), description="How they push each other apart; `penalty` without a `type`."
    )
    friction: FrictionLaw | None = Field(default=None, description="How they rub; default: not at all.")

    @model_validator(mode="before")
    @classmethod
    def _penalty(cls, value: Any) -> Any:
        law = value.get("law") if isinstance(value, Mapping) else None
        if not isinstance(law, Mapping) or "type" in law:
            return value
        return {**value, "law": {"type": "penalty", **law}}
