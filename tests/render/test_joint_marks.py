"""Marks of joints: at their nodes, thicker than the rods, by what passes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, given_section, rod_deck
from numpy.testing import assert_allclose, assert_array_equal

from dismech_cli import load, read, simulate
from dismech_cli.render.joint_marks import joint_marks
from dismech_cli.session.picturing import settings_of


def star(joints: Any, shown: str) -> Deck:
    bodies = [
        {"type": "rod", "name": name, "material": "m", "section": given_section()}
        | {"generate": {"shape": "line", "from": [0.0, 0.0, 0.0], "to": end, "nodes": 4}}
        for name, end in zip("abc", np.eye(3).tolist(), strict=True)
    ]
    return rod_deck(
        {},
        geometry=bodies,
        joints=joints,
        dimension=3,
        motions=[{"type": "clamp", "where": f"{name}.end"} for name in "abc"],
        output={"render": {"joints": shown}},
    )


@pytest.mark.parametrize(
    ("joints", "shown", "marked"),
    [
        ("auto", "shown", ((0, True),)),
        ([{"type": "auto", "join": "hinge"}], "shown", ((0, False),)),
        ("auto", "hidden", ()),
    ],
)
def test_joints_are_marked_by_choice(
    tmp_path: Path, joints: Any, shown: str, marked: tuple[tuple[int, bool], ...]
) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(star(joints, shown)), encoding="utf-8")
    loaded = load(file)
    out = tmp_path / "run"
    simulate(loaded, out=out)
    with read(out) as run:
        settings = settings_of(loaded, run, None)
        assert settings.joints == marked
        marks = joint_marks(run, settings, 1e-3, 8)
    assert len(marks) == len(marked)
    for mark, (node, bends) in zip(marks, marked, strict=True):
        assert_array_equal(mark.nodes, [node])
        # the rods have a radius of 10 mm
        assert_allclose(mark.radius, [0.017])
        assert mark.color is not None
        assert (sum(mark.color) < 300) is bends
