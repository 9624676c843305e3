"""What contact tells: fields of force, arrows, the deepest penetration, pairs that come and go."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from contact_decks import MASS, crossing, on_floor
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli import load, read, simulate
from dismech_cli.errors import ScenarioError
from dismech_cli.render.contact_marks import contact_marks
from dismech_cli.run.loop import Limits
from dismech_cli.session.computing import computed_field
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.picturing import settings_of
from dismech_cli.session.resume import proceed

G = 9.8
FIELDS = ["contact_force", "contact_line_load", "contact_pressure"]


def stacked() -> dict[str, Any]:
    """A rod that lies on a sheet, which lies on a floor."""
    return {
        "schema_version": 1,
        "name": "stack",
        "materials": {"m": {"youngs_modulus": 1e7, "poisson_ratio": 0.3, "density": 1200.0}},
        "geometry": [
            {
                "type": "shell",
                "name": "sheet",
                "material": "m",
                "thickness": 2e-3,
                "generate": {
                    "shape": "sheet",
                    "origin": [0.0, 0.0, 1e-3],
                    "length": 0.2,
                    "width": 0.1,
                    "divisions": 3,
                },
            },
            {
                "type": "rod",
                "name": "rod",
                "material": "m",
                "radius": 2e-3,
                "generate": {
                    "shape": "line",
                    "from": [0.02, 0.05, 4e-3],
                    "to": [0.18, 0.052, 4e-3],
                    "nodes": 6,
                },
            },
        ],
        "obstacles": [{"name": "floor", "type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "contact": {
            "pairs": [{"between": ["sheet", "floor"]}, {"between": ["rod", "sheet"]}],
            "friction": {"coefficient": 0.3},
        },
        "forces": [{"type": "gravity", "acceleration": [0, 0, -G]}],
        "numerics": {"integrator": {"type": "implicit_euler"}, "dt": 5e-3, "t_end": 0.4},
        "output": {"every": 0.1, "fields": FIELDS},
    }


def test_fields_add_up_to_the_weights() -> None:
    report = simulate(stacked())
    geometry = report.composition.geometry
    field = report.frames[-1].fields
    rod, sheet = np.pi * 4e-6 * 1200.0 * geometry.lengths.sum() * G, 0.2 * 0.1 * 2e-3 * 1200.0 * G
    # what two bodies do to each other cancels: the floor carries all
    assert_allclose(field["contact_force"].sum(axis=0), [0.0, 0.0, rod + sheet], atol=1e-3 * sheet)
    line = field["contact_line_load"][: len(geometry.edges)]
    assert_allclose(line, np.pi * 4e-6 * 1200.0 * G, rtol=0.01)
    assert_array_equal(field["contact_line_load"][len(geometry.edges) :], 0.0)
    # the sheet bears the rod from above and all of it from below
    pressure = field["contact_pressure"]
    over_area = (pressure[geometry.triangles].mean(axis=1) * geometry.areas).sum()
    assert_allclose(over_area, 2.0 * rod + sheet, rtol=1e-3)
    assert_array_equal(pressure[geometry.body_nodes["rod"]], 0.0)


def test_friction_is_in_the_force() -> None:
    deck = on_floor(5.0)
    deck["output"]["fields"] = ["contact_force"]
    report = simulate(deck)
    assert_allclose(
        report.frames[-1].fields["contact_force"].sum(axis=0), [-0.4 * MASS * G, 0.0, MASS * G], rtol=1e-3
    )


def test_arrows_are_where_forces_are(tmp_path: Path) -> None:
    deck = on_floor(5.0)
    deck["output"] = {"every": 0.1, "fields": ["contact_force"], "render": {"contacts": "shown"}}
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(deck))
    report = simulate(file, out=tmp_path / "run")
    with read(tmp_path / "run") as run:
        settings = settings_of(load(file), run, None)
        (arrows,) = contact_marks(run, settings, 0.5, 8)
        vertices, normals = arrows.place(1.0, run.positions[-1])
        corners = vertices[arrows.faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert ((across * normals[arrows.faces].mean(axis=1)).sum(axis=1) >= 0.0).all()
        tips = vertices.reshape(len(arrows.nodes), -1, 3)[:, -1] - run.positions[-1][arrows.nodes]
    forces = report.frames[-1].fields["contact_force"][arrows.nodes]
    assert_allclose(tips, arrows.scale * forces, atol=1e-12)
    assert 0.05 < np.linalg.norm(tips, axis=1).max() <= 0.15 * (1.0 + 1e-12)


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ({"render": {"contacts": "shown"}}, "contacts: needs 'contact_force' in output.fields"),
        ({"render": {"color_by": "contact_force"}}, "color_by: needs 'contact_force' in output.fields"),
        ({"fields": ["contact_pressure"]}, "'contact_pressure' is a field of shells"),
    ],
)
def test_refused(output: dict[str, Any], message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        dismech_cli.load_mapping(on_floor() | {"output": output})


def test_fields_need_contact() -> None:
    deck = on_floor() | {"obstacles": [], "output": {"fields": ["contact_force"]}}
    del deck["contact"]
    with pytest.raises(ScenarioError, match="needs contact, but the scene has no `contact`"):
        dismech_cli.load_mapping(deck)


def test_they_are_not_made_up_afterwards(tmp_path: Path) -> None:
    """Frames do not tell how stiff contact was: a colour from the wrong stiffness would look right."""
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(on_floor()))
    simulate(file, out=tmp_path / "run")
    with (
        read(tmp_path / "run") as run,
        pytest.raises(ScenarioError, match="add it to 'output: fields' and run again"),
    ):
        computed_field(run, "contact_force", tmp_path / "field.npy")


def test_the_deepest_penetration_and_what_came_and_went(tmp_path: Path) -> None:
    """Told with its pair, place and time, the same in a resumed run."""
    deck = crossing(1e-3, 1.0, stiffness=2e6)
    file = tmp_path / "deck.yaml"
    file.write_text(json.dumps(deck))
    straight = simulate(file, out=tmp_path / "straight")
    found = straight.outcome.penetration
    assert found is not None
    assert found.pair == ("low", "high")
    assert 0.0 < found.share < 0.5
    assert 0.046 < found.t < 0.06
    assert straight.outcome.counters["rebuilds"] >= 1
    simulate(file, limits=Limits(until=0.047), out=tmp_path / "run")
    assert proceed(tmp_path / "run", Pause(None, None, 60.0), Silent(), ()).record.ending.code == 0
    manifests = [json.loads((tmp_path / name / "manifest.json").read_text()) for name in ("straight", "run")]
    assert manifests[0]["penetration"] == manifests[1]["penetration"]
    assert manifests[0]["penetration"]["between"] == ["low", "high"]
    assert manifests[0]["penetration"]["share"] == found.share
    assert manifests[0]["counters"]["rebuilds"] == manifests[1]["counters"]["rebuilds"]
    events = [(tmp_path / name / "events.jsonl").read_text() for name in ("straight", "run")]
    assert events[0] == events[1]
    kinds = [json.loads(line)["kind"] for line in events[0].splitlines()]
    assert kinds.count("contact_rebuilt") == straight.outcome.counters["rebuilds"]
    # the stiffness allows 20 %: beyond that every record is an event
    assert ("penetration" in kinds) == (found.share > 0.2)
