"""Adaptive steps: where they end, what they show, what they resume from, and how accurate they are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from decks import Deck, attempt, given_section, line, rod_deck
from numpy.testing import assert_allclose, assert_array_equal

from benchmarks.adaptive import SCENES, read
from dismech_cli import simulate
from dismech_cli.compose.compose import compose
from dismech_cli.compose.numerics import build_newton
from dismech_cli.errors import ScenarioError
from dismech_cli.laws.laws import Constant, Expression, Law, Ramp, Sine, Table
from dismech_cli.model.saved import Arrays, Numbers
from dismech_cli.output.frame import Frame
from dismech_cli.run.adaptive import Adaptive
from dismech_cli.run.barred import Barred
from dismech_cli.run.looks import within
from dismech_cli.run.loop import End, Limits, run
from dismech_cli.run.pace import find_pace
from dismech_cli.run.recorder import Checkpoint
from dismech_cli.run.sink import Progress
from dismech_cli.scenario.load import load, load_mapping
from dismech_cli.session.changing import moved
from dismech_cli.session.report import Report
from dismech_cli.solve.step import Stepper

TWITCH = Path(__file__).parents[1] / "data" / "twitch.yaml"
SCENARIOS = Path(__file__).parents[2] / "scenarios"
PULSE: Deck = {"table": [[0.3, 0.0], [0.4, 2.0], [0.5, 2.0], [0.6, 0.0]]}


def _twitching(**numerics: Any) -> Deck:
    """A soft arm in thick water that curls up once, as a law with four kinks says."""
    return rod_deck(
        line(11),
        given_section(axial=200.0, mass_per_length=1.0),
        forces=[{"type": "viscous", "coefficient": 2.0}],
        actuation=[{"type": "curvature_1", "rod": "rod", "value": PULSE}],
        numerics={"t_end": 2.0} | numerics,
        output={"every": 0.05, "probes": {"tip": {"position": "rod.end", "component": "z"}}},
    )


def _falling_arm(integrator: str) -> Deck:
    return rod_deck(
        line(9),
        given_section(axial=200.0),
        forces=[{"type": "gravity", "acceleration": [0.0, 0.0, -3.0]}],
        numerics={"integrator": {"type": integrator}, "t_end": 1.0},
        output={"every": 0.03, "probes": {"tip": {"position": "rod.end", "component": "z"}}},
        expect={"low": {"probe": {"position": "rod.end", "component": "z"}, "reduce": "min",
                        "value": -0.35, "tolerance": "50 %", "source": "some way down"}},
    )  # fmt: skip


def test_a_swing_on_a_base_that_travels_takes_the_steps_of_one_that_stands() -> None:
    """Galileo: measured against the way of the base, a swing of a tenth of it would hardly be resolved."""
    still = _falling_arm("tr_bdf2")
    carried = still | {
        "motions": [{"type": "clamp", "where": "rod.start", "displacement": [{"expression": "2*t"}, 0, 0]}],
        "initial_velocity": [{"where": "rod", "velocity": [2, 0, 0]}],
    }
    stands, travels = (simulate(load_mapping(deck)).outcome for deck in (still, carried))
    assert travels.counters["steps"] == stands.counters["steps"]
    assert_allclose(travels.times, stands.times, rtol=1e-6)
    assert_allclose(travels.watched["low"], stands.watched["low"], atol=1e-6)


class Kept:
    """Keeps what a run produces."""

    def __init__(self) -> None:
        self.frames: list[Frame] = []
        self.events: list[str] = []
        self.last: tuple[Arrays, Numbers] | None = None
        self.ends: list[float] = []

    def frame(self, frame: Frame) -> None:
        self.frames.append(frame)

    def event(self, kind: str, t: float, **details: object) -> None:
        self.events.append(kind)

    def checkpoint(self, arrays: Arrays, numbers: Numbers) -> None:
        self.last = arrays, numbers

    def progress(self, progress: Progress) -> None:
        self.ends.append(progress.t)


def _run(deck: Deck, **keys: Any) -> Kept:
    kept = Kept()
    outcome = run(compose(load_mapping(deck)).simulation, kept, **keys)
    assert outcome.end is not End.FAILED, outcome.message
    return kept


# -- where steps end ---------------------------------------------------------------------------------------


def test_steps_end_on_kinks_and_start_small_after_them() -> None:
    kept = _run(_twitching())
    ends = np.array(kept.ends)
    for kink in (0.3, 0.4, 0.5, 0.6, 2.0):
        assert kink in kept.ends
    lengths = np.diff(np.append(0.0, ends))
    for kink in (0.3, 0.4, 0.5, 0.6):
        assert lengths[kept.ends.index(kink) + 1] <= 2.001e-3
    assert lengths.max() > 0.02


LAWS: list[Law] = [Constant(1.0), Ramp(before=0.0, after=1.0, start=0.2, end=0.4)]


def test_jumps_a_rounding_apart_are_one_and_releases_stay_as_they_are() -> None:
    table = Table(times=(0.2 + 1e-12, 0.7), values=(0.0, 1.0))
    pace = find_pace([*LAWS, table], [0.4 - 1e-11, 5.0], 1.0)
    assert_array_equal(pace.events, [0.2, 0.4 - 1e-11, 0.7, 1.0])
    assert pace.next_event(0.2) == 0.4 - 1e-11


def test_a_short_pulse_is_not_stepped_over() -> None:
    pace = find_pace([Expression("exp(-((t - 5)/0.02)**2)")], [], 10.0)
    # far from it nothing holds; at it a quarter of its height, which it climbs within 0.005 s
    assert pace.limit(0.0) > 4.9
    assert 4.9 < pace.limit(4.0) < 5.0
    assert pace.limit(4.98) - 4.98 < 0.015


def test_waves_and_signals_are_resolved() -> None:
    times = np.linspace(0.0, 1.0, 5001)
    signal = Table(times=tuple(times.tolist()), values=tuple(np.sin(40.0 * times).tolist()))
    pace = find_pace([signal], [], 1.0)
    assert_array_equal(pace.events, [1.0])
    assert 0.005 < pace.limit(0.3) - 0.3 < 0.06
    assert find_pace([Sine(amplitude=1.0, frequency=50.0)], [], 1.0).longest == 0.125 / 50.0


# -- what frames show --------------------------------------------------------------------------------------


def test_frames_are_on_their_times_whatever_the_steps() -> None:
    kept = _run(_falling_arm("tr_bdf2"))
    times = np.array([frame.t for frame in kept.frames])
    assert_allclose(times, np.append(0.03 * np.arange(34), 1.0), rtol=1e-12)
    assert not set(times[1:-1].tolist()) & set(kept.ends)


@pytest.mark.slow
@pytest.mark.parametrize("integrator", ["tr_bdf2", "newmark"])
def test_frames_are_as_accurate_as_steps(integrator: str) -> None:
    """Those of TR-BDF2 lie within steps; those of Newmark's method, which rings, end them."""
    deck = _falling_arm(integrator)
    fine = _run(_with(deck, dt=1e-4, step={"adaptive": False}))
    kept = _run(_with(deck, step={"rtol": 1e-4}))
    right, found = (np.stack([frame.positions for frame in one.frames]) for one in (fine, kept))
    errors = np.abs(found - right).max(axis=(1, 2))
    assert errors.max() < 2e-2 * np.abs(right - right[0]).max()
    energies = np.array([frame.scalars["error"] for frame in kept.frames])
    total = max(frame.scalars["kinetic"] for frame in fine.frames)
    assert np.abs(energies).max() < 2e-2 * total


def _with(deck: Deck, **numerics: Any) -> Deck:
    return deck | {"numerics": deck["numerics"] | numerics}


def test_looks_are_in_order_and_end_with_the_step() -> None:
    looks = within(0.1, 0.2, due=0.12, every=0.04)
    times, framed = zip(*looks, strict=True)
    assert_allclose(times, [0.12, 0.125, 0.15, 0.16, 0.175, 0.2], rtol=1e-12)
    assert framed == (True, False, False, True, False, True)
    assert within(0.0, 0.0, due=0.0, every=0.1) == [(0.0, True)]
    assert within(0.0, 0.1, due=0.3, every=0.3)[-1] == (0.1, False)


def test_what_is_asked_before_an_impact_is_read_before_it() -> None:
    """Rods meet at 96 ms; their load at 95 ms, between frames every 2 ms, is not one of both."""
    own = ["numerics.dt=null", "numerics.step={adaptive: true}", "numerics.t_end=0.1 s"]
    loaded = load(SCENARIOS / "crossed_rods.yaml", overrides=own)
    stops = compose(loaded).simulation.control.stops
    assert_allclose(stops.samples, [0.095], rtol=1e-15)
    verdicts = {one.name: one for one in simulate(loaded, kernels="numpy").verdicts}
    assert verdicts["before"].measured == 0.0


# -- accuracy and robustness -------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    "integrator", ["implicit_euler", "implicit_midpoint", "newmark", "generalized_alpha", "tr_bdf2"]
)
def test_errors_fall_with_the_tolerance(integrator: str) -> None:
    """About as its root, and 10 to 100 times as large: what every step may do adds up."""
    short = {"t_end": 0.4}
    exact = _run(_with(_falling_arm("tr_bdf2"), dt=2e-4, **short)).frames
    errors = []
    for rtol in (1e-3, 1e-5):
        last = _run(_with(_falling_arm(integrator), step={"rtol": rtol}, **short)).frames[-1]
        errors.append(np.abs(last.positions - exact[-1].positions).max())
    moved = np.abs(exact[-1].positions - exact[0].positions).max()
    assert errors[0] < 0.1 * moved
    assert errors[1] < min(0.3 * errors[0], 3e-3 * moved)


def test_a_step_that_is_refused_leaves_no_trace() -> None:
    """A first step that is far too long only costs: what follows is as accurate."""
    deck = _falling_arm("tr_bdf2")
    bold = _run(_with(deck, dt=0.1, step={"adaptive": True}))
    plain = _run(deck)
    assert "step_refused" in bold.events
    moved = np.abs(plain.frames[-1].positions - plain.frames[0].positions).max()
    assert_allclose(bold.frames[-1].positions, plain.frames[-1].positions, atol=2e-2 * moved)


def test_a_step_that_is_barely_too_long_stands_and_the_next_one_is_shorter() -> None:
    """To make it again costs more; one that errs half as much again as it may is made again."""
    simulation = compose(load_mapping(_falling_arm("tr_bdf2"))).simulation
    control = simulation.control
    assert isinstance(control, Adaptive)
    stepper = Stepper(simulation.model, simulation.integrator, simulation.newton, simulation.linear_solver)
    result = stepper.step(stepper.prepare(simulation.start), 0.01)
    _, error = control.accuracy.of(result, 0.0, 0.0)

    def erring(size: float) -> Adaptive:
        accuracy = replace(control.accuracy, rtol=control.accuracy.rtol * error / size, _last=[])
        return replace(control, step=0.01, accuracy=accuracy)

    assert erring(1.6).refused(result) is not None
    assert erring(1.4).refused(result) is None
    after = erring(1.4).accepted(result)
    assert after.step < 0.009
    assert after.forced == 0


@pytest.mark.parametrize(("rtol", "tolerance"), [(None, 5e-5), (1e-2, 1e-4), (3e-4, 3e-5), (1e-6, 1e-7)])
def test_newton_is_as_exact_as_steps_are(rtol: float | None, tolerance: float) -> None:
    deck = _with(_falling_arm("tr_bdf2"), step={} if rtol is None else {"rtol": rtol})
    loaded = load_mapping(deck)
    assert build_newton(loaded.scenario.numerics, driven=False, touching=False).tolerance == pytest.approx(
        tolerance
    )
    touching = build_newton(loaded.scenario.numerics, driven=False, touching=True).tolerance
    assert touching == pytest.approx(min(tolerance, 1e-5))
    fixed = load_mapping(_with(_falling_arm("tr_bdf2"), dt=1e-3)).scenario.numerics
    assert build_newton(fixed, driven=False, touching=False).tolerance == 1e-5


def test_a_length_that_failed_is_waited_for_ever_longer() -> None:
    """What fails time and again costs a step in 4, 8, 16 ...; elsewhere it is forgotten."""
    bar = Barred().failed(1.0)
    waits = []
    for _ in range(3):
        waits.append(bar.left)
        for _ in range(bar.left):
            assert bar.allowed(2.0) == 0.8 * bar.length
            assert bar.allowed(0.5) == 0.5
            bar = bar.taken()
        assert bar.allowed(2.0) == 2.0
        bar = bar.failed(1.1 * bar.length)
    assert waits == [4, 8, 16]
    assert bar.failed(0.1).left == 4


def test_steps_that_may_not_be_cut_are_told() -> None:
    deck = _with(_falling_arm("tr_bdf2"), step={"rtol": 1e-7, "dt_min": 0.01})
    outcome = run(compose(load_mapping(deck)).simulation, Kept())
    assert outcome.end is End.DONE
    assert any("numerics.step.dt_min = 0.01 s were less accurate" in doubt for doubt in outcome.doubts)


def test_a_short_push_in_a_long_rest_moves_the_arm(tmp_path: Path) -> None:
    """Fixed steps of a tenth of the pulse see it; so must steps that could be a tenth of the run."""
    push = {"expression": "2*exp(-((t - 20)/0.1)**2)"}
    deck = rod_deck(
        line(5),
        given_section(),
        forces=[{"type": "point", "where": "rod.end", "force": [0.0, 0.0, push]},
                {"type": "viscous", "coefficient": 1.0}],
        numerics={"t_end": 40.0},
        expect={"high": {"probe": {"position": "rod.end", "component": "z"}, "reduce": "max",
                         "value": 0.1, "tolerance": "90 %", "source": "it moves"}},
    )  # fmt: skip
    found = attempt(tmp_path, deck)
    fixed = attempt(tmp_path, deck | {"numerics": {"t_end": 40.0, "dt": 0.01}})
    assert fixed.verdicts[0].measured is not None
    assert fixed.verdicts[0].measured > 0.05
    assert found.verdicts[0].measured == pytest.approx(fixed.verdicts[0].measured, rel=0.02)


# -- resumption --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("integrator", ["implicit_euler", "newmark", "generalized_alpha", "tr_bdf2"])
def test_a_resumed_run_is_the_same_bit_by_bit(integrator: str) -> None:
    deck = _falling_arm(integrator)
    straight = _run(deck)
    before = _run(deck, limits=Limits(until=0.4))
    after = _run(deck, resume_from=before.last)
    frames = before.frames + after.frames
    assert [frame.t for frame in frames] == [frame.t for frame in straight.frames]
    for one, other in zip(frames, straight.frames, strict=True):
        assert_array_equal(one.positions, other.positions)
        assert_array_equal(one.state["v"], other.state["v"])
        for name in ("error", "elastic", "dt", "tip"):
            assert one.scalars[name] == other.scalars[name]
    assert before.ends + after.ends == straight.ends


def test_a_control_comes_back_from_its_numbers() -> None:
    fresh = compose(load_mapping(_falling_arm("tr_bdf2"))).simulation.control
    assert isinstance(fresh, Adaptive)
    moved = replace(fresh, at=0.25, step=0.0125, last=0.7, cut=True, motion=0.3, forced=2)
    stood = moved.failed().failed()
    restored = fresh.restore(stood.arrays(), stood.numbers())
    assert restored.numbers() == stood.numbers()
    assert restored.target == stood.target


# -- language ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("numerics", "message"),
    [
        ({"dt": 0.01, "t_end": 1.0, "step": {"rtol": 1e-3}}, "only adaptive steps have it"),
        ({"t_end": 1.0, "step": {"adaptive": False}}, "fixed steps need it"),
        ({"t_end": 1.0, "step": {"max_cuts": 3}}, "adaptive steps are cut down to 'dt_min'"),
        ({"t_end": 1.0, "step": {"dt_min": 0.1, "dt_max": 0.01}}, "longer than dt_max, 0.01 s"),
        ({"t_end": 1.0, "dt": 0.1, "step": {"adaptive": True, "dt_max": 0.01}}, "longer than dt_max"),
        ({"integrator": {"type": "static"}, "step": {"adaptive": True}}, "a static run has load steps"),
    ],
)  # fmt: skip
def test_keys_that_do_nothing_are_refused(numerics: Deck, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        load_mapping(rod_deck(line(3), numerics=numerics))


@pytest.mark.parametrize("adaptive", [False, True])
def test_a_run_goes_on_with_the_other_kind_of_steps(adaptive: bool) -> None:
    """From where it stands, with the first step of the new kind."""
    decks = [_falling_arm("tr_bdf2"), _with(_falling_arm("tr_bdf2"), dt=1e-3)]
    first, then = decks if not adaptive else decks[::-1]
    last = _run(first, limits=Limits(until=0.4)).last
    assert last is not None
    # a frame each step, so that the sink is told of each
    changed = replace(compose(load_mapping(then)).simulation, frame_every=0.0)
    kept = Kept()
    outcome = run(changed, kept, resume_from=moved(changed, Checkpoint(*last)))
    assert outcome.end is End.DONE
    assert float(last[1]["state.t"]) < kept.ends[0] < float(last[1]["state.t"]) + 2.1e-3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tr_bdf2", pytest.param("generalized_alpha", marks=pytest.mark.slow)])
def test_iterations_on_a_twitch_are_fewer_than_at_fixed_steps(name: str) -> None:
    """At equal error, against the fixed step that has it: at most 0.85 of them."""
    own = f"numerics.integrator={{type: {name}}}"

    def ran(*more: str) -> Report:
        report = simulate(TWITCH, overrides=[own, *more], kernels="numpy")
        assert report.outcome.end is End.DONE
        return report

    tips = ran("numerics.dt=1.25 ms").probes["tip"]

    def error(report: Report) -> float:
        return float(np.sqrt(np.mean((report.probes["tip"] - tips) ** 2)))

    fixed = [ran(f"numerics.dt={dt} ms") for dt in (20, 10, 5)]
    ours = ran("numerics.dt=null", "numerics.step.rtol=1e-3")
    errors = np.log([error(one) for one in fixed])[::-1]
    spent = np.log([one.outcome.counters["iterations"] for one in fixed])[::-1]
    assert errors[0] < np.log(error(ours)) < errors[-1]
    equal = float(np.exp(np.interp(np.log(error(ours)), errors, spent)))
    assert ours.outcome.counters["iterations"] <= 0.85 * equal


def test_what_was_measured_keeps_its_bars() -> None:
    """`python -m benchmarks adaptive`: swings with both integrators; the jellyfish with the default one."""
    measured = read()
    assert len(measured) == 2 * len(SCENES)
    for name, rows in measured.items():
        scene, _, integrator = name.partition(":")
        if (scene, integrator) != ("jellyfish", "generalized_alpha"):
            assert max(row.ratio for row in rows) <= SCENES[scene].bar, name
    assert all(row.ratio <= 1.05 for row in measured["jellyfish:generalized_alpha"])
