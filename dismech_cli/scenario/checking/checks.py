"""What no single key can tell: names that must exist, keys that exclude each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, get_args

import numpy as np

from ...laws.expression import VARIABLES, compile_expression
from ...words import listed
from ..language.force import Buoyancy, Gravity
from ..language.motion import Clamp, Pin, Twist
from ..language.numerics import Static
from ..language.probe import EnergyProbe, LoadFactorProbe, ReactionProbe, StabilityProbe, VelocityProbe
from ..language.render import ContactField, RodField, ShellField
from ..language.scenario import Scenario
from ..language.seam import Seam
from ..text.tree import KeyPath
from ..values.law import PLACES, ExpressionLaw
from ..views.walk import probes, walk
from .contact import contact_findings
from .control import control_findings
from .finding import Finding
from .names import name_findings
from .pictures import picture_findings

MAX_STEPS: Final = 10_000_000
"""Nominal time steps of a run: each takes a place in the time grid of the run."""

# Times at which expressions are tried, both ends among them.
_TRIED = 101


def findings(scenario: Scenario) -> Iterator[Finding]:
    """Every contradiction of a scenario, as key path and message."""
    yield from name_findings(scenario)
    yield from _dimension(scenario)
    yield from _motions(scenario)
    yield from _time(scenario)
    yield from _step(scenario)
    yield from _path(scenario)
    yield from _expressions(scenario)
    yield from _forces(scenario)
    yield from _materials(scenario)
    yield from _seams(scenario)
    yield from _output(scenario)
    yield from picture_findings(scenario)
    yield from _expectations(scenario)
    yield from contact_findings(scenario)
    yield from control_findings(scenario)


def _seams(scenario: Scenario) -> Iterator[Finding]:
    models = {shell.name: shell.bending for shell in scenario.shells.values()}
    for i, joint in enumerate(scenario.joints):
        if not isinstance(joint, Seam) or joint.bending == "hinge":
            continue
        found = sorted({models[name] for name in joint.shells if name in models})
        if len(found) > 1 or "averaged" in found:
            yield (
                ("joints", i, "bending"),
                f"shells with bending: {listed(found, 'and')} cannot be welded; "
                "take 'midedge' for all, or 'hinge'",
            )


def _dimension(scenario: Scenario) -> Iterator[Finding]:
    if scenario.dimension == 3:
        if "plane" in scenario.model_fields_set:
            yield ("plane",), "only a scene of dimension 2 has a plane"
        return
    planar = "a planar scene has no twist"
    for i, field in enumerate(scenario.output.fields):
        if field == "director":
            yield ("output", "fields", i), "a planar scene has no material directors"
    for i in scenario.shells:
        yield ("geometry", i, "type"), "a shell needs a scene of dimension 3"
    for i, rod in scenario.rods.items():
        if rod.bending == "framed":
            yield ("geometry", i, "bending"), "a planar scene has no frames; take 'auto'"
        if rod.natural.twist is not None:
            yield ("geometry", i, "natural", "twist"), planar
    for i, motion in enumerate(scenario.motions):
        if isinstance(motion, Twist):
            yield ("motions", i, "type"), planar
        if isinstance(motion, Clamp) and motion.twist is not None:
            yield ("motions", i, "twist"), planar
        (normal,) = set("xyz").difference(scenario.plane)
        for k, rotation in enumerate(getattr(motion, "rotations", None) or ()):
            if any(part for axis, part in zip("xyz", rotation.axis, strict=True) if axis != normal):
                message = f"turns out of the plane of the scene: take the axis along {normal}"
                yield ("motions", i, "rotations", k, "axis"), message
    for i, part in enumerate(scenario.actuation):
        if part.type == "twist":
            yield ("actuation", i, "type"), planar


def _motions(scenario: Scenario) -> Iterator[Finding]:
    """Rotations of what is not held in every direction that they move it."""
    inside = scenario.plane if scenario.dimension == 2 else "xyz"
    for i, motion in enumerate(scenario.motions):
        if isinstance(motion, Pin) and motion.rotations is not None:
            free = [axis for axis in inside if axis not in motion.components]
            if free:
                message = f"rotations move what is held in every direction; {listed(free)} is free here"
                yield ("motions", i, "components"), message


def _time(scenario: Scenario) -> Iterator[Finding]:
    numerics = scenario.numerics
    if isinstance(numerics.integrator, Static):
        goes = (
            "goes over pseudo-time 0 to 1 in load_steps"
            if numerics.integrator.path is None
            else "along a path has no time: integrator.path tells its steps and its end"
        )
        for key in ("dt", "t_end"):
            if getattr(numerics, key) is not None:
                yield ("numerics", key), f"a static run {goes}; leave this out"
        if numerics.step.adaptive:
            yield ("numerics", "step", "adaptive"), "a static run has load steps: leave this out"
        if scenario.initial_velocity:
            yield ("initial_velocity",), "a static run has no velocities"
        if scenario.imperfection is not None and not scenario.imperfection.stress_free:
            message = "statics forget at the first step how they were pushed: leave this out"
            yield ("imperfection", "stress_free"), message
        return
    if numerics.t_end is None:
        yield ("numerics", "t_end"), "missing key: a run in time needs it"
    if numerics.dt is None and scenario.contact is not None and numerics.step.adaptive is None:
        yield (
            ("numerics", "dt"),
            "missing key: where bodies touch, steps adapt only if 'step: {adaptive: true}' says so: they are "
            "as short as impacts",
        )
    if numerics.dt is None and not numerics.adapts:
        yield ("numerics", "dt"), "missing key: fixed steps need it; without 'adaptive: false' they adapt"
    if numerics.dt is not None and numerics.t_end is not None and numerics.dt > numerics.t_end:
        yield ("numerics", "dt"), f"longer than the run of {numerics.t_end:g} s"
    steps = 0.0 if numerics.dt is None or numerics.t_end is None else numerics.t_end / numerics.dt
    if steps > MAX_STEPS:
        yield (
            ("numerics", "dt"),
            f"{steps:.3g} steps to the end of the run at {numerics.t_end:g} s; at most {MAX_STEPS:.0e}",
        )


def _step(scenario: Scenario) -> Iterator[Finding]:
    """Lengths of adaptive steps, and keys that do nothing."""
    numerics, step = scenario.numerics, scenario.numerics.step
    for key in ("rtol", "dt_min", "dt_max"):
        if getattr(step, key) is not None and not numerics.adapts:
            yield ("numerics", "step", key), "only adaptive steps have it: add 'adaptive: true'"
    if numerics.adapts and step.max_cuts != type(step)().max_cuts:
        yield ("numerics", "step", "max_cuts"), "adaptive steps are cut down to 'dt_min': give that instead"
    shortest, longest = step.dt_min, step.dt_max
    if longest is not None and shortest is not None and shortest > longest:
        yield ("numerics", "step", "dt_min"), f"longer than dt_max, {longest:g} s"
    if not numerics.adapts or numerics.dt is None:
        return
    if shortest is not None and numerics.dt < shortest:
        yield ("numerics", "dt"), f"the first step is shorter than dt_min, {shortest:g} s"
    if longest is not None and numerics.dt > longest:
        yield ("numerics", "dt"), f"the first step is longer than dt_max, {longest:g} s"


def _path(scenario: Scenario) -> Iterator[Finding]:
    integrator = scenario.numerics.integrator
    if not isinstance(integrator, Static) or integrator.path is None:
        return
    for i, motion in enumerate(scenario.motions):
        if motion.release is not None:
            yield ("motions", i, "release"), "along a path of equilibria nothing lets go: its time is no time"
    until = integrator.path.until
    if until is not None and isinstance(
        until.probe, EnergyProbe | ReactionProbe | StabilityProbe | VelocityProbe
    ):
        message = "a path ends by its shape: displacement, position, distance, twist, turn or load_factor"
        yield ("numerics", "integrator", "path", "until", "probe"), message
    if scenario.numerics.newton.projection == "indefinite":
        message = "a path goes through unstable equilibria as they are: leave this out"
        yield ("numerics", "newton", "projection"), message


def _expressions(scenario: Scenario) -> Iterator[Finding]:
    """Laws that have no value at some time of the run; those of places wait for the mesh."""
    integrator = scenario.numerics.integrator
    end = integrator.end if isinstance(integrator, Static) else scenario.numerics.t_end or 0.0
    for path, value in walk(scenario):
        if not isinstance(value, ExpressionLaw):
            continue
        law = compile_expression(value.expression, (*VARIABLES, *PLACES))
        if law.variables.intersection(PLACES):
            continue
        for t in np.linspace(0.0, end, _TRIED):
            with np.errstate(all="ignore"):
                finite = np.isfinite(law.program({"t": float(t), "s": 0.5}))
            if not finite:
                yield (*path, "expression"), f"{value.expression!r} has no finite value at t = {t:g} s"
                break


def _forces(scenario: Scenario) -> Iterator[Finding]:
    if not any(isinstance(force, Gravity) for force in scenario.forces):
        for i, force in enumerate(scenario.forces):
            if isinstance(force, Buoyancy):
                yield ("forces", i), "buoyancy acts against gravity, but no force of type 'gravity' is given"


def _materials(scenario: Scenario) -> Iterator[Finding]:
    for i, shell in scenario.shells.items():
        material = scenario.materials.get(shell.material)
        if material is not None and material.model == "neo_hookean" and shell.membrane != "cst":
            message = f"springs know no neo_hookean material, but {shell.material!r} is one; take 'cst'"
            yield ("geometry", i, "membrane"), message


def _output(scenario: Scenario) -> Iterator[Finding]:
    output = scenario.output
    for i, field in enumerate(output.fields):
        if field in get_args(RodField) and not scenario.rods:
            yield ("output", "fields", i), f"{field!r} is a field of rods, but the scene has none"
        if field in get_args(ShellField) and not scenario.shells:
            yield ("output", "fields", i), f"{field!r} is a field of shells, but the scene has none"
        if field in get_args(ContactField) and scenario.contact is None:
            yield ("output", "fields", i), f"{field!r} needs contact, but the scene has no `contact`"
    end = scenario.numerics.t_end
    if output.every is not None and end is not None and output.every > end:
        yield ("output", "every"), f"longer than the run of {end:g} s"
    if not isinstance(scenario.numerics.integrator, Static):
        for path, probe in probes(scenario):
            if isinstance(probe, StabilityProbe):
                yield path, "eigenvalues are computed in static runs only"
            if isinstance(probe, LoadFactorProbe):
                yield path, "only static runs have a load factor"
    elif any(getattr(force, "follower", False) or force.acts_at_rest for force in scenario.forces):
        for path, probe in probes(scenario):
            if isinstance(probe, StabilityProbe):
                message = (
                    "follower loads and moving fluids make the stiffness unsymmetric: its sign tells nothing"
                )
                yield path, message


def _expectations(scenario: Scenario) -> Iterator[Finding]:
    integrator = scenario.numerics.integrator
    end = scenario.numerics.t_end
    if isinstance(integrator, Static) and integrator.path is None:
        end = integrator.end
    for name, expectation in scenario.expect.items():
        path: KeyPath = ("expect", name)
        if expectation.at is not None:
            # a resolved scenario says the default
            for key, default in (("reduce", "last"), ("after", None)):
                if getattr(expectation, key) != default:
                    yield (*path, key), "has no meaning beside 'at'"
        if expectation.tolerance.kind == "relative" and expectation.value == 0.0:
            yield (*path, "tolerance"), "relative to the value 0 nothing is allowed; give a quantity"
        for key in ("at", "after"):
            time = getattr(expectation, key)
            if time is not None and end is not None and time > end:
                yield (*path, key), f"after the end of the run at {end:g} s"
