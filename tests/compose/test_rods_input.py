"""Rods that cannot be built: one message that points to the key and says what would be right."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from decks import CLAMPED_START, Deck, given_section, line, rod_deck

from dismech_cli import load
from dismech_cli.compose.compose import compose
from dismech_cli.errors import DismechError

SPACE: Deck = {"dimension": 3}


def second(start: list[float]) -> Deck:
    body = rod_deck(line(3))["geometry"][0]
    generate = line(3) | {"from": start, "to": [start[0] + 1.0, 0.0, 0.0]}
    return body | {"name": "other", "generate": generate}


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (
            {"rod": {"natural": {"curvature_1": [0.1, 0.2]}}},
            "natural.curvature_1: 2 values for 9 joints; expected one per joint",
        ),
        (
            SPACE | {"rod": {"director": [2.0, 0.0, 0.0], "bending": "framed"}},
            "director: lies along the first edge of the rod; expected a direction across it",
        ),
        (
            {"rod": {"director": [0.0, 1.0, 1.0], "section": given_section(bending_2=2.0)}},
            "director: in a planar scene a director must lie in the plane or normal to it",
        ),
        ({"rod": {"natural": {"curvature_2": 0.1}}}, "natural.curvature_2: bends out of the plane"),
        (
            {"actuation": [{"type": "curvature_2", "rod": "rod", "value": 1.0}]},
            "actuation[0].type: curvature_2 acts out of the plane of the scene",
        ),
        (
            {"actuation": [{"type": "curvature_1", "rod": "rod", "value": 1.0, "joints": [0, 9]}]},
            "actuation[0].joints: rod 'rod' has 9, counted from 0",
        ),
        (
            SPACE | {"rod": {"bending": "isotropic", "section": given_section(bending_2=2.0)}},
            "bending: isotropic bending is not exact here",
        ),
    ],
)
def test_errors(tmp_path: Path, keys: Deck, message: str) -> None:
    refused(tmp_path, rod_deck(line(10 + 1), **keys), message)


def test_joints_apart(tmp_path: Path) -> None:
    deck = rod_deck(line(11), motions=CLAMPED_START)
    deck["geometry"].append(second([1.5, 0.0, 0.0]))
    deck["joints"] = [{"type": "rigid", "nodes": ["rod.end", "other.start"]}]
    refused(tmp_path, deck, "joints[0].nodes: the two nodes are 0.5 m apart; a joint needs them to coincide")


def refused(folder: Path, deck: Deck, message: str) -> None:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    with pytest.raises(DismechError, match=re.escape(message)):
        compose(load(file))


def test_a_table_of_nodes_may_name_its_columns(tmp_path: Path) -> None:
    (tmp_path / "curve.csv").write_text("x, y, z\n0, 0, 0\n0.5, 0.1, 0\n1, 0, 0\n")
    deck = rod_deck({"shape": "csv", "file": "curve.csv"}, dimension=3)
    file = tmp_path / "scene.yaml"
    file.write_text(json.dumps(deck), encoding="utf-8")
    assert compose(load(file)).geometry.nodes.tolist() == [[0, 0, 0], [0.5, 0.1, 0], [1, 0, 0]]


def test_a_table_of_nodes_is_told_at_its_key(tmp_path: Path) -> None:
    (tmp_path / "curve.csv").write_text("x, y, z\n0, 0, 0\n1, one, 0\n")
    message = f"geometry[0].generate: {tmp_path}/curve.csv:3: column 1: expected a finite number, got 'one'"
    refused(tmp_path, rod_deck({"shape": "csv", "file": "curve.csv"}), message)
