"""Seconds of a run by phase add up, whoever worked on it."""

from __future__ import annotations

import json
import time
from itertools import pairwise

import pytest

from dismech_cli.run.loop import Limits
from dismech_cli.run.tally import Stopwatch
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.phases import added, lost
from dismech_cli.session.resume import proceed
from dismech_cli.session.simulate import simulate

SCENE = "scenarios/cantilever.yaml"
STEPPING = {"bind", "solve", "observe", "write", "other"}


def adds_up(seconds):
    """Whether the phases are the total, up to rounding of sums."""
    parts = [value for name, value in seconds.items() if name != "total"]
    return sum(parts) == pytest.approx(seconds["total"], rel=1e-12) and min(parts) >= 0.0


def test_a_stopwatch_books_all_of_its_time():
    watch = Stopwatch()
    tick = watch.book("bind", time.perf_counter())
    watch.book("solve", tick)
    watch.move(0.25 * watch.seconds["solve"], "solve", "contact")
    assert sum(watch.seconds.values()) <= watch.elapsed
    assert watch.seconds["contact"] == pytest.approx(watch.seconds["solve"] / 3.0, rel=1e-12)


def test_phases_are_added_and_what_was_killed_is_told():
    before = {"load": 1.0, "build": 2.0, "solve": 3.0, "total": 6.0}
    assert added(before, {"solve": 1.0, "write": 0.5}) == {
        "load": 1.0,
        "build": 2.0,
        "solve": 4.0,
        "write": 0.5,
        "total": 7.5,
    }
    assert lost(before, 5.0) == {"unrecorded": 2.0}
    assert lost(before, 2.5) == {}


def test_seconds_of_a_run_that_went_on_add_up(tmp_path):
    report = simulate(SCENE, limits=Limits(until=0.02), out=tmp_path / "run")
    assert adds_up(report.seconds)
    assert {"load", "build", "total"} | STEPPING == report.seconds.keys()
    told = [json.loads((tmp_path / "run" / "manifest.json").read_text())["seconds"]]
    for until in ("0.05 s", None):
        proceed(tmp_path / "run", Pause(until, None, 60.0), Silent(), draw=False)
        told.append(json.loads((tmp_path / "run" / "manifest.json").read_text())["seconds"])
    assert all(map(adds_up, told))
    for earlier, later in pairwise(told):
        assert all(later[name] >= earlier[name] for name in earlier)
        assert later["load"] > earlier["load"]
    assert "unrecorded" not in told[-1]


def test_a_killed_run_says_what_nobody_recorded(tmp_path):
    simulate(SCENE, limits=Limits(until=0.02), out=tmp_path / "run")
    file = tmp_path / "run" / "manifest.json"
    manifest = json.loads(file.read_text())
    # as it was while it ran
    manifest |= {"status": "running", "seconds": {"load": 0.25, "build": 0.5}}
    file.write_text(json.dumps(manifest))
    proceed(tmp_path / "run", Pause(None, None, 60.0), Silent(), draw=False)
    seconds = json.loads(file.read_text())["seconds"]
    assert adds_up(seconds)
    assert seconds["unrecorded"] > 0.0
    assert seconds["load"] > 0.25
