"""What a scenario asks of its pictures, in the terms of those who draw."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import numpy as np

from ..compose.scene import make_scene
from ..errors import OutputError
from ..output.frame import Topology
from ..output.read import Run
from ..output.run_directory import SCENARIO_FILE
from ..render.settings import Camera, Format, Rgb, Settings, Triple, View
from ..scenario.language.render import WHOLE, ColorField, Render, RodField, ShellField
from ..scenario.language.render import Camera as CameraSpec
from ..scenario.language.scenario import Scenario
from ..scenario.load import LoadedScenario, load
from .obstacles_seen import solids_of

_ANGLE = float(np.radians(30.0))


def field_of(color_by: str) -> str | None:
    """The field of a colour: a vector is shown by its length, so speed is that of the velocity."""
    return {"none": None, "speed": "velocity"}.get(color_by, color_by)


def asked_of(run_dir: Path, changes: tuple[str, ...] = (), color_by: str | None = None) -> LoadedScenario:
    """The scenario of a run with other pictures.

    Args:
        run_dir: The run directory.
        changes: Keys of ``output.render``, each ``KEY=VALUE``.
        color_by: Another colour, whose field need not be among those of the run.

    Raises:
        OutputError: If the run has no scenario.
        ScenarioError: If a change cannot be.
    """
    file = run_dir / SCENARIO_FILE
    if not file.is_file():
        raise OutputError(f"cannot draw {run_dir}: it has no {SCENARIO_FILE}")
    overrides = [f"output.render.{change}" for change in changes]
    if color_by is not None:
        overrides.append(f"output.render.color_by={color_by}")
        fields = load(file).scenario.output.fields
        missing = field_of(color_by) or "none"
        if missing in get_args(ColorField) and missing not in fields:
            overrides.append(f"output.fields=[{', '.join((*fields, missing))}]")
    return load(file, overrides=overrides)


def settings_of(loaded: LoadedScenario, run: Run, color_by: str | None) -> Settings:
    """What pictures show.

    Args:
        loaded: The scenario.
        run: The open run.
        color_by: The field that colours the bodies.
    """
    topology = run.topology
    render = loaded.scenario.output.render
    width, height = (length + length % 2 for length in render.size)
    return Settings(
        camera=_camera(loaded.scenario, topology),
        color_by=color_by,
        known="rods"
        if color_by in get_args(RodField)
        else "shells"
        if color_by in get_args(ShellField)
        else "all",
        size=(width, height),
        ground=render.ground,
        background=render.background,
        smooth=render.shading == "smooth",
        mesh=render.mesh == "shown",
        ends=render.ends,
        colors={topology.bodies.index(body): _rgb(color) for body, color in render.colors.items()},
        text=render.text,
        ghosts=render.ghosts,
        trails=_trails(loaded, render),
        joints=_joints(loaded, render),
        obstacles=solids_of(loaded, run.t),
        contacts=render.contacts == "shown",
        limits=None if render.range is None else (render.range[0], render.range[1]),
    )


def formats_of(render: Render) -> tuple[Format, ...]:
    """Kinds of pictures that a scenario asks for, or a film if it asks for nothing at all."""
    kinds: list[Format] = ["png"] if render.stills else []
    if render.video != "none":
        kinds.append(render.video)
    return tuple(kinds) if kinds or render.plots else ("mp4",)


def _camera(scenario: Scenario, topology: Topology) -> Camera:
    render = scenario.output.render
    spec = render.camera
    flat: View = scenario.plane if scenario.dimension == 2 else "iso"
    perspective = _ANGLE if spec.from_ is not None else 0.0
    return Camera(
        view=flat if render.view == "auto" else render.view,
        eye=_triple(spec.from_),
        target=_triple(spec.to),
        up=_triple(spec.up),
        angle=perspective if spec.angle is None else spec.angle,
        follow=_followed(spec, topology),
    )


def _triple(values: tuple[float, ...] | None) -> Triple | None:
    return None if values is None else (values[0], values[1], values[2])


def _followed(spec: CameraSpec, topology: Topology) -> tuple[int, ...] | None:
    """Nodes of the body that is followed; none are all."""
    if spec.follow is None:
        return None
    if spec.follow == WHOLE and WHOLE not in topology.bodies:
        return ()
    body = topology.bodies.index(spec.follow)
    cells = (topology.edges[topology.edge_body == body], topology.triangles[topology.triangle_body == body])
    return tuple(np.unique(np.concatenate([cell.ravel() for cell in cells])).tolist())


def _rgb(color: str) -> Rgb:
    red, green, blue = bytes.fromhex(color[1:])
    return red, green, blue


def _trails(loaded: LoadedScenario, render: Render) -> tuple[int, ...]:
    """Nodes that leave a line, each once."""
    if not render.trails:
        return ()
    places = make_scene(loaded).places
    found = [places.nodes(("output", "render", "trails", i)) for i in range(len(render.trails))]
    return tuple(np.unique(np.concatenate(found)).tolist())


def _joints(loaded: LoadedScenario, render: Render) -> tuple[tuple[int, bool], ...]:
    """Nodes of joints, and whether bending passes there between any of their bodies."""
    if render.joints == "hidden":
        return ()
    bends: dict[int, bool] = {}
    for one in make_scene(loaded).geometry.joined:
        bends[one.node] = bends.get(one.node, False) or "bending" in one.passes
    return tuple(sorted(bends.items()))
