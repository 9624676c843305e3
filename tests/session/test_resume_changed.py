"""A run gets a later end, or other steps, while it is under way."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import dismech_cli
from dismech_cli.errors import ScenarioError
from dismech_cli.output.manifest import load_manifest
from dismech_cli.output.run_directory import SCENARIO_FILE
from dismech_cli.run.loop import Limits
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed

# 0.3 s is no sum of steps of 10 ms to the last bit, 95 ms is no multiple of the step.
DECK = """
schema_version: 1
name: extended
dimension: 2
materials: {m: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}}
geometry:
  - {type: rod, name: r, material: m, radius: 1 mm,
     generate: {shape: line, from: [0, 0, 0], to: [0.1, 0, 0], nodes: 6}}
motions: [{type: clamp, where: r.start}]
forces: [{type: gravity, acceleration: [0, 0, -9.81]}]
numerics: {integrator: {type: tr_bdf2}, dt: 10 ms, t_end: 0.3 s}
output: {every: 20 ms, probes: {tip: {displacement: r.end, component: z}}}
"""


def ran(folder: Path, name: str, *overrides: str, until: float = np.inf) -> Path:
    deck = folder / "deck.yaml"
    deck.write_text(DECK)
    dismech_cli.simulate(deck, overrides=overrides, limits=Limits(until=until), out=folder / name)
    return folder / name


def go_on(run_dir: Path, *overrides: str, until: str | None = None) -> int:
    return proceed(run_dir, Pause(until, None, 60.0), Silent(), overrides).record.ending.code


def table(run_dir: Path) -> np.ndarray:
    """Columns of numbers but the wall times."""
    rows = [line.split(",") for line in (run_dir / "scalars.csv").read_text().splitlines()]
    keep = [i for i, name in enumerate(rows[0]) if not name.startswith("wall")]
    return np.array([[float(row[i]) for i in keep] for row in rows[1:]])


@pytest.mark.parametrize("first", ["0.3 s", "95 ms", "0.1 s"])
def test_a_finished_run_gets_a_later_end_bit_by_bit(tmp_path: Path, first: str) -> None:
    straight = ran(tmp_path, "straight", "numerics.t_end=0.5 s")
    extended = ran(tmp_path, "extended", f"numerics.t_end={first}")
    assert go_on(extended, until="0.5 s") == 0
    assert_array_equal(table(extended), table(straight))
    with h5py.File(straight / "run.vtkhdf") as a, h5py.File(extended / "run.vtkhdf") as b:
        assert_array_equal(b["VTKHDF/Points"][()], a["VTKHDF/Points"][()])
    manifest = load_manifest(extended)
    assert (manifest.status, manifest.exit_code) == ("done", 0)
    (change,) = manifest.changes
    assert "numerics.t_end=0.5 s" in change
    assert (extended / SCENARIO_FILE).read_text() == (straight / SCENARIO_FILE).read_text()


def test_frames_that_were_a_share_of_the_end_keep_their_interval(tmp_path: Path) -> None:
    run_dir = ran(tmp_path, "run", "output.every=null", "numerics.dt=3 ms")
    assert go_on(run_dir, until="0.6 s") == 0
    assert dismech_cli.load(run_dir / SCENARIO_FILE).scenario.output.every == 0.003
    assert table(run_dir).shape[0] == 201


def test_a_run_is_extended_twice_and_resumed_between(tmp_path: Path) -> None:
    straight = ran(tmp_path, "straight", "numerics.t_end=0.5 s")
    run_dir = ran(tmp_path, "run", "numerics.t_end=0.1 s", until=0.05)
    assert go_on(run_dir) == 0
    assert go_on(run_dir, until="0.3 s") == 0
    assert go_on(run_dir, "numerics.t_end=0.5 s", until="0.4 s") == 0
    assert load_manifest(run_dir).status == "interrupted"
    assert go_on(run_dir) == 0
    assert_array_equal(table(run_dir), table(straight))
    assert len(load_manifest(run_dir).changes) == 2


def test_steps_and_frames_change_from_the_checkpoint_on(tmp_path: Path) -> None:
    run_dir = ran(tmp_path, "run", until=0.1)
    assert go_on(run_dir, "numerics.dt=4 ms", "output.every=10 ms") == 0
    t, dt = table(run_dir)[:, 0], table(run_dir)[:, 1]
    assert_array_equal(np.round(t[:6], 12), [0.0, 0.02, 0.04, 0.06, 0.08, 0.1])
    assert np.diff(t[5:]).max() < 0.0121
    assert dt[6:].max() < 0.0041
    assert len(t) == 6 + 20
    # the changed grid outlives another pause
    again = ran(tmp_path, "again", until=0.1)
    go_on(again, "numerics.dt=4 ms", "output.every=10 ms", until="0.2 s")
    assert go_on(again) == 0
    assert_array_equal(table(again), table(run_dir))


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("materials.m.density=2000", "only numerics, output.every and output.render may change"),
        ("output.probes={}", "only numerics, output.every and output.render may change"),
        ("numerics.kernels=numpy", "only numerics, output.every and output.render may change"),
        ("numerics.integrator={type: static}", "a static run goes over pseudo-time"),
        ("numerics.t_end=50 ms", "the run stands at t = 0.1 s: it cannot end at 0.05 s"),
    ],
)
def test_what_would_change_the_model_is_refused(tmp_path: Path, override: str, message: str) -> None:
    run_dir = ran(tmp_path, "run", until=0.1)
    before = (run_dir / SCENARIO_FILE).read_text()
    with pytest.raises(ScenarioError, match=message):
        go_on(run_dir, override)
    assert (run_dir / SCENARIO_FILE).read_text() == before
    assert go_on(run_dir) == 0


def test_a_finished_run_takes_no_change_but_a_later_end(tmp_path: Path) -> None:
    run_dir = ran(tmp_path, "run")
    assert go_on(run_dir, until="0.2 s") == 0
    assert load_manifest(run_dir).changes == ()
    with pytest.raises(ScenarioError, match="only a later end"):
        go_on(run_dir, "numerics.dt=1 ms")


def test_a_failed_run_goes_on_under_other_settings(tmp_path: Path) -> None:
    blown = "forces: [{type: point, where: r.end, force: [-1e4, 0, 0]}, "
    (tmp_path / "blown.yaml").write_text(
        DECK.replace("forces: [", blown).replace("radius: 1 mm", "radius: 2 mm")
    )
    report = dismech_cli.simulate(tmp_path / "blown.yaml", out=tmp_path / "blown")
    assert report.exit == 3
    assert all(np.isfinite(list(frame.scalars.values())).all() for frame in report.frames)
    go_on(tmp_path / "blown", "numerics.integrator={type: implicit_euler}", "numerics.dt=1 ms")
    assert "implicit_euler" in load_manifest(tmp_path / "blown").changes[0]
    assert np.isfinite(table(tmp_path / "blown")).all()
