"""Names that a scenario uses: of materials, bodies, groups."""

from __future__ import annotations

from collections.abc import Iterator

from ...words import hint, listed
from ..language.actuation import ShellActuation
from ..language.geometry import Body, Shell
from ..language.joint import AutoJoint
from ..language.probe import BendProbe, MeanPositionProbe
from ..language.scenario import Scenario
from ..language.seam import Seam
from ..values.selection import EdgeSelection, GroupSelection, NodeSelection
from ..views.walk import probes, walk
from .finding import Finding

SURFACE_GROUPS = {
    "sheet": ("left", "right", "bottom", "top", "rim"),
    "disc": ("center", "rim"),
    "annulus": ("inner", "outer"),
    "hemisphere": ("apex", "rim"),
    "cylinder": ("left", "right", "bottom", "top", "rim"),
    "sphere": ("left", "right", "bottom", "top", "rim"),
    "icosphere": ("top", "bottom"),
}


def name_findings(scenario: Scenario) -> Iterator[Finding]:
    """Names that are taken twice, or of nothing."""
    yield from _bodies(scenario)
    yield from _selections(scenario)
    yield from _rod_names(scenario)
    yield from _shell_names(scenario)
    yield from _joined_names(scenario)


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
    for path, probe in probes(scenario):
        match probe:
            case MeanPositionProbe(mean_position=name):
                key = "mean_position"
            case BendProbe(bend=name):
                key = "bend"
            case _:
                continue
        if name not in bodies:
            kind = "body" if scenario.shells else "rod"
            yield (*path, key), f"no {kind} is named {name!r}{hint(name, bodies)}"
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
    for i, joint in enumerate(scenario.joints):
        if isinstance(joint, Seam):
            named += [(("joints", i, "shells", k), name) for k, name in enumerate(joint.shells)]
    for path, name in named:
        if name not in shells:
            yield path, _unnamed("shell", name, shells, scenario)


def _joined_names(scenario: Scenario) -> Iterator[Finding]:
    """Bodies that joints name; a body is not joined to itself."""
    kind = "body" if scenario.shells else "rod"
    bodies = [body.name for body in scenario.geometry]
    for i, joint in enumerate(scenario.joints):
        if not isinstance(joint, AutoJoint) or joint.between is None:
            continue
        for k, name in enumerate(joint.between):
            if name not in bodies:
                yield ("joints", i, "between", k), f"no {kind} is named {name!r}{hint(name, bodies)}"
        if joint.between[0] == joint.between[1]:
            yield ("joints", i, "between"), "names one body twice; expected two"


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
