"""Bodies that fall in several parts, and parts of them that nothing holds, are told."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from shell_decks import EULER, STATIC, Deck

from dismech_cli.compose.compose import compose
from dismech_cli.scenario.load import load_mapping
from dismech_cli.session.simulate import simulate

SLIT = """\
v 0 0 0
v 0.1 0 0
v 0 0.1 0
v 0.1 0.1 0
v 0.1 0 0
v 0.1 0.1 0
v 0.15 0 0
v 0.15 0.1 0
v 0.2 0 0
v 0.2 0.1 0
f 1 2 4 3
f 5 7 8 6
f 7 9 10 8
"""
"""A strip that a slit cuts through; its larger part comes last."""
BUNDLE = "v 0 0 0\nv 0 0 -1\nv 0 0 -2\nv 1 0 0\nv 1 0 -1\nv 2 0 0\nv 2 0 -1\nl 1 2 3\nl 4 5\nl 6 7\n"
"""Rods beside each other, in one body."""


def _deck(folder: Path, text: str, body: Deck, **keys: Any) -> Deck:
    (folder / "m.obj").write_text(text, encoding="utf-8")
    mesh = {"file": "m.obj"} | body.pop("mesh", {})
    one: Deck = {"name": "b", "material": "rubber", "mesh": mesh} | body
    return {
        "schema_version": 1,
        "name": "parts",
        "materials": {"rubber": {"youngs_modulus": 1e6, "poisson_ratio": 0.3, "density": 1000.0}},
        "geometry": [one],
        "numerics": STATIC,
    } | keys


def _slit(folder: Path, slits: str = "open", **keys: Any) -> Deck:
    mesh = {"slits": slits} if slits == "open" else {"weld": 1e-6}
    return _deck(folder, SLIT, {"type": "shell", "thickness": 2e-3, "mesh": mesh}, **keys)


def _warnings(folder: Path, deck: Deck) -> list[str]:
    found = compose(load_mapping(deck, directory=folder)).plan.warnings
    return [warning.split(": ", 1)[1] for warning in found]


def _at(x: float, kind: str = "clamp") -> Deck:
    return {"type": kind, "where": {"box": {"min": [x - 1e-3, -3, -3], "max": [x + 1e-3, 3, 3]}}}


PARTS = (
    "geometry[0]: 'b' falls in 2 parts that nothing connects; the smallest has 4 nodes (0 to 3; the first at "
    "(0, 0, 0) m): what acts on one does not reach the others; if they belong together, weld the mesh or add "
    "joints"
)


@pytest.mark.parametrize("numerics", [STATIC, EULER])
def test_a_sheet_slit_right_through_is_told(tmp_path: Path, numerics: Deck) -> None:
    held = _slit(tmp_path, motions=[_at(0.0), _at(0.2)], numerics=numerics)
    assert _warnings(tmp_path, held) == [PARTS]
    welded = _slit(tmp_path, "weld", motions=[_at(0.0), _at(0.2)], numerics=numerics)
    assert _warnings(tmp_path, welded) == []


@pytest.mark.parametrize(
    ("x", "part"), [(0.0, "6 nodes (4 to 9; the first at (0.1, 0, 0) m)"), (0.2, "4 nodes (0")]
)
def test_a_part_that_nothing_holds_is_told_in_statics(tmp_path: Path, x: float, part: str) -> None:
    parts, adrift = _warnings(tmp_path, _slit(tmp_path, motions=[_at(x)]))
    assert parts == PARTS
    assert adrift.startswith(f"geometry[0]: nothing holds a part of 'b' with {part}")
    assert " in 6 of the 6 ways to move or turn as a whole: where it rests" in adrift
    moving = _slit(tmp_path, motions=[_at(x)], numerics=EULER)
    assert _warnings(tmp_path, moving) == [PARTS]


def test_a_run_tells_it_and_does_not_stay_silent_where_nothing_resists(tmp_path: Path) -> None:
    pull = {"type": "point", "force": [1e-3, 0.0, 0.0], "where": {"nearest": [0.2, 0.0, 0.0]}}
    short: Deck = {"newton": {"max_iterations": 20}, "step": {"max_cuts": 1}}
    deck = _slit(tmp_path, motions=[_at(0.0)], forces=[pull], numerics=STATIC | short)
    report = simulate(load_mapping(deck, directory=tmp_path))
    assert report.exit == 3
    assert "a part is free to move without resistance" in report.message


def test_rods_of_one_file_are_counted_and_the_freest_is_named(tmp_path: Path) -> None:
    body: Deck = {"type": "rod", "radius": 2e-3}
    held = {"type": "clamp", "where": {"nearest": [0.0, 0.0, 0.0]}}
    pinned = {"type": "pin", "where": {"nearest": [1.0, 0.0, 0.0]}}
    deck = _deck(tmp_path, BUNDLE, body, motions=[held, pinned])
    parts, adrift = _warnings(tmp_path, deck)
    assert "'b' falls in 3 parts that nothing connects; the smallest has 2 nodes (5 to 6;" in parts
    assert "nothing holds a part of 'b' with 2 nodes (5 to 6; the first at (2, 0, 0) m) in 6 of" in adrift
    assert "as a whole (1 more like it): where" in adrift


def test_contact_may_hold_what_nothing_else_does(tmp_path: Path) -> None:
    floor = {"type": "plane", "name": "floor", "point": [0.0, 0.0, -0.1], "normal": [0.0, 0.0, 1.0]}
    deck = _slit(tmp_path, motions=[_at(0.0)], contact={}, obstacles=[floor])
    assert any("nothing but contact holds a part of 'b'" in told for told in _warnings(tmp_path, deck))
