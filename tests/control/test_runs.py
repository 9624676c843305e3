"""Sampled loops in runs: samples at their times, nothing hidden, the account right."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml
from control_decks import SCENARIOS, arm, composed, finished, ideal, positions, rmse, s_shape
from numpy.testing import assert_allclose, assert_array_equal

import dismech_cli
from dismech_cli.control.loop import Controls, SampledLoop
from dismech_cli.model.state import State
from dismech_cli.run.loop import Limits, run
from dismech_cli.run.simulation import Simulation
from dismech_cli.scenario.load import load_mapping
from dismech_cli.session.narrator import Silent
from dismech_cli.session.pause import Pause
from dismech_cli.session.resume import proceed
from dismech_cli.session.sinks import Memory

NOISY = {
    "sensors": {"s": {"strain": "curvature_1", "rod": "arm", "noise": 0.1, "delay": 0.02, "seed": 3}},
    "bend": {"sensor": "s", "gains": {"p": 1.0, "i": 10.0}},
}


def followed(simulation: Simulation) -> list[tuple[float, float]]:
    """Times at which the controller is asked, and the first reading then."""
    asked: list[tuple[float, float]] = []

    class Spy:
        def __init__(self, inner: Any) -> None:
            self.inner = inner

        def start(self, n: int) -> Any:
            return self.inner.start(n)

        def sample(self, t: float, y: Any, r: Any, memory: Any) -> Any:
            asked.append((t, float(y[0])))
            return self.inner.sample(t, y, r, memory)

    (loop,) = simulation.controls.loops
    assert isinstance(loop, SampledLoop)
    spied = replace(loop, controller=Spy(loop.controller))
    run(replace(simulation, controls=Controls((spied,))), Memory())
    return asked


@pytest.mark.parametrize("dt", [0.02, 0.01, 0.006, 0.0019])
def test_samples_are_taken_at_their_times_whatever_the_step(dt: float) -> None:
    """Multiples of the period or not: steps end at samples."""
    asked = followed(composed(arm(numerics={"dt": dt})).simulation)
    assert_allclose([t for t, _ in asked], 0.02 * np.arange(20), atol=1e-15)


ADAPTIVE = {"dt": None, "integrator": {"type": "tr_bdf2"}}
"""Steps as long as their error allows."""


@pytest.mark.parametrize("rtol", [1e-2, 1e-4])
def test_steps_that_adapt_end_at_samples_too(rtol: float) -> None:
    deck = arm(numerics=ADAPTIVE | {"step": {"rtol": rtol}})
    assert_allclose([t for t, _ in followed(composed(deck).simulation)], 0.02 * np.arange(20), atol=1e-15)


def test_steps_that_adapt_come_to_the_same_shape() -> None:
    """To what their tolerance allows, over a motion of some millimetres."""
    fixed = finished(load_mapping(arm(numerics={"dt": 0.001, "integrator": {"type": "tr_bdf2"}})))
    adapted = finished(load_mapping(arm(numerics=ADAPTIVE)))
    assert np.ptp(positions(fixed)[:, -1, 2]) > 4e-3
    assert_allclose(positions(adapted)[-1], positions(fixed)[-1], atol=2e-5)


def test_a_cut_step_samples_once() -> None:
    """Newton may take but two iterations at first: steps are cut, samples are not."""
    deck = arm(bend={"target": 30.0}, numerics={"dt": 0.02, "step": {"patience": 2}})
    simulation = composed(deck).simulation
    outcome = run(simulation, Memory())
    assert outcome.counters["cuts"] > 0
    assert_allclose([t for t, _ in followed(simulation)], 0.02 * np.arange(20), atol=1e-15)


def test_the_start_is_when_it_is_said() -> None:
    report = finished(load_mapping(arm(bend={"start": 0.1})))
    command, t = report.probes["command"], report.scalars["t"]
    assert_array_equal(command[t < 0.1 + 1e-9], 0.0)
    assert np.all(command[t > 0.1 + 1e-9] > 0.0)


def test_a_ramp_ends_where_a_step_stands() -> None:
    """At samples a ramp has reached the command that a step has held since the one before."""
    ramp, step = (
        finished(load_mapping(arm(bend={"hold": hold, "gains": {"p": 0.0, "i": 1e-9}})))
        for hold in ("ramp", "step")
    )
    # with next to no feedback the command is the target, reached one period on
    assert_allclose(ramp.probes["command"][1:], 5.0, rtol=1e-6)
    assert_allclose(step.probes["command"][1:], 5.0, rtol=1e-6)
    # implicit Euler over one step per period sees the end of a ramp alone
    one = [
        finished(load_mapping(arm(bend={"hold": hold}, numerics={"dt": 0.02}))) for hold in ("ramp", "step")
    ]
    assert_allclose(positions(one[0]), positions(one[1]), atol=1e-12)


@pytest.mark.parametrize(("hold", "share"), [("ramp", 0.01), ("step", 0.01)])
def test_the_account_of_commands(hold: str, share: float) -> None:
    """What ramps and jumps do is work: without damping by the integrator little is left over."""
    deck = arm(
        bend={"hold": hold, "gains": {"p": 1.0, "i": 10.0}},
        numerics={"dt": 0.002, "integrator": {"type": "implicit_midpoint"}},
    )
    report = finished(load_mapping(deck))
    held = report.scalars["elastic"].max() + report.scalars["kinetic"].max()
    assert np.abs(report.probes["balance"]).max() < share * held


def test_a_rate_is_never_passed() -> None:
    deck = arm(bend={"limits": {"rate": 30.0, "magnitude": 4.0}})
    deck["output"]["probes"]["most"] = {"controller": "bend", "measure": "command", "over": "max"}
    report = finished(load_mapping(deck))
    change = np.abs(np.diff(report.probes["most"])) / np.diff(report.scalars["t"])
    assert change.max() <= 30.0 * (1.0 + 1e-12)
    assert report.probes["most"].max() <= 4.0
    assert change.max() > 29.0


# ---------------------------------------------------------------- resuming


def states(run_dir: Path) -> np.ndarray:
    with h5py.File(run_dir / "run.h5") as file:
        found: list[np.ndarray] = []
        file.visititems(lambda name, one: found.append(one[()]) if name.endswith("state/q") else None)
    return found[0]


def last(run_dir: Path) -> dict[str, np.ndarray]:
    newest = sorted((run_dir / "checkpoints").glob("*.npz"))[-1]
    with np.load(newest) as file:
        return {name: file[name] for name in file.files if name.startswith("state.")}


@pytest.mark.parametrize("until", [0.1, 0.13, 0.35])
@pytest.mark.parametrize("kind", ["sampled", "noisy", "ideal", "adaptive"])
def test_stopped_and_resumed_is_the_same_run_bit_by_bit(tmp_path: Path, kind: str, until: float) -> None:
    deck = {
        "sampled": arm(),
        "noisy": arm(**NOISY),
        "ideal": ideal({"p": 10.0, "i": 50.0}),
        "adaptive": arm(numerics=ADAPTIVE),
    }[kind]
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps(deck))
    dismech_cli.simulate(scene, out=tmp_path / "straight")
    dismech_cli.simulate(scene, out=tmp_path / "stopped", limits=Limits(until=until))
    assert proceed(tmp_path / "stopped", Pause(None, None, 60.0), Silent()).record.ending.code == 0
    straight, resumed = (last(tmp_path / name) for name in ("straight", "stopped"))
    assert straight.keys() == resumed.keys()
    assert any(name.startswith("state.memory.control") for name in straight) == (kind != "ideal")
    for name, values in straight.items():
        assert_array_equal(resumed[name], values)


def test_a_scene_without_controllers_has_no_memory() -> None:
    deck = arm()
    deck["controllers"], deck["output"] = {}, {"every": 0.02}
    deck["actuation"][0]["value"] = 5.0
    simulation = composed(deck).simulation
    state = simulation.start
    assert not state.memory
    assert not state.inputs.size
    assert simulation.controls.act(state, 1.0) is state
    assert "surplus" not in run(simulation, Memory()).state.numbers()


def test_two_runs_of_one_simulation_share_nothing() -> None:
    simulation = composed(arm(**NOISY)).simulation
    first, again = (run(simulation, Memory()).state for _ in range(2))
    assert_array_equal(first.q, again.q)


# ---------------------------------------------------------------- figures


@pytest.mark.slow
def test_the_s_is_held_by_sampled_feedback() -> None:
    """Node RMSE below 1e-5 m after 10 s, and within a tenth of that at half the time step."""
    report = finished(s_shape())
    fine = finished(s_shape("s_shape", "numerics.dt=5 ms"))
    at_end, finer = rmse(report, 10.0)[0], rmse(fine, 10.0)[0]
    assert at_end < 1e-5
    assert finer == pytest.approx(at_end, rel=0.1)
    # the account: work of the ramps, and the damping of implicit Euler
    held = report.scalars["elastic"].max()
    assert np.abs(report.scalars["error"]).max() < 5e-3 * held


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        ("materials.gel.youngs_modulus=0.9 kPa",),
        ("materials.gel.youngs_modulus=1.1 kPa",),
        (
            "sensors.seen.strain=curvature_1",
            "sensors.seen.rod=arm",
            "sensors.seen.noise=0.1 1/m",
            "controllers.bend.sensor=seen",
        ),
    ],
)
def test_the_s_is_held_by_a_robust_gain(change: tuple[str, ...]) -> None:
    """The modulus off by a tenth, or noise of 1e-3 at joints of 10 mm: below 2e-5 m."""
    assert rmse(finished(s_shape("s_shape", *change)), 10.0)[0] < 2e-5


def test_the_s_is_reached_by_ideal_feedback() -> None:
    """Figures of the prototype, at 1, 2 and 3 s; 1e-9 m after 10 s is what the scene itself expects."""
    report = finished(s_shape("s_shape_ideal", "numerics.t_end=3 s"))
    assert_allclose(rmse(report, 1.0, 2.0, 3.0), [1.51e-4, 1.61e-5, 1.37e-6], rtol=0.02)


def test_the_law_of_others_gives_their_figures() -> None:
    """The incremental law on the peer's own gains: its run prints 2.9e-3, 6.6e-4 and 4.8e-4 m."""
    law: dict[str, Any] = {
        "type": "incremental",
        "target": {"shape": {"file": "data/s_shape.csv"}},
        "leak": 0.2,
    }
    bend = law | {"gains": {"p": 10, "i": 5}, "limits": {"rate": 1000}, "period": 0.01}
    length = law | {"gains": {"p": 5, "i": 10}, "limits": {"rate": 2}, "period": 0.01}
    deck = {
        "schema_version": 1,
        "name": "peer",
        "include": ["base/s_shape.yaml"],
        "controllers": {"bend": bend, "length": length},
        "numerics": {"t_end": 3.0},
    }
    report = finished(load_mapping(deck, directory=SCENARIOS))
    # its target is another by 2e-5 m, and what is far from it not yet settled
    assert_allclose(rmse(report, 1.0, 2.0, 3.0), [2.9e-3, 6.6e-4, 4.8e-4], rtol=0.02)


def test_a_state_is_acted_on_only_when_a_sample_is_due() -> None:
    simulation = composed(arm()).simulation
    state = simulation.controls.act(simulation.start, 0.01)
    assert state is not simulation.start
    later = replace(state, t=0.01)
    assert simulation.controls.act(later, 0.02) is later
    again: State = simulation.controls.act(replace(state, t=0.02), 0.03)
    assert again.memory["control.bend.next"][0] == 2.0


def test_an_edge_whose_actuator_saturates_hardly_overshoots() -> None:
    """In fluid so thick that it goes 1 - 1/e of its way in 2 s; the docs show the same scene."""
    text = (Path(__file__).parents[2] / "docs" / "control.md").read_text(encoding="utf-8")
    (block,) = [part for part in re.findall(r"```yaml\n(.*?)```", text, re.DOTALL) if "name: windup" in part]
    deck = yaml.safe_load(block)
    deck["numerics"]["t_end"] = 6.0
    deck["output"] = {
        "every": 0.02,
        "probes": {
            "way": {"displacement": "arm.end", "component": "x"},
            "command": {"controller": "length", "measure": "command"},
        },
    }
    report = finished(load_mapping(deck))
    full = report.probes["command"] > 0.3 - 1e-9
    assert full.sum() * 0.02 > 1.9  # s
    assert 0.02 < report.probes["way"].max() < 0.022
    assert report.probes["way"][-1] == pytest.approx(0.02, rel=0.01)
