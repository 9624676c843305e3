"""Obstacles in pictures: their surfaces are where contact has them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import dismech_cli
from dismech_cli.arrays import FloatArray
from dismech_cli.compose.contact.obstacles import make_obstacle
from dismech_cli.compose.scene import make_scene
from dismech_cli.contact.obstacles.obstacle import Obstacle
from dismech_cli.output.read import read
from dismech_cli.output.run_directory import SCENARIO_FILE
from dismech_cli.render.framing import Framing, frame_motion
from dismech_cli.render.obstacle_parts import RigidPart, obstacle_parts
from dismech_cli.render.timeline import stored
from dismech_cli.scenario.load import load
from dismech_cli.session.picturing import asked_of, settings_of

TURN = {
    "displacement": [0, {"expression": "t"}, 0],
    "angle": {"expression": "0.5*t"},
    "axis": [0, 0, 1],
    "about": [0, 1, 0],
}
OBSTACLES = [
    {"name": "floor", "type": "plane", "point": [0, 0, -3], "normal": [0.1, 0, 1]},
    {"name": "ball", "type": "sphere", "center": [1, 0, -1], "radius": 0.4},
    {"name": "drum", "type": "cylinder", "point": [0, 0, -2], "axis": [1, 2, 0], "radius": 0.3},
    {"name": "bar", "type": "capsule", "start": [2, 0, -1], "end": [2, 1, -2], "radius": 0.2},
    {
        "name": "box",
        "type": "box",
        "center": [3, 0, -1],
        "size": [1, 2, 0.5],
        "axis": [1, 1, 1],
        "angle": 1.0,
    },
]


@pytest.fixture(scope="module")
def run_dir(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("obstacles")
    moved = [one | {"motion": TURN} for one in OBSTACLES]
    deck = {
        "schema_version": 1,
        "name": "scene",
        "materials": {"m": {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "density": 1000}},
        "geometry": [
            {
                "type": "rod",
                "name": "rod",
                "material": "m",
                "radius": 0.01,
                "generate": {"shape": "line", "from": [0, 0, 0], "to": [1, 0, 0], "nodes": 3},
            }
        ],
        "obstacles": moved,
        "contact": {},
        "numerics": {"dt": 0.1, "t_end": 0.2},
        "output": {"every": 0.1},
    }
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    assert dismech_cli.simulate(file, out=folder / "out").exit == 0
    return folder / "out"


def surfaces(run_dir: Path) -> tuple[list[RigidPart], Framing]:
    with read(run_dir) as run:
        settings = settings_of(asked_of(run_dir), run, None)
        framing = frame_motion(run, settings, [stored(run.t, len(run) - 1)])
    return obstacle_parts(settings.obstacles, framing, 48), framing


def test_surfaces_are_where_contact_has_them(run_dir: Path) -> None:
    parts, _ = surfaces(run_dir)
    for part, obstacle in zip(parts, obstacles_of(run_dir), strict=True):
        for t in (0.0, 0.2):
            vertices, normals = part.place(t, np.zeros((3, 3)))
            gaps = obstacle.gaps(t, vertices.T, np.full_like(vertices.T, 1e-12))
            assert gaps.max() < 1e-9
            # planes are slabs, cylinders have ends, triangles no thickness: parts lie within
            within = {"floor": np.inf, "drum": np.inf, "bowl": 0.01}.get(obstacle.name, 0.0)
            assert gaps.min() > -within - 1e-9
            assert (gaps > -1e-9 - min(within, 0.01)).sum() >= 4
            assert np.abs(np.linalg.norm(normals, axis=1) - 1.0).max() < 1e-12


def test_surfaces_are_closed_and_turned_outwards(run_dir: Path) -> None:
    for part in surfaces(run_dir)[0]:
        vertices, normals = part.place(0.1, np.zeros((3, 3)))
        corners = vertices[part.faces]
        area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        total = np.linalg.norm(area, axis=1).sum()
        assert np.abs(area.sum(axis=0)).max() < 1e-12 * total
        assert ((area * normals[part.faces[:, 0]]).sum(axis=1) >= -1e-12 * total).all()


def test_a_ball_has_the_volume_of_a_ball(run_dir: Path) -> None:
    part = surfaces(run_dir)[0][1]
    corners = part.place(0.0, np.zeros((3, 3)))[0][part.faces] - np.array([1.0, 0.0, -1.0])
    volume = np.linalg.det(corners).sum() / 6
    # an inscribed polyhedron lacks the square of the step between its meridians
    assert volume == pytest.approx(4 / 3 * np.pi * 0.4**3, rel=(2 * np.pi / 48) ** 2)


def test_pictures_have_room_for_what_is_bounded(run_dir: Path) -> None:
    parts, framing = surfaces(run_dir)
    for part in (parts[1], parts[3], parts[4]):
        seen = framing.seen(part.place(0.2, np.zeros((3, 3)))[0], 0)
        assert np.abs(seen[:, 1]).max() < framing.half_height


def obstacles_of(run_dir: Path) -> list[Obstacle]:
    scene = make_scene(load(run_dir / SCENARIO_FILE))
    return [make_obstacle(scene, index) for index in range(len(scene.scenario.obstacles))]


def extent(part: RigidPart) -> FloatArray:
    return np.ptp(part.vertices, axis=0)


def test_planes_and_cylinders_reach_across_the_picture(run_dir: Path) -> None:
    parts, framing = surfaces(run_dir)
    assert extent(parts[0])[:2].min() > 2 * framing.half_height
    assert extent(parts[2])[2] > 2 * framing.half_height
