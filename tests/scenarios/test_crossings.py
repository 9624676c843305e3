"""Shipped scenes of contact keep to the penetration that they ask for, and nothing passes through anything.

Seen at every step by an oracle that shares no code with what finds contact.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.crossings import KEPT, PAGE, ROUNDING, Seen, page, scenes, seen

QUICK = {"incline", "incline_anchored", "rod_on_floor", "sliding_stop"}
"""They take a second each."""

SCENES = [
    pytest.param(file, id=file.stem, marks=() if file.stem in QUICK else pytest.mark.slow)
    for file in scenes()
]


@pytest.mark.parametrize("file", SCENES)
def test_a_scene(file: Path) -> None:
    found = seen(file)
    assert found.sound
    # that of a run is of steps that were cut, too; that of a barrier counts from where it begins
    assert found.told >= found.deepest - ROUNDING


def test_the_table_has_all_of_them() -> None:
    """And nothing in it passed through anything or was too deep."""
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    assert sorted(kept) == sorted(file.stem for file in scenes())
    assert all(Seen(**one).sound for one in kept.values())
    assert PAGE.read_text(encoding="utf-8") == page(kept)
