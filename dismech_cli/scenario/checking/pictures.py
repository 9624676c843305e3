"""What no single key can tell about pictures."""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

from ...words import hint
from ..language.numerics import Static
from ..language.render import WHOLE, ComputedField, RodField, ShellField
from ..language.scenario import Scenario
from ..text.tree import KeyPath
from .finding import Finding

_HERE: KeyPath = ("output", "render")


def picture_findings(scenario: Scenario) -> Iterator[Finding]:
    """Every contradiction of ``output.render``, as key path and message."""
    yield from _colours(scenario)
    output, render = scenario.output, scenario.output.render
    bodies = {body.name for body in scenario.geometry}
    for name in render.colors:
        if name not in bodies:
            yield (*_HERE, "colors", name), f"no body is named {name!r}{hint(name, bodies)}"
    follow = render.camera.follow
    if follow is not None and follow not in (WHOLE, *bodies):
        known = (WHOLE, *bodies)
        yield (*_HERE, "camera", "follow"), f"no body is named {follow!r}{hint(follow, known)}"
    if render.background == "transparent" and render.video != "none":
        yield (*_HERE, "background"), "films cannot be transparent; take 'video: none' or another background"
    end = 1.0 if isinstance(scenario.numerics.integrator, Static) else scenario.numerics.t_end
    for key in ("times", "ghosts"):
        for i, t in enumerate(getattr(render, key)):
            if end is not None and t > end:
                yield (*_HERE, key, i), f"after the end of the run at {end:g} s"
    if render.contacts == "shown" and "contact_force" not in output.fields:
        yield (*_HERE, "contacts"), "needs 'contact_force' in output.fields"
    for i, name in enumerate(render.plots):
        if name not in output.probes:
            yield (*_HERE, "plots", i), f"no probe is named {name!r}{hint(name, output.probes)}"


def _colours(scenario: Scenario) -> Iterator[Finding]:
    output, path = scenario.output, (*_HERE, "color_by")
    field = "velocity" if output.render.color_by == "speed" else output.render.color_by
    if field in get_args(RodField) and not scenario.rods:
        yield path, f"{field!r} is a field of rods, but the scene has none"
    elif field in get_args(ShellField) and not scenario.shells:
        yield path, f"{field!r} is a field of shells, but the scene has none"
    elif field not in ("none", *output.fields, *get_args(ComputedField)):
        yield path, f"needs {field!r} in output.fields"
    if output.render.range is not None:
        if field == "none":
            yield (*_HERE, "range"), "has no meaning without 'color_by'"
        if output.render.range[0] >= output.render.range[1]:
            yield (*_HERE, "range"), "the first value must lie below the last"
