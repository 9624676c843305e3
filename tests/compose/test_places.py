"""Selections: all of a scenario resolved once, all bad ones told at once."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from decks import Deck, line, rod_deck
from numpy.testing import assert_array_equal

from dismech_cli import load
from dismech_cli.arrays import IntArray
from dismech_cli.compose.bodies import selection
from dismech_cli.compose.bodies.geometry import Geometry
from dismech_cli.compose.compose import compose
from dismech_cli.compose.scene import make_scene
from dismech_cli.errors import ScenarioError
from dismech_cli.scenario.language.scenario import Scenario
from dismech_cli.scenario.text.problems import ProblemsError
from dismech_cli.scenario.values.selection import NearestSelection, Selection, Selects
from dismech_cli.scenario.values.spec import Spec
from dismech_cli.scenario.views.walk import selections

assert Scenario  # all classes of the language are loaded

NOWHERE: Deck = {"box": {"min": [5.0, 5.0, 5.0], "max": [6.0, 6.0, 6.0]}}
TWIST: Deck = {"type": "twist", "where": "rod.end", "angle": 0.1}
DRIVEN: Deck = {
    "dimension": 3,
    "motions": [{"type": "clamp", "where": "rod.start"}, TWIST],
    "masses": [{"where": "rod.end", "mass": 1.0}],
    "forces": [{"type": "point", "where": "rod.end", "force": [0.0, 0.0, 1.0], "follower": True}],
    "output": {"every": 1.0, "probes": {"turn": {"twist": "rod.end"}}},
    "expect": {
        "gap": {
            "probe": {"distance": ["rod.start", "rod.end"]},
            "value": 1.0,
            "tolerance": "1 %",
            "source": "by hand",
        }
    },
}


def written(folder: Path, deck: Deck) -> Path:
    file = folder / "scene.yaml"
    file.write_text(json.dumps(deck, indent=1), encoding="utf-8")
    return file


def refusal(folder: Path, deck: Deck) -> ProblemsError:
    with pytest.raises(ScenarioError) as refused:
        compose(load(written(folder, deck)))
    assert isinstance(refused.value, ProblemsError)
    return refused.value


def test_all_bad_selections_are_told_at_once(tmp_path: Path) -> None:
    deck = DRIVEN | {
        "motions": [{"type": "clamp", "where": "rod.start"}, TWIST | {"where": NOWHERE}],
        "masses": [{"where": {"nodes": {"of": "rod", "indices": [3, 11]}}, "mass": 1.0}],
        "output": {"every": 1.0, "probes": {"lost": {"position": NOWHERE, "component": "x"}}},
    }
    error = refusal(tmp_path, rod_deck(line(11), **deck))
    assert [problem.line().partition(": ")[2] for problem in error.problems] == [
        "motions[1].where: selects no node",
        "masses[0].where: node 11 of 'rod' does not exist; it has 11, counted from 0",
        "output.probes.lost.position: selects no node",
    ]
    # in the order of the file, each with its line and a caret
    lines = [problem.mark.line for problem in error.problems]
    assert lines == sorted(set(lines))
    assert str(error).count("^") >= 3
    for number in lines:
        assert f"scene.yaml:{number}:" in str(error)
        assert f"  {number} | " in str(error)


def test_all_bad_joints_are_told_at_once(tmp_path: Path) -> None:
    joints = [{"type": "hinge", "where": where} for where in ("rod", NOWHERE, "rod.end")]
    error = refusal(tmp_path, rod_deck(line(11), joints=joints))
    assert [problem.line().partition(": ")[2] for problem in error.problems] == [
        "joints[0].where: selects 11 nodes; expected one",
        "joints[1].where: selects no node",
    ]


def test_one_bad_selection_is_one_error(tmp_path: Path) -> None:
    error = refusal(tmp_path, rod_deck(line(11), motions=[{"type": "clamp", "where": NOWHERE}]))
    (problem,) = error.problems
    assert problem.line().endswith("motions[0].where: selects no node")


def test_every_selection_is_resolved_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found: list[tuple[Selects, Selection]] = []

    def counted(
        finds: Selects, find: Callable[[Geometry, Selection], IntArray]
    ) -> Callable[[Geometry, Selection], IntArray]:
        def resolve(geometry: Geometry, where: Selection) -> IntArray:
            found.append((finds, where))
            return find(geometry, where)

        return resolve

    table = {finds: counted(finds, find) for finds, find in selection.SELECT.items()}
    monkeypatch.setattr(selection, "SELECT", table)
    joints = [{"type": "hinge", "where": {"nodes": {"of": "rod", "indices": [5]}}, "release": "twist"}]
    loaded = load(written(tmp_path, rod_deck(line(11), joints=joints, **DRIVEN)))
    compose(loaded)
    written_ones = [(one.finds, one.where) for one in selections(loaded.scenario)]
    assert len(written_ones) == 8
    # seams are between shells
    assert {finds for finds, _ in found} == set(Selects) - {Selects.SEWN}
    assert Counter(id(where) for _, where in found) == Counter(id(where) for _, where in written_ones)


def test_places_are_looked_up_by_what_they_are(tmp_path: Path) -> None:
    places = make_scene(load(written(tmp_path, rod_deck(line(11), **DRIVEN)))).places
    assert_array_equal(places.nodes(("forces", 0, "where")), [10])
    assert_array_equal(places.nodes(("expect", "gap", "probe", "distance", 1)), [10])
    # the end of a rod, as an edge, is the one that ends there
    assert_array_equal(places.edges(("motions", 1, "where")), [9])
    assert_array_equal(places.edges(("output", "probes", "turn", "twist")), [9])
    with pytest.raises(KeyError):
        places.nodes(("motions", 1, "where"))


def test_places_are_those_of_joined_bodies(tmp_path: Path) -> None:
    deck = rod_deck(line(3), motions=[{"type": "clamp", "where": "other.start"}])
    generate = {"shape": "line", "from": [1.0, 0.0, 0.0], "to": [2.0, 0.0, 0.0], "nodes": 3}
    deck["geometry"].append(deck["geometry"][0] | {"name": "other", "generate": generate})
    deck["joints"] = [{"type": "rigid", "nodes": ["rod.end", "other.start"]}]
    scene = make_scene(load(written(tmp_path, deck)))
    assert len(scene.geometry.nodes) == 5
    nodes = scene.places.nodes(("motions", 0, "where"))
    assert_array_equal(nodes, np.intersect1d(*(scene.geometry.body_nodes[name] for name in ("rod", "other"))))


def specs(kind: type[Spec] = Spec) -> Iterator[type[Spec]]:
    """All classes of the language."""
    for below in kind.__subclasses__():
        yield below
        yield from specs(below)


def pieces(annotation: Any) -> Iterator[Any]:
    """Types and marks that an annotation is made of."""
    yield annotation
    yield from getattr(annotation, "__metadata__", ())
    for argument in get_args(annotation):
        yield from pieces(argument)


def test_every_field_of_selections_says_what_they_find() -> None:
    marked = {}
    for kind in specs():
        for name, field in kind.model_fields.items():
            found = [*field.metadata, *pieces(field.annotation)]
            marks = {mark for mark in found if isinstance(mark, Selects)}
            assert len(marks) == (NearestSelection in found), f"{kind.__name__}.{name}"
            if marks:
                marked[kind.__name__, name] = marks.pop()
    assert len(marked) >= 20
    assert {key for key, finds in marked.items() if finds is Selects.EDGES} == {
        ("Twist", "where"),
        ("TurnProbe", "turn"),
        ("TwistProbe", "twist"),
    }
