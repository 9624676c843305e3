"""Profiles of shipped scenes come from their studies, which are kept as data."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from benchmarks.scene_trade import (
    ACCURATE,
    DRAFT,
    FOLDER,
    README,
    SCENARIOS,
    Run,
    Trade,
    gallery,
    read,
    told,
    with_profiles,
)
from dismech_cli import load

FILES = sorted(FOLDER.glob("*.json"))


def run(integrator: str, factor: float, error: float | None, cpu: float) -> Run:
    counts = {"steps": 1, "iterations": 1, "cuts": 0, "memory": None}
    return Run(integrator=integrator, factor=factor, status="done", error=error, cpu=cpu, **counts)


def test_a_run_more_doubtful_than_the_scene_is_no_draft() -> None:
    doubtful = replace(run("implicit_euler", 4.0, 0.01, 1.0), doubts=1)
    finer = [run("implicit_euler", 2.0, 0.01, 2.0), run("implicit_euler", 1.0, 0.01, 4.0)]
    assert trade(doubtful, *finer).draft.factor == 2.0
    assert trade(doubtful, *(replace(one, doubts=1) for one in finer)).draft.factor == 4.0


def trade(*runs: Run) -> Trade:
    return Trade(scene="x.yaml", integrator="implicit_euler", keys={}, dt=0.01, t_end=1.0, runs=runs)


def test_the_draft_is_the_cheapest_within_its_error_and_so_are_finer_ones() -> None:
    one = trade(
        run("implicit_euler", 4.0, 0.05, 1.0),
        run("implicit_euler", 2.0, 0.2, 2.0),
        run("implicit_euler", 1.0, 0.04, 4.0),
        run("implicit_euler", 0.5, 0.02, 8.0),
        run("tr_bdf2", 4.0, 0.09, 3.0),
        run("tr_bdf2", 2.0, 0.009, 6.0),
    )
    assert (one.draft.integrator, one.draft.factor) == ("tr_bdf2", 4.0)
    assert one.profile(one.draft) == {"numerics": {"integrator": {"type": "tr_bdf2"}, "dt": "40 ms"}}
    assert (one.accurate.integrator, one.accurate.factor) == ("tr_bdf2", 2.0)


def test_a_scene_that_nothing_cheaper_keeps_is_its_own_draft() -> None:
    one = trade(run("implicit_euler", 2.0, None, 1.0), run("implicit_euler", 1.0, 0.3, 4.0))
    assert one.draft is one.normal
    assert one.profile(one.draft) == {"numerics": {"integrator": {"type": "implicit_euler"}, "dt": "10 ms"}}
    # nothing is accurate: what errs least
    assert one.accurate is one.normal


def test_profiles_take_the_place_of_others() -> None:
    text = "name: a\nprofiles:\n  # why\n  draft: {}\n\noutput: {}\n"
    section = "profiles:\n  draft: {numerics: {dt: 1 ms}}\n"
    made = with_profiles(text, section)
    assert yaml.safe_load(made) == {
        "name": "a",
        "profiles": {"draft": {"numerics": {"dt": "1 ms"}}},
        "output": {},
    }
    assert with_profiles(made, section) == made
    assert "# why" not in made


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_profiles_are_those_of_the_study(file: Path) -> None:
    one = read(file)
    scene = SCENARIOS / one.scene
    assert told(one) in scene.read_text(encoding="utf-8")
    written = yaml.safe_load(scene.read_text(encoding="utf-8"))["profiles"]
    assert written == {"draft": one.profile(one.draft), "accurate": one.profile(one.accurate)}
    numerics = load(scene).scenario.numerics
    # the study is of the scene that is shipped
    own = {"type": one.integrator, **one.keys}
    assert numerics.integrator.model_dump(exclude_defaults=True) == own
    assert (numerics.dt, numerics.t_end) == (one.dt, one.t_end)
    for profile, chosen in (("draft", one.draft), ("accurate", one.accurate)):
        made = load(scene, profile=profile).scenario.numerics
        same = own if chosen.integrator == one.integrator else {"type": chosen.integrator}
        assert made.integrator.model_dump(exclude_defaults=True) == same
        assert made.dt == pytest.approx(one.dt * chosen.factor)
    if one.draft is not one.normal:
        assert one.draft.error is not None
        assert one.draft.error <= DRAFT
    if one.accurate.error is not None and one.normal.error is not None:
        assert one.accurate.error <= max(ACCURATE, one.normal.error)


def test_the_gallery_shows_the_trade() -> None:
    assert gallery() in README.read_text(encoding="utf-8")
