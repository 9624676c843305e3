"""Strains as the energies count them, against those that geometry gives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from dismech_cli.arrays import FloatArray
from dismech_cli.compose.compose import _driven, compose
from dismech_cli.compose.elastic.elastic import make_passive
from dismech_cli.compose.scene import make_scene
from dismech_cli.compose.structure.holds import resolve_holds
from dismech_cli.compose.structure.plan import make_plan
from dismech_cli.compose.structure.structure import Structure, make_structure
from dismech_cli.control.plugin import NONE
from dismech_cli.control.sensor import Reading
from dismech_cli.model.state import State
from dismech_cli.scenario.load import load_mapping

MATERIAL = {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000}


def read(body: dict[str, Any], sensor: dict[str, Any], **keys: Any) -> tuple[Structure, Reading]:
    """The reading of one sensor."""
    deck = {
        "schema_version": 1,
        "name": "s",
        "materials": {"m": MATERIAL | keys.pop("material", {})},
        "geometry": [{"material": "m", **body}],
        "sensors": {"s": sensor},
        "numerics": {"dt": 0.01, "t_end": 0.1},
        **keys,
    }
    scene = make_scene(load_mapping(deck))
    holds = resolve_holds(scene)
    structure = make_structure(scene, holds, make_plan(scene, holds))
    passive = make_passive(scene, structure)
    return structure, _driven(scene, structure, passive, NONE)[0].readings["s"]


def at(structure: Structure, nodes: FloatArray, theta: FloatArray | None = None) -> State:
    """The state with nodes at some places, and edges turned by some angles."""
    dofs = structure.dofs
    q = structure.rest.copy()
    q[dofs.of_nodes(np.arange(len(nodes))).ravel()] = dofs.project(nodes).ravel()
    if theta is not None:
        q[dofs.of_angles(np.arange(len(theta)))] = theta
    frames = structure.frames.transport(structure.frames.rest(structure.rest), q).state
    return State(0.0, q, np.zeros_like(q), np.zeros_like(q), frames)


def rod(nodes: int = 11, **keys: Any) -> dict[str, Any]:
    line = {"shape": "line", "from": [0, 0, 0], "to": [1, 0, 0], "nodes": nodes}
    return {"type": "rod", "name": "r", "radius": 0.01, "generate": line, **keys}


def circle(nodes: int, curvature: float, up: int) -> FloatArray:
    """Nodes on a polygon whose edges are those of a line of length 1 and turn evenly."""
    h = 1.0 / (nodes - 1)
    turn = 2.0 * np.arctan(0.5 * curvature * h)
    angles = turn * np.arange(nodes - 1)
    steps = np.zeros((nodes - 1, 3))
    steps[:, 0], steps[:, up] = h * np.cos(angles), h * np.sin(angles)
    return np.concatenate((np.zeros((1, 3)), np.cumsum(steps, axis=0)))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("natural", [0.0, 2.0])
def test_curvature_counts_from_the_natural_one(dimension: int, natural: float) -> None:
    body = rod(natural={"curvature_1": natural}, director=[0, 0, 1])
    structure, reading = read(body, {"strain": "curvature_1", "rod": "r"}, dimension=dimension)
    sign = np.sign(reading(at(structure, circle(11, 3.0, 2)))[0] + natural)
    assert_allclose(reading(at(structure, circle(11, 3.0, 2))), sign * 3.0 - natural, rtol=1e-12)
    assert_allclose(reading(at(structure, circle(11, -3.0, 2))), -sign * 3.0 - natural, rtol=1e-12)


def test_curvature_is_read_where_no_stiffness_is() -> None:
    """A sensor does not ask how stiff a joint is, nor how stiff in another direction."""
    section = {
        "type": "given",
        "axial_stiffness": 1.0,
        "bending_stiffness_1": 1e-9,
        "bending_stiffness_2": 1e9,
        "torsional_stiffness": 1.0,
        "mass_per_length": 1.0,
        "rotary_inertia_per_length": 1e-4,
        "radius": 1e-2,
    }
    body = {key: value for key, value in rod().items() if key != "radius"} | {"section": section}
    structure, reading = read(body, {"strain": "curvature_2", "rod": "r", "joints": [2, 4]})
    values = [np.abs(reading(at(structure, circle(11, 3.0, up)))) for up in (1, 2)]
    assert reading.size == 3
    # in one plane it sees all of it, in the other nothing
    assert_allclose(sorted(v.max() for v in values), [0.0, 3.0], atol=1e-11)


def test_twist_per_length() -> None:
    structure, reading = read(rod(), {"strain": "twist", "rod": "r"})
    straight = circle(11, 0.0, 1)
    assert_allclose(reading(at(structure, straight, 0.05 * np.arange(10))), 0.5, rtol=1e-11)


@pytest.mark.parametrize("model", ["linear", "neo_hookean"])
def test_stretch_counts_from_the_natural_length(model: str) -> None:
    body = rod(natural={"stretch": 0.1})
    material = {} if model == "linear" else {"model": model, "poisson_ratio": 0.5}
    structure, reading = read(body, {"strain": "stretch", "rod": "r"}, material=material)
    nodes = circle(11, 0.0, 1) * 1.3
    assert_allclose(reading(at(structure, nodes)), 0.3 - 0.1, rtol=1e-12)


SHEET = {
    "type": "shell",
    "name": "s",
    "thickness": 0.01,
    "generate": {
        "shape": "sheet",
        "origin": [0, 0, 0],
        "length": 1.0,
        "width": 0.5,
        "divisions": 8,
        "pattern": "alternating",
    },
}


def rolled(nodes: FloatArray, curvature: float) -> FloatArray:
    """A sheet laid on a cylinder about y."""
    out = nodes.copy()
    out[:, 0] = np.sin(curvature * nodes[:, 0]) / curvature
    out[:, 2] = (1.0 - np.cos(curvature * nodes[:, 0])) / curvature
    return out


@pytest.mark.parametrize("bending", ["hinge", "midedge", "averaged"])
def test_hinges_are_read_by_their_angle_whatever_bends_them(bending: str) -> None:
    structure, reading = read(SHEET | {"bending": bending}, {"strain": "dihedral", "shell": "s"})
    nodes = structure.positions
    topology = structure.shell_edges.bodies["s"].topology
    moved = rolled(nodes, 1.0)
    x = moved[topology.hinges]
    e = x[:, 1] - x[:, 0]
    one, two = np.cross(e, x[:, 2] - x[:, 0]), np.cross(x[:, 3] - x[:, 0], e)
    cosine = (one * two).sum(axis=1) / np.linalg.norm(one, axis=1) / np.linalg.norm(two, axis=1)
    assert_allclose(np.abs(reading(at(structure, moved))), np.arccos(np.clip(cosine, -1, 1)), atol=3e-8)


@pytest.mark.parametrize("along", ["x", "y"])
def test_surface_curvature_along_and_across_a_cylinder(along: str) -> None:
    """Poisson's ratio couples stiffness, not what is read."""
    direction = {"x": [1, 0, 0], "y": [0, 1, 0]}[along]
    sensor = {"strain": "surface_curvature", "shell": "s", "along": direction}
    structure, reading = read(SHEET | {"bending": "averaged"}, sensor)
    nodes, curvature = structure.positions, 0.5
    values = reading(at(structure, rolled(nodes, curvature)))
    triangles = structure.shell_edges.bodies["s"].triangles
    inner = (nodes[triangles, 0].min(axis=1) > 0.2) & (nodes[triangles, 0].max(axis=1) < 0.8)
    inner &= (nodes[triangles, 1].min(axis=1) > 0.1) & (nodes[triangles, 1].max(axis=1) < 0.4)
    wanted = curvature if along == "x" else 0.0
    # normals of edges are means over their faces: a cylinder is met on average
    assert abs(np.abs(values[inner].mean()) - wanted) < 0.02 * curvature


def test_a_probe_is_a_sensor() -> None:
    sensor = {"probe": {"position": "r.end", "component": "x"}}
    structure, reading = read(rod(), sensor)
    assert_allclose(reading(at(structure, circle(11, 0.0, 1) * 1.5)), [1.5], rtol=1e-14)


def test_a_scene_with_sensors_alone_has_no_memory() -> None:
    deck = {
        "schema_version": 1,
        "name": "s",
        "dimension": 2,
        "materials": {"m": MATERIAL},
        "geometry": [{"material": "m", **rod()}],
        "sensors": {"s": {"strain": "stretch", "rod": "r"}},
        "numerics": {"dt": 0.01, "t_end": 0.1},
    }
    simulation = compose(load_mapping(deck)).simulation
    assert not simulation.controls.loops
    assert not simulation.start.inputs.size
    assert not simulation.start.memory
