"""What a scenario would build, and what running it would cost."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Final

import numpy as np

from ..compose.bodies.geometry import Geometry
from ..compose.compose import Composition, compose
from ..compose.sizes import memory
from ..compose.structure.kernels import alone
from ..compose.structure.plan import Decision
from ..control.plugin import load_plugins
from ..frozen import frozen
from ..kinematics.motion import held_dofs
from ..output.frame import Topology
from ..output.jsonable import Json, to_json
from ..scenario.language.numerics import Numerics
from ..scenario.load import load
from ..scenario.text.parameters import Parameter
from ..scenario.views.provenance import as_json
from ..solve.system import base_outline, chosen_solver
from .duration import iteration_time, seconds, work_of
from .joints import JointLine, joint_lines
from .loops import look_at_loops, nominal_step
from .modes import Modes, find_modes

_SHOWN: Final = 20  # bodies, and joints, that are listed where a person reads


@frozen(kw_only=True)
class Cost:
    """Size and rough price of a run.

    Attributes:
        dofs: Degrees of freedom.
        free: Those that Newton solves for at the start.
        entries: Stored entries of the matrix.
        solver: Linear solver.
        steps: Nominal time steps.
        adaptive: Whether that is a guess: steps adapt.
        iterations: Newton iterations that a step usually takes.
        frames: Frames written.
        seconds: Rough wall time [s].
        memory: Peak of the process [byte], within a factor of 1.5; pictures are drawn by another.
        disk: Bytes of all frames in the run file.
    """

    dofs: int
    free: int
    entries: int
    solver: str
    steps: int
    adaptive: bool
    iterations: float
    frames: int
    seconds: float
    memory: float
    disk: float


@frozen(kw_only=True)
class Extent:
    """Size of a body at rest: whether it was meant in metres shows here.

    Attributes:
        name: The body.
        edges: Number of rod edges.
        triangles: Number of triangles.
        size: Lengths of its bounding box [m].
        mass: Of its material [kg].
    """

    name: str
    edges: int
    triangles: int
    size: tuple[float, float, float]
    mass: float

    def __str__(self) -> str:
        cells = f"{self.triangles} triangles" if self.triangles else f"{self.edges} edges"
        x, y, z = (f"{length:.3g}" for length in self.size)
        return f"{self.name}: {cells}, {x} x {y} x {z} m, {self.mass:.3g} kg"


@frozen
class Finding:
    """A scenario that could run.

    Attributes:
        path: Its file, as given.
        bodies: Their sizes.
        notes: What was made of its meshes.
        joints: What joins them, and what passes.
        decisions: The plan with its reasons.
        warnings: Implausible values.
        parameters: Of the scenario, by name.
        cost: Size and price.
        loops: Gains of sampled controllers.
        modes: Slowest and fastest swing; None where they are not known.
    """

    path: Path
    bodies: tuple[Extent, ...]
    notes: tuple[str, ...]
    joints: tuple[JointLine, ...]
    decisions: tuple[Decision, ...]
    warnings: tuple[str, ...]
    parameters: Mapping[str, Parameter]
    cost: Cost
    modes: Modes | None = None
    loops: tuple[str, ...] = ()

    def as_json(self) -> dict[str, Json]:
        """For programs."""
        return {
            "scenario": str(self.path),
            "ok": True,
            "bodies": to_json([asdict(body) for body in self.bodies]),
            "notes": list(self.notes),
            "joints": to_json([asdict(joint) for joint in self.joints]),
            "parameters": as_json(self.parameters),
            "plan": to_json([asdict(decision) for decision in self.decisions]),
            "loops": list(self.loops),
            "warnings": list(self.warnings),
            "cost": to_json(asdict(self.cost)),
            "modes": None if self.modes is None else to_json(asdict(self.modes)),
        }

    def __str__(self) -> str:
        c = self.cost
        return "\n".join(
            [
                f"{self.path}: ok",
                *(f"  parameter {name} = {one.amount}" for name, one in self.parameters.items()),
                *_first(self.bodies, "bodies"),
                *(f"  {note}" for note in self.notes),
                *_first(self.joints, "joints"),
                *(f"  {d.what}\n    because: {d.why}" for d in self.decisions),
                *(f"  {loop}" for loop in self.loops),
                f"  {c.free} free of {c.dofs} DOFs, {c.entries} matrix entries, {c.solver} solver",
                *([] if self.modes is None else [f"  {self.modes}"]),
                f"  {'about ' if c.adaptive else ''}{c.steps} steps, {c.frames} frames, about "
                f"{c.iterations:.2g} Newton iterations per step",
                f"  about {_duration(c.seconds)}, {_bytes(c.memory)} of memory, {_bytes(c.disk)} on disk",
            ]
        )


def _first(items: Sequence[object], kind: str) -> Iterator[str]:
    """A line for each item, as long as they are few enough to be read."""
    yield from (f"  {item}" for item in items[:_SHOWN])
    if len(items) > _SHOWN:
        yield f"  and {len(items) - _SHOWN} more {kind}: all are listed by --json"


def inspect(
    path: Path,
    *,
    overrides: tuple[str, ...],
    profile: str | None,
    allow_outside: bool,
    plugins: tuple[Path, ...] = (),
) -> Finding:
    """Read and build a scenario; step nothing but the first period of controllers.

    Raises:
        ScenarioError: It cannot be read or built, or a controller cannot be stable.
    """
    loaded = load(path, overrides=overrides, profile=profile, allow_outside=allow_outside)
    composition = compose(loaded, plugins=load_plugins(plugins), repays=alone)
    loops = look_at_loops(composition.simulation, nominal_step(loaded.scenario.numerics))
    for loop in loops:
        if loop.error:
            raise loaded.error(("controllers", loop.name), loop.error)
    doubtful = tuple(loop.warning for loop in loops if loop.warning)
    warnings = (*loaded.warnings, *composition.plan.warnings, *doubtful)
    decisions, numerics = composition.plan.decisions, loaded.scenario.numerics
    return Finding(
        path,
        extents(composition.geometry),
        composition.geometry.notes,
        joint_lines(composition.geometry, planar=loaded.scenario.dimension == 2),
        decisions,
        warnings,
        loaded.parameters,
        estimate(composition, numerics),
        find_modes(composition.simulation, None if numerics.adapts else numerics.dt),
        tuple(loop.text for loop in loops),
    )


def extents(geometry: Geometry) -> tuple[Extent, ...]:
    """Size and mass of every body."""
    edge_mass = geometry.per_edge("mass_per_length") * geometry.lengths
    triangle_mass = geometry.per_triangle("mass_per_area") * geometry.areas
    found = []
    for name, nodes in geometry.body_nodes.items():
        box = np.ptp(geometry.nodes[nodes], axis=0)
        x, y, z = np.where(box > 1e-9 * box.max(), box, 0.0).tolist()  # flat but for rounding
        edges = geometry.rod_edges.get(name, np.empty(0, dtype=np.int64))
        triangles = geometry.triangles_of(name) if name not in geometry.rod_edges else edges[:0]
        mass = float(edge_mass[edges].sum() + triangle_mass[triangles].sum())
        found.append(Extent(name=name, edges=len(edges), triangles=len(triangles), size=(x, y, z), mass=mass))
    return tuple(found)


def estimate(composition: Composition, numerics: Numerics) -> Cost:
    """Count what can be counted and guess the rest.

    Args:
        composition: What would be run.
        numerics: Of its scenario.
    """
    simulation = composition.simulation
    model, topology = simulation.model, simulation.topology
    pattern = base_outline(model, ~held_dofs(model.motions, model.dofs.n, 0.0))
    steps = simulation.control.steps
    end = simulation.control.t_end
    frames = steps + 1
    if simulation.frame_every > 0.0:
        frames = min(frames, int(end / simulation.frame_every * (1.0 + 1e-12)) + 1)
    solver = chosen_solver(model, pattern, simulation.linear_solver)
    plan = composition.plan
    look = 0.0 if plan.whole else iteration_time(simulation)
    work = work_of(composition, numerics)
    return Cost(
        dofs=model.dofs.n,
        free=pattern.m,
        entries=pattern.nnz,
        solver=solver,
        steps=steps,
        adaptive=numerics.adapts,
        iterations=work.iterations,
        frames=frames,
        seconds=seconds(work, plan.kernels, look, whole=plan.whole),
        memory=memory(model, plan.kernels, solver, pattern.nnz) + composition.neighbours,
        disk=8.0 * frames * _numbers_per_frame(topology),
    )


def _numbers_per_frame(topology: Topology) -> int:
    nodes, cells = len(topology.rest_positions), len(topology.edges) + len(topology.triangles)
    numbers = 3 * nodes + len(topology.scalars)
    for field in topology.fields:
        numbers += field.components * (nodes if field.location == "node" else cells)
    for shape, _ in topology.state.values():
        size = 1
        for length in shape:
            size *= length
        numbers += size
    return numbers


def _duration(seconds: float) -> str:
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.1g} s"


def _bytes(count: float) -> str:
    for unit, size in (("GB", 1e9), ("MB", 1e6)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{max(count / 1e3, 1.0):.3g} kB"
