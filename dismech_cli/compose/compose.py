"""From a validated scenario to a simulation ready to step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..model.model import Model
from ..run.account import Roles
from ..run.clock import time_grid
from ..run.observe import scalar_columns
from ..run.simulation import Simulation
from ..scenario.language.motion import VelocityFile
from ..scenario.language.numerics import Static
from ..scenario.load import LoadedScenario
from ..scenario.text.tables import read_columns
from ..sections.shells import edge_lengths
from .bodies.geometry import Geometry, assemble_geometry
from .bodies.joints import weld_joints
from .bodies.selection import select_nodes
from .elastic.rod_drives import build_rod_elastic
from .elastic.rods import build_rods
from .elastic.shell_drives import build_shell_elastic
from .elastic.shells import build_shells
from .elastic.welds import build_shell_welds
from .laws import dynamic_laws, static_laws
from .loads.setting import Setting
from .loads.table import build_forces
from .numerics import build_driver, build_integrator, build_newton, check_linear_solver
from .observables.fields import Scene, build_fields, build_topology
from .observables.probes import build_probe
from .shells.topology import find_shell_edges
from .structure.holds import resolve_holds
from .structure.masses import mass_matrix, point_masses
from .structure.numbering import number_dofs
from .structure.plan import Plan, make_plan
from .structure.prescribed import build_motions, initial_velocity
from .structure.skeleton import make_skeleton


@dataclass(frozen=True, slots=True)
class Composition:
    """A simulation, the plan it follows, and the bodies it is of."""

    simulation: Simulation
    plan: Plan
    geometry: Geometry


def compose(
    loaded: LoadedScenario,
    kernels: str | None = None,
    planned: Callable[[Plan], None] = lambda plan: None,
) -> Composition:
    """Compose everything; steps nothing.

    Args:
        loaded: The scenario.
        kernels: Overrides the plan's choice of kernels: a resumed run keeps those it had.
        planned: Told the plan before anything is built, which may take long to compile.

    Raises:
        ScenarioError: The scenario cannot be composed; the message points to the key.
    """
    scenario = loaded.scenario
    static = isinstance(scenario.numerics.integrator, Static)
    laws = (static_laws if static else dynamic_laws)(loaded.directory)
    geometry = weld_joints(loaded, assemble_geometry(loaded))
    holds = resolve_holds(loaded, geometry, laws)
    plan = make_plan(loaded, geometry, holds, kernels)
    planned(plan)
    check_linear_solver(loaded)
    driver = build_driver(plan.kernels)
    skeleton = make_skeleton(geometry, holds)
    free = find_shell_edges(geometry)
    numbering = number_dofs(geometry, plan, skeleton, free)
    dofs = numbering.dofs
    rods = build_rods(loaded, geometry, plan, skeleton, numbering, driver)
    shells = build_shells(geometry, numbering, free, rods.frames, skeleton.positions, driver)
    elastic = (
        *build_rod_elastic(loaded, geometry, plan, skeleton, rods, laws),
        *build_shell_welds(loaded, geometry, skeleton, numbering, rods),
        *build_shell_elastic(loaded, geometry, free, shells, laws),
    )
    payload = point_masses(loaded, geometry, dofs.n_nodes)
    forces = build_forces(
        Setting(loaded, geometry, free, shells.normals, numbering, rods.frames, payload, laws)
    )
    sides = [edge_lengths(geometry.nodes, topology.edges) for topology in free.topologies.values()]
    model = Model(
        dofs=dofs,
        rest=numbering.rest,
        mass=np.zeros(dofs.n) if plan.static else mass_matrix(geometry, dofs, payload),
        terms=(*elastic, *forces.all),
        motions=build_motions(loaded, holds, skeleton, free, numbering),
        frames=shells.frames,
        driver=driver,
        length=float(np.median(np.concatenate((geometry.lengths, *sides)))),
    )
    scene = Scene(geometry, plan, skeleton, dofs, rods, free)
    fields = build_fields(loaded, scene)
    probes = {
        name: build_probe(loaded, geometry, skeleton, dofs, probe, ("output", "probes", name))
        for name, probe in scenario.output.probes.items()
    }
    watched = {
        name: build_probe(loaded, geometry, skeleton, dofs, e.probe, ("expect", name, "probe"))
        for name, e in scenario.expect.items()
    }
    roles = Roles(
        elastic=tuple(name for t in elastic for name in t.shares),
        gravitational=tuple(t.name for t in forces.gravitational),
        loads=tuple(t.name for t in forces.loads),
        dissipative=tuple(t.name for t in forces.dissipative),
    )
    grid, every = _times(loaded)
    simulation = Simulation(
        name=scenario.name,
        model=model,
        roles=roles,
        integrator=build_integrator(scenario.numerics.integrator),
        newton=build_newton(scenario.numerics.newton),
        linear_solver=scenario.numerics.linear_solver,
        grid=grid,
        frame_every=every,
        max_cuts=scenario.numerics.step.max_cuts,
        initial_velocity=initial_velocity(loaded, _velocities(loaded, geometry), numbering),
        topology=build_topology(scene, fields, scalar_columns(roles, probes)),
        fields=fields,
        probes=probes,
        watched=watched,
        places=_places(geometry),
    )
    return Composition(simulation, plan, geometry)


def _times(loaded: LoadedScenario) -> tuple[FloatArray, float]:
    """Nominal times of the run and the time between frames."""
    scenario = loaded.scenario
    numerics = scenario.numerics
    if isinstance(numerics.integrator, Static):
        return time_grid(1.0 / numerics.integrator.load_steps, 1.0), scenario.output.every or 0.0
    assert numerics.dt is not None
    assert numerics.t_end is not None
    releases = tuple(m.release for m in scenario.motions if m.release is not None)
    return time_grid(numerics.dt, numerics.t_end, releases), scenario.output.every or numerics.t_end / 100.0


def _velocities(loaded: LoadedScenario, geometry: Geometry) -> list[tuple[IntArray, FloatArray]]:
    out = []
    for index, entry in enumerate(loaded.scenario.initial_velocity):
        path = ("initial_velocity", index)
        nodes = select_nodes(loaded, geometry, entry.where, (*path, "where"))
        if isinstance(entry.velocity, VelocityFile):
            values = np.stack(
                read_columns(loaded.directory / entry.velocity.file, entry.velocity.columns), axis=1
            )
            if len(values) != len(nodes):
                raise loaded.error(
                    (*path, "velocity"), f"the file has {len(values)} rows for {len(nodes)} selected nodes"
                )
            out.append((nodes, values))
        else:
            out.append((nodes, np.tile(entry.velocity, (len(nodes), 1))))
    return out


def _places(geometry: Geometry) -> tuple[str, ...]:
    """Body and number of every node."""
    words = [""] * len(geometry.nodes)
    shells = {shell.name for shell in geometry.shells}
    for name, nodes in geometry.body_nodes.items():
        kind = "shell" if name in shells else "rod"
        for number, node in enumerate(nodes):
            words[node] = words[node] or f"{kind} '{name}', node {number} of {len(nodes)}"
    return tuple(words)
