"""What no single key can tell: names that must exist, keys that exclude each other."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias, get_args

import numpy as np

from ...laws.expression import VARIABLES, compile_expression
from ...words import hint, listed
from ..language.actuation import ShellActuation
from ..language.force import Buoyancy, Gravity
from ..language.geometry import Body, Shell
from ..language.motion import Clamp, Twist
from ..language.numerics import Static
from ..language.output import RodField, ShellField
from ..language.probe import MeanPositionProbe, Probe, StabilityProbe
from ..language.scenario import Scenario
from ..text.tree import KeyPath
from ..values.law import PLACES, ExpressionLaw
from ..values.selection import EdgeSelection, GroupSelection, NodeSelection
from ..views.walk import walk

Finding: TypeAlias = tuple[KeyPath, str]

# Times at which expressions are tried, both ends among them.
_TRIED = 101

SURFACE_GROUPS = {
    "sheet": ("left", "right", "bottom", "top", "rim"),
    "disc": ("center", "rim"),
    "annulus": ("inner", "outer"),
    "hemisphere": ("apex", "rim"),
    "cylinder": ("left", "right", "bottom", "top", "rim"),
    "sphere": ("left", "right", "bottom", "top", "rim"),
}


def findings(scenario: Scenario) -> Iterator[Finding]:
    """Every contradiction of a scenario, as key path and message."""
    yield from _bodies(scenario)
    yield from _selections(scenario)
    yield from _rod_names(scenario)
    yield from _shell_names(scenario)
    yield from _dimension(scenario)
    yield from _time(scenario)
    yield from _expressions(scenario)
    yield from _forces(scenario)
    yield from _output(scenario)
    yield from _expectations(scenario)


def _bodies(scenario: Scenario) -> Iterator[Finding]:
    seen: set[str] = set()
    for i, body in enumerate(scenario.geometry):
        if body.material not in scenario.materials:
            near = hint(body.material, scenario.materials)
            yield ("geometry", i, "material"), f"no material is named {body.material!r}{near}"
        if body.name in seen:
            yield ("geometry", i, "name"), f"the name {body.name!r} is taken by another body"
        seen.add(body.name)


def _selections(scenario: Scenario) -> Iterator[Finding]:
    bodies = {body.name: body for body in scenario.geometry}
    rods = [rod.name for rod in scenario.rods.values()]
    kind = "body" if scenario.shells else "rod"
    for path, value in walk(scenario):
        match value:
            case GroupSelection(group=group):
                message = _group(group, bodies, kind)
                if message:
                    yield (*path, "group"), message
            case NodeSelection(nodes=part) if part.of not in bodies:
                yield (*path, "nodes", "of"), f"no {kind} is named {part.of!r}{hint(part.of, bodies)}"
            case EdgeSelection(edges=part) if part.of not in rods:
                yield (*path, "edges", "of"), f"no rod is named {part.of!r}{hint(part.of, rods)}"


def _group(group: str, bodies: dict[str, Body], kind: str) -> str | None:
    name, dot, part = group.partition(".")
    if name not in bodies:
        return f"no {kind} is named {name!r}{hint(name, bodies)}"
    body = bodies[name]
    if not dot or body.mesh is not None:
        return None
    if isinstance(body, Shell):
        assert body.generate is not None
        known = (*SURFACE_GROUPS[body.generate.shape], "boundary")
        if part in known:
            return None
        return f"a generated {body.generate.shape} has the groups {listed(known, 'and')} only, not {part!r}"
    if getattr(body.generate, "closed", False):
        return f"the closed rod {name!r} has no ends and no group {part!r}"
    if part not in ("start", "end"):
        near = hint(part, ("start", "end"))
        return f"a generated rod has the groups 'start' and 'end' only, not {part!r}{near}"
    return None


def _rod_names(scenario: Scenario) -> Iterator[Finding]:
    rods = [rod.name for rod in scenario.rods.values()]
    bodies = [body.name for body in scenario.geometry]
    named = list(_loaded(scenario, "rods"))
    if not rods:
        yield from _vain(scenario, "rods")
    for i, part in enumerate(scenario.actuation):
        if isinstance(part, ShellActuation):
            continue
        named.append((("actuation", i, "rod"), part.rod))
        if part.joints is not None and part.joints[1] < part.joints[0]:
            yield ("actuation", i, "joints"), f"a range goes from first to last, got {list(part.joints)}"
    for path, probe in _probes(scenario):
        if isinstance(probe, MeanPositionProbe) and probe.mean_position not in bodies:
            kind = "body" if scenario.shells else "rod"
            near = hint(probe.mean_position, bodies)
            yield (*path, "mean_position"), f"no {kind} is named {probe.mean_position!r}{near}"
    for path, name in named:
        if name not in rods:
            yield path, _unnamed("rod", name, rods, scenario)


def _unnamed(kind: str, name: str, known: list[str], scenario: Scenario) -> str:
    if any(body.name == name for body in scenario.geometry):
        return f"{name!r} is no {kind}"
    return f"no {kind} is named {name!r}{hint(name, known)}"


def _shell_names(scenario: Scenario) -> Iterator[Finding]:
    shells = [shell.name for shell in scenario.shells.values()]
    named = [*_loaded(scenario, "shells"), *_loaded(scenario, "shell")]
    if not shells:
        yield from _vain(scenario, "shells")
    for i, part in enumerate(scenario.actuation):
        if isinstance(part, ShellActuation):
            named.append((("actuation", i, "shell"), part.shell))
    for path, name in named:
        if name not in shells:
            yield path, _unnamed("shell", name, shells, scenario)


def _loaded(scenario: Scenario, key: str) -> Iterator[Finding]:
    """Bodies that forces name under a key, with their places."""
    for i, force in enumerate(scenario.forces):
        if force.acts_on == key:
            for path, value in walk(getattr(force, key), ("forces", i, key)):
                if isinstance(value, str):
                    yield path, value


def _vain(scenario: Scenario, key: str) -> Iterator[Finding]:
    """Forces on all bodies of a kind that the scene lacks."""
    for i, force in enumerate(scenario.forces):
        if force.acts_on == key and getattr(force, key) is None:
            yield ("forces", i, "type"), f"acts on {key}, but the scene has none"


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
    for i, part in enumerate(scenario.actuation):
        if part.type == "twist":
            yield ("actuation", i, "type"), planar


def _time(scenario: Scenario) -> Iterator[Finding]:
    numerics = scenario.numerics
    if isinstance(numerics.integrator, Static):
        for key in ("dt", "t_end"):
            if getattr(numerics, key) is not None:
                yield (
                    ("numerics", key),
                    "a static run goes over pseudo-time 0 to 1 in load_steps; leave this out",
                )
        if scenario.initial_velocity:
            yield ("initial_velocity",), "a static run has no velocities"
        return
    for key in ("dt", "t_end"):
        if getattr(numerics, key) is None:
            yield ("numerics", key), "missing key: a run in time needs it"
    if numerics.dt is not None and numerics.t_end is not None and numerics.dt > numerics.t_end:
        yield ("numerics", "dt"), f"longer than the run of {numerics.t_end:g} s"


def _expressions(scenario: Scenario) -> Iterator[Finding]:
    """Laws that have no value at some time of the run; those of places wait for the mesh."""
    end = 1.0 if isinstance(scenario.numerics.integrator, Static) else scenario.numerics.t_end or 0.0
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


def _output(scenario: Scenario) -> Iterator[Finding]:
    output = scenario.output
    for i, field in enumerate(output.fields):
        if field in get_args(RodField) and not scenario.rods:
            yield ("output", "fields", i), f"{field!r} is a field of rods, but the scene has none"
        if field in get_args(ShellField) and not scenario.shells:
            yield ("output", "fields", i), f"{field!r} is a field of shells, but the scene has none"
    colour = output.render.color_by
    needed = "velocity" if colour == "speed" else colour
    if colour != "none" and needed not in output.fields:
        yield ("output", "render", "color_by"), f"needs {needed!r} in output.fields"
    for i, name in enumerate(output.render.plots):
        if name not in output.probes:
            yield ("output", "render", "plots", i), f"no probe is named {name!r}{hint(name, output.probes)}"
    end = scenario.numerics.t_end
    if output.every is not None and end is not None and output.every > end:
        yield ("output", "every"), f"longer than the run of {end:g} s"
    if not isinstance(scenario.numerics.integrator, Static):
        for path, probe in _probes(scenario):
            if isinstance(probe, StabilityProbe):
                yield path, "eigenvalues are computed in static runs only"
    elif any(getattr(force, "follower", False) for force in scenario.forces):
        for path, probe in _probes(scenario):
            if isinstance(probe, StabilityProbe):
                yield path, "a follower load makes the stiffness unsymmetric: its sign tells nothing"


def _expectations(scenario: Scenario) -> Iterator[Finding]:
    end = 1.0 if isinstance(scenario.numerics.integrator, Static) else scenario.numerics.t_end
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


def _probes(scenario: Scenario) -> Iterator[tuple[KeyPath, Probe]]:
    for name, probe in scenario.output.probes.items():
        yield ("output", "probes", name), probe
    for name, expectation in scenario.expect.items():
        yield ("expect", name, "probe"), expectation.probe
