"""What ``--json`` prints: the contract with scripts, as a schema that the tests hold the program to."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

Number: TypeAlias = float | Literal["nan", "inf", "-inf"]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class Fault(_Strict):
    """Why something did not end well; null where there is no such place."""

    file: str | None
    line: int | None
    column: int | None
    key: str | None
    message: str


class Expectation(_Strict):
    """An entry of ``expect:``, judged; both numbers in ``unit``."""

    name: str
    measured: Number
    expected: Number
    tolerance: str
    unit: str
    source: str
    passed: bool


class Parameter(_Strict):
    """A parameter of the scenario: its value in SI units, and where that was written."""

    value: int | float
    unit: str = Field(description="Empty for a number without one.")
    origin: str


class Penetration(_Strict):
    """The deepest of a run so far: as a share of the thickness, of whom, where and when [s]."""

    share: float
    between: list[str]
    near: str
    t: float


class Run(_Strict):
    """``run`` and ``resume`` of a run that began, however it ended."""

    run_dir: str
    status: Literal["done", "failed", "interrupted"]
    exit_code: int
    message: str
    errors: list[Fault] = Field(description="Empty if the exit code is 0.")
    counters: dict[str, int] = Field(description="Steps, Newton iterations and more; empty if none was made.")
    seconds: dict[str, float] = Field(description="Wall time by phase.")
    expectations: list[Expectation] = Field(description="Empty if the run did not come to its end.")
    probes: dict[str, Number] = Field(description="Each of output.probes in the last frame.")
    energy_error: Number | None = Field(description="Of the last frame in J; null if none was written.")
    penetration: Penetration | None = Field(description="The deepest; null if nothing touched.")
    overrides: list[str] = Field(description="The --set arguments.")
    parameters: dict[str, Parameter] = Field(description="Of the scenario, by name.")
    versions: dict[str, str] = Field(description="Of Python and the libraries.")
    pictures: list[str] = Field(description="Files drawn.")


class Extent(_Strict):
    """Size of a body at rest [m], and its mass [kg]."""

    name: str
    edges: int
    triangles: int
    size: tuple[float, float, float] | list[float]
    mass: float


class Decision(_Strict):
    """One line of the plan."""

    what: str
    why: str


class Cost(_Strict):
    """Size and rough price of a run: s of wall time, bytes of memory and disk."""

    dofs: int
    free: int
    entries: int
    solver: str
    steps: int
    adaptive: bool = Field(description="Whether the number of steps is a guess.")
    iterations: float = Field(description="Newton iterations that a step usually takes.")
    frames: int
    seconds: float
    memory: float
    disk: float


class Modes(_Strict):
    """Swings at the start: periods in s, shares kept; null where steps adapt."""

    slowest: float
    fastest: float
    step: float | None
    kept: float | None = Field(description="Of the slowest swing after a period.")
    late: float | None = Field(description="By how much its period is too long, as a share.")
    kept_fastest: float | None = Field(description="Of the fastest swing after a step.")


class Joint(_Strict):
    """What joins bodies at one node or several: where [m], what passes, and how far apart they were [m]."""

    source: str = Field(description="`joints[0]` and the like, `mesh file`, or `mesh` for branches of a rod.")
    members: list[str]
    nodes: int
    at: list[float]
    passes: list[Literal["force", "bending", "twist"]]
    gap: float


class Checked(_Strict):
    """A scenario of ``check`` that could run."""

    scenario: str
    ok: Literal[True]
    bodies: list[Extent]
    notes: list[str]
    joints: list[Joint]
    parameters: dict[str, Parameter]
    plan: list[Decision]
    loops: list[str]
    warnings: list[str]
    cost: Cost
    modes: Modes | None = Field(description="Swings at the start; null where they are not known.")


class Refused(_Strict):
    """A scenario of ``check`` that could not."""

    scenario: str
    ok: Literal[False]
    error: str = Field(description="All faults as one text.")
    errors: list[Fault]


class SweptSetting(_Strict):
    """A value that a point sets: as written, and in SI units where it is a number."""

    text: str
    value: Any
    unit: str


class PointResult(_Strict):
    """How a point ended."""

    status: Literal["done", "failed", "timeout", "broken"]
    exit_code: int
    message: str
    expectations: list[Expectation]
    probes: dict[str, Number]
    counters: dict[str, int]
    cpu: float = Field(description="CPU time in s.")
    wall: float = Field(description="Wall time in s.")


class SweptPoint(_Strict):
    """A point of a sweep; without a result it is still to be run."""

    id: str = Field(description="The name of its folder.")
    settings: dict[str, SweptSetting]
    result: PointResult | None


class Swept(_Strict):
    """``sweep``, however it ended."""

    sweep_dir: str
    exit_code: int = Field(description="The largest of all points; 130 where some have no result.")
    message: str
    errors: list[Fault] = Field(description="Empty if the exit code is 0.")
    counts: dict[str, int]
    points: list[SweptPoint]
    files: list[str] = Field(description="Tables and report.")


class FieldDifference(_Strict):
    """One quantity of two runs; ``greatest``, ``rms`` and ``scale`` in ``unit``."""

    name: str
    unit: str
    greatest: Number = Field(description="Over all shared times and all places; of vectors, the length.")
    rms: Number
    scale: float = Field(description="Size of the quantity, to which relative tolerances refer.")
    relative: Number
    tolerance: float
    tolerance_kind: Literal["relative", "absolute"]
    within: bool
    t: float = Field(description="When it is greatest, in s.")
    place: str = Field(description="Where; empty for a scalar.")


class Compared(_Strict):
    """``compare``."""

    runs: list[str]
    exit_code: int
    times: int = Field(description="Times that both have.")
    differences: list[FieldDifference]
    notes: list[str] = Field(description="What could not be compared.")
    errors: list[Fault] = Field(description="Empty if the exit code is 0.")


class Slope(_Strict):
    """The derivative of a number to a value of the scenario, both in SI units."""

    by: str
    value: Number
    unit: str
    derivative: Number
    derivative_unit: str


class SlopeCheck(_Strict):
    """A directional derivative beside a difference of runs, and what curvature may have left in that."""

    gradient: Number
    difference: Number
    uncertainty: Number
    agrees: bool


class Gradient(_Strict):
    """What ``gradient`` found."""

    of: str
    value: Number
    unit: str
    method: Literal["forward", "adjoint", "differences"]
    why: str | None = Field(description="Why there is no exact derivative; null if there is.")
    gradient: list[Slope]
    check: SlopeCheck | None = Field(description="Null where it was not asked for.")
    seconds: dict[str, float] = Field(description="Wall time of the run and of the derivatives.")


class FittedValue(_Strict):
    """A fitted value with its standard deviation, in SI units."""

    of: str
    unit: str
    start: Number
    value: Number
    deviation: Number
    at_bound: bool
    moved_far: bool = Field(description="By more than 3 deviations of what was known.")
    finer: Number | None = Field(
        description="Change at half the time step, in deviations; null if not asked."
    )


class FittedPart(_Strict):
    """How a marker or a probe of a table is met, in its unit: distances, or sizes of differences."""

    name: str
    mean: Number | None
    worst: Number | None
    held_out_mean: Number | None
    held_out_worst: Number | None


class FittedData(_Strict):
    """How a table of samples is met, in its unit."""

    file: str
    unit: str
    samples: int
    deviation: Number
    rms: Number
    worst: Number
    held_out_rms: Number | None
    scale: Number | None = Field(description="Of a picture, per metre; null otherwise.")
    parts: list[FittedPart] = Field(description="Each marker or probe; all probes of a row together.")


class Calibration(_Strict):
    """What ``calibrate`` found."""

    parameters: list[FittedValue]
    correlation: list[list[Number]]
    condition: Number
    unseen: list[list[Number]] = Field(description="Directions of the parameters that no sample sees.")
    chi2: Number = Field(description="Sum of squares per degree of freedom.")
    deviations_known: bool
    data: list[FittedData]
    cameras: list[list[Number] | None]
    evaluations: int
    runs: int
    message: str
    doubts: list[str]


class Failure(_Strict):
    """What ended before a run began or a check was through."""

    status: Literal["failed", "interrupted"]
    exit_code: int
    errors: list[Fault]


RUN: TypeAdapter[Run | Failure] = TypeAdapter(Run | Failure)
CHECK: TypeAdapter[list[Checked | Refused] | Failure] = TypeAdapter(list[Checked | Refused] | Failure)
SWEEP: TypeAdapter[Swept | list[SweptPoint] | Failure] = TypeAdapter(Swept | list[SweptPoint] | Failure)
"""With ``--dry-run`` the points alone."""
COMPARE: TypeAdapter[Compared | Failure] = TypeAdapter(Compared | Failure)

GRADIENT: TypeAdapter[Gradient | Failure] = TypeAdapter(Gradient | Failure)

CALIBRATION: TypeAdapter[Calibration | Failure] = TypeAdapter(Calibration | Failure)


def result_schema() -> dict[str, Any]:
    """JSON Schema by command."""
    run, check, sweep = RUN.json_schema(), CHECK.json_schema(), SWEEP.json_schema()
    return {
        "run": run,
        "resume": run,
        "check": check,
        "sweep": sweep,
        "compare": COMPARE.json_schema(),
        "gradient": GRADIENT.json_schema(),
        "calibrate": CALIBRATION.json_schema(),
    }
