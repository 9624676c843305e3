"""How the equations are stepped and solved."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import ConfigDict, Field, model_validator

from ..values.quantity import PositiveTime, Quantity
from ..values.spec import Spec, problem
from .load_path import LoadPath


class Static(Spec):
    """Equilibria under loads that grow over a pseudo-time from 0 to 1."""

    type: Literal["static"] = Field(description="Kind of integrator.")
    load_steps: Annotated[int, Field(ge=1, le=1_000_000)] | None = Field(
        default=None, description="Number of steps, all of one size; 10 by default. This or `path`."
    )
    method: Literal["newton", "relax"] = Field(
        default="newton",
        description="How an equilibrium is found. `relax` lets the robot move to rest as in a thick fluid: "
        "slower, and safe where nets, thin shells and slack strings buckle; it ends in the same equilibria, "
        "by the same criterion, and in stable ones.",
    )
    path: LoadPath | None = Field(
        default=None, description="Follows the path of equilibria instead, where the load falls too."
    )

    @model_validator(mode="after")
    def _one_way(self) -> Static:
        if self.load_steps is not None and self.path is not None:
            raise problem("give either 'load_steps' or 'path'; a path finds its own steps")
        if self.method == "relax" and self.path is not None:
            raise problem("give either 'method: relax' or 'path'; a path goes through unstable equilibria")
        return self

    @property
    def steps(self) -> int:
        """Steps of one size."""
        return self.load_steps or 10

    @property
    def end(self) -> float:
        """Load factor at the end, as far as it is known."""
        return 1.0 if self.path is None else self.path.load_factor


class ImplicitEuler(Spec):
    """First order, strongly damping."""

    type: Literal["implicit_euler"] = Field(description="Kind of integrator.")


class ImplicitMidpoint(Spec):
    """Second order, without numerical damping."""

    type: Literal["implicit_midpoint"] = Field(description="Kind of integrator.")


class Newmark(Spec):
    """The Newmark family; the defaults are the average acceleration method of second order."""

    type: Literal["newmark"] = Field(description="Kind of integrator.")
    beta: Annotated[float, Quantity("ratio", gt=0, le=0.5)] = Field(default=0.25, description="Weight beta.")
    gamma: Annotated[float, Quantity("ratio", ge=0.5, le=1)] = Field(default=0.5, description="Weight gamma.")


class GeneralizedAlpha(Spec):
    """Second order, with damping of fast modes of your choice."""

    type: Literal["generalized_alpha"] = Field(description="Kind of integrator.")
    spectral_radius: Annotated[float, Quantity("ratio", ge=0, le=1)] = Field(
        default=0.8, description="At infinite frequency: 1 damps nothing, 0 everything fast."
    )


class TrBdf2(Spec):
    """Second order in two stages, damping fast modes completely."""

    type: Literal["tr_bdf2"] = Field(description="Kind of integrator.")


Integrator: TypeAlias = Annotated[
    Static | ImplicitEuler | ImplicitMidpoint | Newmark | GeneralizedAlpha | TrBdf2,
    Field(discriminator="type"),
]


class Newton(Spec):
    """The nonlinear solver."""

    tolerance: Annotated[float, Quantity("ratio", gt=0, lt=1)] | None = Field(
        default=None,
        description="Relative size of the residual at which it stops; 1e-8 in statics, else 1e-5, which is "
        "far below the error of a time step, and in adaptive steps of what cannot touch a tenth of `rtol`, "
        "at most 1e-4.",
    )
    max_iterations: Annotated[int, Field(ge=1, le=10_000)] = Field(
        default=100,
        description="Factorisations before a step counts as failed. At most 20 iterations take full steps; "
        "what is left goes to a line search down the energy from the start of the step.",
    )
    projection: Literal["none", "indefinite"] | None = Field(
        default=None,
        description="What Newton does where the tangent has negative eigenvalues: `none` steps with it and "
        "may settle on an unstable balance; `indefinite` first clamps those of each stencil, so that statics "
        "go past buckling to a stable shape. By default `indefinite` where statics are driven by motions "
        "and where bodies touch, else `none`.",
    )


class Step(Spec):
    """How long steps are, and what happens when one fails or has several solutions, as a long step where
    something buckles."""  # noqa: D205, D209

    adaptive: bool | None = Field(
        default=None,
        description="Whether steps are as long as `rtol` allows; by default where `dt` is left out.",
    )
    rtol: Annotated[float, Quantity("ratio", gt=0, lt=1)] | None = Field(
        default=None,
        description="Error of an adaptive step as a share of the largest motion so far; default: 5e-4. "
        "What a run ends with is 10 to 100 times as much: see docs/trade.md.",
    )
    dt_min: PositiveTime | None = Field(
        default=None, description="Shortest adaptive step; default: `t_end` / 1e7."
    )
    dt_max: PositiveTime | None = Field(
        default=None, description="Longest adaptive step; default: `t_end` / 10."
    )
    max_cuts: Annotated[int, Field(ge=0, le=60)] = Field(
        default=10,
        description="How often a fixed dt may be halved before giving up; adaptive ones go to `dt_min`. A "
        "step with more than one solution that may not be halved is taken, and the run says so.",
    )
    patience: Annotated[int, Field(ge=1, le=10_000)] = Field(
        default=10,
        description="Newton iterations per stage of a dynamic step after which dt is halved instead of going "
        "on, as long as it may be: slow convergence is how a wrong root announces itself. Those in which "
        "friction turns round do not count, up to as many again.",
    )


_STATIC_HAS_NO_TIME: dict[str, Any] = {
    "if": {
        "required": ["integrator"],
        "properties": {
            "integrator": {"required": ["type"], "properties": {"type": {"const": "static"}}},
        },
    },
    "then": {"not": {"anyOf": [{"required": ["dt"]}, {"required": ["t_end"]}]}},
}


class Numerics(Spec):
    """How the equations are stepped and solved."""

    model_config = ConfigDict(json_schema_extra={"allOf": [_STATIC_HAS_NO_TIME]})

    integrator: Integrator = Field(
        default=TrBdf2.unsaid(type="tr_bdf2"),
        description="Time integrator; in scenes with `contact` by default `generalized_alpha` with "
        "`spectral_radius: 0`, and with a barrier `implicit_euler`.",
    )
    dt: PositiveTime | None = Field(
        default=None,
        description="Time step; where it is left out, steps are adaptive. Of adaptive steps the first one, "
        "and that after every jump of a law; default: `t_end` / 1000.",
    )
    t_end: PositiveTime | None = Field(default=None, description="End of the run; required unless static.")
    newton: Newton = Field(default=Newton.unsaid(), description="Nonlinear solver.")
    step: Step = Field(default=Step.unsaid(), description="Step control.")
    linear_solver: Literal["auto", "banded", "pardiso", "superlu", "dense"] = Field(
        default="auto", description="Linear solver; `auto` takes the fastest for the model."
    )
    kernels: Literal["auto", "numpy", "numba"] = Field(
        default="auto",
        description="How the kernels run, which changes the last digits alone. `auto` takes numba where it "
        "is installed and saves more than it takes to load and, if need be, to compile: once a kernel is "
        "compiled a run may end with other last digits than one before. `dismech check` and the manifest say "
        "what is taken and why, and a resumed run keeps it.",
    )

    @property
    def adapts(self) -> bool:
        """Whether steps are as long as a tolerance allows."""
        if isinstance(self.integrator, Static):
            return False
        return self.dt is None if self.step.adaptive is None else self.step.adaptive
