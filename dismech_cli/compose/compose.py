"""From a validated scenario to a simulation ready to step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace

import numpy as np

from ..control.plugin import NONE, Plugins
from ..frozen import frozen
from ..model.model import Model
from ..model.term import ChangingTerm, Term
from ..run.observe import LOAD_COLUMNS, scalar_columns
from ..run.roles import Roles
from ..run.simulation import Simulation
from ..scenario.load import LoadedScenario
from .bodies.geometry import Geometry
from .changing import Changing, make_changing
from .control.control import NO_CONTROL, Control, make_control
from .elastic.elastic import Elastic, Passive, make_elastic, make_passive
from .imperfection import NO_DEVIATION, Deviation, find_deviation
from .initial.signature import signature
from .initial.start import make_start
from .loads.table import Forces, make_forces
from .nets import net_decisions
from .numerics import build_driver, build_integrator, build_newton, check_linear_solver, follows_path
from .observables.fields import make_fields, make_topology
from .observables.labels import node_labels
from .observables.probes import make_probe, make_probes, make_watched
from .observables.validity import make_checks
from .path import make_advance
from .scene import Scene, make_scene
from .sizes import contact_memory, refuse_oversized, refuse_too_many
from .stepping import make_stepping
from .structure.holds import drives, resolve_holds
from .structure.kernels import Chosen, Repays, among_many, choose_kernels
from .structure.masses import mass_matrix
from .structure.plan import Decision, Plan, make_plan
from .structure.prescribed import build_motions
from .structure.structure import Structure, make_structure, typical_length


@frozen
class Composition:
    """A simulation, the plan it follows, and the bodies it is of.

    Attributes:
        simulation: Ready to step.
        plan: The plan it follows.
        geometry: The bodies.
        kept: A file that stands for the run that it starts from; empty where it starts from none.
        followed: Files that stand for the folders of runs that controllers follow, by their names.
        neighbours: Memory that contact of neighbours within bodies takes, roughly [byte].
    """

    simulation: Simulation
    plan: Plan
    geometry: Geometry
    kept: bytes = b""
    followed: Mapping[str, bytes] = field(default_factory=dict)
    neighbours: float = 0.0


def compose(
    loaded: LoadedScenario,
    kernels: str | None = None,
    planned: Callable[[Plan], None] = lambda plan: None,
    plugins: Plugins = NONE,
    repays: Repays = among_many,
) -> Composition:
    """Compose everything; steps nothing.

    Args:
        loaded: The scenario.
        kernels: Overrides the plan's choice of kernels: a resumed run keeps those it had.
        planned: Told the plan before anything is made of it, which may take long to compile.
        plugins: Where controllers of plugins come from.
        repays: What compiling kernels must save where the plan chooses them.

    Raises:
        ScenarioError: The scenario cannot be composed; the message points to the key.
    """
    refuse_too_many(loaded)
    perfect = make_scene(loaded)
    refuse_oversized(loaded, perfect.geometry)
    deviation = _deviation(perfect, plugins)
    scene = deviation.made(perfect)
    holds = resolve_holds(scene)
    plan = make_plan(scene, holds)
    check_linear_solver(loaded)
    resting = make_structure(scene, holds, plan)
    passive, forces = make_passive(scene, resting), make_forces(scene, resting)
    changing = make_changing(scene, resting)
    chosen = (
        choose_kernels(
            scene, plan, _model(scene, resting, (*passive.terms, *forces.all), changing.terms), repays
        )
        if kernels is None
        else Chosen(kernels, "as in the resumed run")
    )
    structure = resting.run_by(build_driver(chosen.kernels))
    plan = _with_kernels(plan, chosen, deviation)
    planned(plan)
    control, elastic = _driven(scene, structure, passive, plugins)
    roles = _roles(elastic, passive, forces, changing)
    probes = make_probes(scene, structure, control)
    fields = make_fields(scene, structure, elastic.rods)
    columns = scalar_columns(roles, probes, LOAD_COLUMNS if follows_path(loaded) else {})
    numerics = loaded.scenario.numerics
    model = _model(scene, structure, (*elastic.terms, *passive.damping, *forces.all), changing.terms)
    start = make_start(scene, structure, model.motions)
    state = deviation.pushed(start.state, structure.dofs, structure.frames)
    stepping = make_stepping(loaded, model, state.q, control.events)
    simulation = Simulation(
        name=loaded.scenario.name,
        model=model,
        roles=roles,
        integrator=build_integrator(numerics.integrator),
        newton=build_newton(
            numerics, driven=any(map(drives, holds)), touching=loaded.scenario.contact is not None
        ),
        linear_solver=numerics.linear_solver,
        control=stepping.control,
        controls=control.controls,
        advance=make_advance(scene, structure, control, model),
        frame_every=stepping.every,
        looks=stepping.looks,
        start=control.controls.started(state, control.size),
        topology=make_topology(scene, structure, fields, columns),
        fields=fields,
        probes=probes,
        watched=make_watched(scene, structure, control),
        places=node_labels(scene.geometry),
        checks=(*make_checks(scene, structure, elastic.rods), *changing.checks),
        touched=changing.touched,
        structure=signature(scene.geometry, structure),
    )
    plan = replace(
        plan,
        decisions=(*plan.decisions, *net_decisions(scene, model)),
        warnings=(*plan.warnings, *changing.warnings),
    )
    neighbours = sum(contact_memory(loaded.scenario, scene.geometry).values())
    return Composition(simulation, plan, scene.geometry, start.kept, control.kept, neighbours)


def _with_kernels(plan: Plan, chosen: Chosen, deviation: Deviation) -> Plan:
    """The plan with what runs it, and with what the scene was made to deviate by."""
    decision = Decision(f"kernels by {chosen.kernels}", chosen.why)
    return replace(
        plan,
        kernels=chosen.kernels,
        compiling=chosen.compiling,
        whole=chosen.whole,
        decisions=(*plan.decisions, decision, *chosen.step, *deviation.told),
        warnings=(*plan.warnings, chosen.warning) if chosen.warning else plan.warnings,
    )


def _driven(
    scene: Scene, structure: Structure, passive: Passive, plugins: Plugins
) -> tuple[Control, Elastic]:
    """Controllers, and the elastic energies that they and laws drive."""
    control = make_control(
        scene,
        structure,
        passive,
        plugins,
        lambda probe, path: make_probe(scene, structure, NO_CONTROL, probe, path),
    )
    return control, make_elastic(scene, structure, passive, control.ports)


def _deviation(perfect: Scene, plugins: Plugins) -> Deviation:
    """What the imperfection of the scenario asks for: modes of the scene without it, and without loads."""
    spec = perfect.scenario.imperfection
    if spec is None:
        return NO_DEVIATION
    holds = resolve_holds(perfect)
    structure = make_structure(perfect, holds, make_plan(perfect, holds))
    passive = make_passive(perfect, structure)
    model = _model(perfect, structure, _driven(perfect, structure, passive, plugins)[1].terms)
    mass = mass_matrix(perfect.geometry, structure.dofs, structure.payload)
    return find_deviation(spec, perfect, model, mass)


def _model(
    scene: Scene,
    structure: Structure,
    terms: tuple[Term, ...],
    changing: tuple[ChangingTerm, ...] = (),
) -> Model:
    dofs = structure.dofs
    massless = structure.plan.static
    return Model(
        dofs=dofs,
        rest=structure.rest,
        mass=np.zeros(dofs.n) if massless else mass_matrix(scene.geometry, dofs, structure.payload),
        terms=terms,
        motions=build_motions(scene, structure),
        frames=structure.frames,
        driver=structure.driver,
        length=typical_length(scene, structure),
        changing=changing,
    )


def _roles(elastic: Elastic, passive: Passive, forces: Forces, changing: Changing) -> Roles:
    return Roles(
        elastic=elastic.terms,
        surplus=elastic.surplus,
        gravitational=tuple(term.name for term in forces.gravitational),
        loads=tuple(term.name for term in forces.loads),
        dissipative=tuple(term.name for term in (*passive.damping, *forces.dissipative)),
        contact=changing.storing,
        friction=changing.rubbing,
    )
