"""What `dismech study` measures: quantities, and what trades speed for accuracy."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal, TypeAlias

from annotated_types import Len
from pydantic import Discriminator, Field, Strict, Tag, field_validator

from ..text.tree import describe
from ..values.quantity import Name, Quantity
from ..values.spec import Spec, problem
from .sweep import amount

MAX_LEVELS: Final = 12

Norm: TypeAlias = Literal["max", "rms", "last", "mean", "period"]


class Measured(Spec):
    """A quantity whose error counts: a probe of `output.probes`, as a course or as a number; or the shape."""

    probe: Name = Field(
        description="Name of the probe. `shape`, if none has that name, is that of everything: root mean "
        "square over all nodes, in the frames of the run."
    )
    norm: Norm = Field(
        default="max",
        description="`max` and `rms`: error of the course over time, as a share of its range; `last` and "
        "`mean`: of a number, as a share of that range; `period`: of the period, as a share of itself.",
    )
    value: float | None = Field(
        default=None,
        description="The right number in SI units, where it is known; only with `last`, `mean` and `period`.",
    )

    @field_validator("value")
    @classmethod
    def _of_a_number(cls, value: float | None, info: Any) -> float | None:
        if value is not None and info.data.get("norm", "max") in ("max", "rms"):
            raise problem("only a number has a right value: take 'norm: last', 'mean' or 'period'")
        return value


class Levels(Spec):
    """Levels of refinement, the coarsest first.

    Each is finer by `factor`: times, tolerances and other quantities are divided by it, whole numbers
    multiplied; of `nodes` it is the segments between them.
    """

    from_: Any = Field(alias="from", description="The coarsest: a number, or a quantity such as `10 ms`.")
    levels: Annotated[int, Field(ge=2, le=MAX_LEVELS)] = Field(default=4, description="How many.")
    factor: Annotated[float, Field(gt=1, le=10)] = Field(default=2.0, description="From one to the next.")

    @field_validator("from_")
    @classmethod
    def _above_zero(cls, value: Any) -> Any:
        if amount(value)[0] <= 0.0:
            raise problem(f"expected something above zero, got {describe(value)}")
        return value


def _form(value: Any) -> str:
    return "list" if isinstance(value, list | tuple) else "levels"


Axis: TypeAlias = Annotated[
    Annotated[Annotated[tuple[Any, ...], Len(1, 20), Strict(False)], Tag("list")]
    | Annotated[Levels, Tag("levels")],
    Discriminator(_form),
]


class Study(Spec):
    """What speed costs in accuracy: see `dismech study`.

    Keys of `over` are key paths as `--set` takes them. A mapping refines: at most one key refines time
    (`numerics.dt`, `numerics.step.rtol`, `numerics.integrator.load_steps`), all others the mesh, together.
    A list gives alternatives.
    """

    quantities: Annotated[dict[Name, Measured], Field(min_length=1)] | None = Field(
        default=None,
        description="Whose errors count, the largest of them; default: every probe, or the shape if there is "
        "none.",
    )
    over: Annotated[dict[str, Axis], Field(min_length=1)] | None = Field(
        default=None, description="What is tried; default: five levels from four times `numerics.dt` on."
    )
    target: Annotated[float, Quantity("ratio", gt=0, lt=1)] = Field(
        default=0.02, description="The largest error allowed."
    )
    reference: Literal["levels", "finest"] = Field(
        default="levels",
        description="How errors are known where no `value` is given: from differences between `levels`, with "
        "a margin; or as distances from the `finest` run, which counts as right: that of the first "
        "alternatives.",
    )
