"""The library does what the command line does, and says it in arrays."""

from __future__ import annotations

import json
import signal
import sys

import numpy as np
import pytest
import yaml
from cli_call import call
from cli_process import swing
from numpy.testing import assert_array_equal
from threadpoolctl import ThreadpoolController, threadpool_info, threadpool_limits

from dismech_cli import Limits, load, load_text, read, simulate
from dismech_cli.errors import (
    DismechError,
    ExpectationError,
    OutputError,
    ScenarioError,
    SolverError,
    UnfinishedError,
)
from dismech_cli.output.manifest import load_manifest
from dismech_cli.run.sink import Progress
from dismech_cli.session.exit_codes import Exit
from dismech_cli.session.narrator import Silent
from dismech_cli.session.thread_limits import ThreadLimits
from dismech_cli.solve.linear.pardiso import pardiso_available

__all__ = ["call", "swing"]

SHORT = ("numerics.t_end=0.02",)
HOPELESS = ("numerics.newton.max_iterations=1", "numerics.newton.tolerance=1e-12", "numerics.step.max_cuts=2")


class Heard(Silent):
    """Keeps what it is told."""

    __slots__ = ("lines", "steps")

    def __init__(self) -> None:
        object.__setattr__(self, "lines", [])
        object.__setattr__(self, "steps", [])

    def say(self, text: str) -> None:
        self.lines.append(f"say {text}")

    def warn(self, text: str) -> None:
        self.lines.append(f"warn {text}")

    def error(self, text: str) -> None:
        self.lines.append(f"error {text}")

    def detail(self, text: str) -> None:
        self.lines.append(f"detail {text}")

    def progress(self, progress: Progress) -> None:
        self.steps.append(progress)


def test_a_report_is_complete(swing):
    report = simulate(swing / "swing.yaml", overrides=SHORT)
    assert report.exit is Exit.DONE
    assert report.message == ""
    assert report.raise_for_status() is report
    assert next(iter(report.scalars)) == "t"
    assert_array_equal(report.scalars["t"], [frame.t for frame in report.frames])
    for name in ("kinetic", "tip"):
        assert_array_equal(report.scalars[name], [frame.scalars[name] for frame in report.frames])
    assert list(report.probes) == ["tip"]
    tip = report.nodes["beam"][-1]
    rest = report.composition.simulation.topology.rest_positions
    assert_array_equal(
        report.probes["tip"], [frame.positions[tip, 2] - rest[tip, 2] for frame in report.frames]
    )
    # A frame at every step: the expectation watches what the probe shows.
    assert_array_equal(report.watched["tip"].t, report.scalars["t"])
    assert_array_equal(report.watched["tip"].values, report.probes["tip"])
    (verdict,) = report.verdicts
    assert verdict.passed
    assert verdict.measured == report.probes["tip"][-1]
    assert_array_equal(report.positions, report.frames[-1].positions)
    assert report.velocities.shape == report.positions.shape
    speed = np.linalg.norm(report.velocities, axis=1).max()
    assert speed == pytest.approx(report.scalars["max_speed"][-1], rel=1e-14)
    assert speed > 0.0
    assert {"load", "build", "solve", "observe", "write", "total"} <= report.seconds.keys()
    assert report.run_dir is None
    assert sorted(path.name for path in swing.iterdir()) == ["swing.yaml"]


@pytest.mark.parametrize(
    ("overrides", "limits", "code", "error", "message"),
    [
        (HOPELESS, Limits(), Exit.SOLVER, SolverError, "the solver gave up at t = "),
        (
            ("expect.tip.tolerance=1 %",),
            Limits(),
            Exit.EXPECTATION,
            ExpectationError,
            "tip missed: measured -",
        ),
        ((), Limits(wall=1e-9), Exit.INTERRUPTED, UnfinishedError, "the wall-clock limit is reached at t = "),
    ],
)
def test_failures_are_reports_and_errors_on_demand(swing, overrides, limits, code, error, message):
    report = simulate(swing / "swing.yaml", overrides=overrides, limits=limits)
    assert report.exit is code
    assert report.message
    assert len(report.frames) >= 1
    with pytest.raises(error, match=f"^{message}") as caught:
        report.raise_for_status()
    assert isinstance(caught.value, DismechError)
    assert caught.value.exit_code == code


def test_a_pause_that_was_asked_for_is_no_failure(swing):
    report = simulate(swing / "swing.yaml", limits=Limits(until=0.009))
    assert report.raise_for_status().state.t == pytest.approx(0.01)
    assert report.verdicts == ()


def test_every_way_in_gives_the_same_frames(swing, monkeypatch):
    monkeypatch.chdir(swing)
    text = (swing / "swing.yaml").read_text()
    expected = simulate("swing.yaml", overrides=SHORT)
    for scenario, overrides in (
        (swing / "swing.yaml", SHORT),
        (load("swing.yaml", overrides=SHORT), ()),
        (load_text(text, overrides=SHORT), ()),
        (yaml.safe_load(text), SHORT),
    ):
        report = simulate(scenario, overrides=overrides)
        assert len(report.frames) == len(expected.frames) > 1
        for one, other in zip(report.frames, expected.frames, strict=True):
            assert_array_equal(one.positions, other.positions)
    with pytest.raises(ScenarioError, match="while it is loaded"):
        simulate(load("swing.yaml"), profile="draft")
    with pytest.raises(ScenarioError, match="cannot read"):
        simulate(text)


def test_kernels_can_be_chosen(swing):
    report = simulate(swing / "swing.yaml", overrides=("numerics.kernels=auto", *SHORT), kernels="numpy")
    assert report.composition.plan.kernels == "numpy"
    with pytest.raises(ScenarioError, match="expected 'numpy' or 'numba'"):
        simulate(swing / "swing.yaml", kernels="punched cards")


def test_a_directory_is_that_of_the_command_line(call, swing):
    assert call("run", "swing.yaml", "--set", *SHORT, "-o", "one").code == 0
    report = simulate("swing.yaml", overrides=SHORT, out="other")
    assert report.run_dir.name == "other"
    one, other = (sorted(path.name for path in (swing / name).iterdir()) for name in ("one", "other"))
    assert one == other
    with read("one") as a, read("other") as b:
        assert_array_equal(np.asarray(a.positions), np.asarray(b.positions))
        assert_array_equal(np.asarray(b.positions), [frame.positions for frame in report.frames])
        assert b.scalars.keys() == report.scalars.keys()
        for name in b.scalars:
            assert_array_equal(b.scalars[name], report.scalars[name])
    first, second = (json.loads((swing / name / "manifest.json").read_text()) for name in ("one", "other"))
    for key in ("name", "status", "exit_code", "message", "hashes", "plan", "counters"):
        assert first[key] == second[key], key
    assert "results: other" in (swing / "other" / "log.txt").read_text()
    with pytest.raises(OutputError, match="not empty"):
        simulate("swing.yaml", out="other")


def test_a_mapping_leaves_a_run_that_resumes(call, swing):
    deck = yaml.safe_load((swing / "swing.yaml").read_text())
    deck["geometry"][0]["generate"]["from"] = np.zeros(3)
    simulate(deck, out="out", limits=Limits(until=0.05)).raise_for_status()
    done = call("resume", "out")
    assert done.code == 0, done.stderr
    with read("out") as run:
        straight = simulate(deck)
        assert_array_equal(np.asarray(run.positions), [frame.positions for frame in straight.frames])


@pytest.fixture
def attentive():
    """Ctrl-C is heard, also where the tests themselves run in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("attentive")
def test_an_interrupt_is_recorded_and_then_raised(call, swing):
    class Impatient(Silent):
        __slots__ = ()

        def progress(self, progress: Progress) -> None:
            if progress.steps == 3:
                signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        simulate("swing.yaml", out="out", narrator=Impatient())
    manifest = json.loads((swing / "out" / "manifest.json").read_text())
    assert (manifest["status"], manifest["exit_code"]) == ("interrupted", 130)
    assert manifest["counters"]["steps"] == 3
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert call("resume", "out").code == 0
    with pytest.raises(KeyboardInterrupt):
        simulate("swing.yaml", narrator=Impatient())


def test_the_narrator_is_told_and_nothing_is_printed(swing, capfd):
    heard = Heard()
    simulate(swing / "swing.yaml", overrides=(*SHORT, "expect.tip.tolerance=1 %"), narrator=heard)
    assert heard.lines[0].startswith("say plan: planar")
    assert any(line.startswith("detail linear solver: ") for line in heard.lines)
    assert heard.lines[-1] == "error expectation missed: tip"
    assert [p.steps for p in heard.steps] == list(range(1, 11))
    failed = Heard()
    simulate(swing / "swing.yaml", overrides=HOPELESS, narrator=failed)
    assert sum(line.startswith("detail step cut at t = ") for line in failed.lines) == 2
    # Nothing is on disk: nothing can be resumed.
    assert "resume" not in failed.lines[-1]
    assert capfd.readouterr() == ("", "")


def test_what_is_doubtful_is_in_the_report(swing):
    heard = Heard()
    deck = swing / "swing.yaml"
    report = simulate(deck, overrides=(*SHORT, "materials.silicone.youngs_modulus=2"), narrator=heard)
    assert any("softer than jelly" in warning for warning in report.warnings)
    assert [f"warn {warning}" for warning in report.warnings] == [
        line for line in heard.lines if line.startswith("warn ")
    ]


def threads() -> dict[str, int]:
    return {library["filepath"]: library["num_threads"] for library in threadpool_info()}


class Counting(Silent):
    """Looks at the threads of every library after each step."""

    __slots__ = ("seen",)

    def __init__(self) -> None:
        object.__setattr__(self, "seen", [])

    def progress(self, progress: Progress) -> None:
        self.seen.append(threads())


@pytest.fixture
def two_threads(monkeypatch):
    """A process whose libraries take two threads each, without a word in its environment."""
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    solvers = ["pardiso"] if pardiso_available() else []
    with threadpool_limits(2):
        yield ["banded", *solvers]


def test_a_run_takes_one_thread_and_gives_the_others_back(swing, two_threads):
    for solver in two_threads:
        before, narrator = threads(), Counting()
        assert set(before.values()) == {2}
        simulate(
            swing / "swing.yaml", overrides=(*SHORT, f"numerics.linear_solver={solver}"), narrator=narrator
        )
        assert len(narrator.seen) == 10
        assert {count for seen in narrator.seen for count in seen.values()} == {1}
        assert threads() == before


def test_threads_are_given_back_after_an_error(swing, two_threads):
    with pytest.raises(ScenarioError):
        simulate(swing / "swing.yaml", kernels="punched cards")
    assert set(threads().values()) == {2}


def test_the_environment_says_how_many_threads(swing, two_threads, monkeypatch):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3,1")
    narrator = Counting()
    simulate(swing / "swing.yaml", overrides=SHORT, narrator=narrator)
    kinds = {library["filepath"]: library["internal_api"] for library in threadpool_info()}
    for path, count in narrator.seen[-1].items():
        assert count == (3 if kinds[path] == "openblas" else 1)


def test_a_library_loaded_during_the_run_is_limited_too(two_threads, monkeypatch):
    monkeypatch.delitem(sys.modules, "pypardiso", raising=False)
    with ThreadLimits() as limits:
        for library in ThreadpoolController().lib_controllers:
            library.set_num_threads(2)  # as one that has just been loaded
        step = Progress(t=0.1, t_end=1.0, dt=0.1, steps=1, iterations=1)
        limits.progress(step)
        assert set(threads().values()) == {2}
        monkeypatch.setitem(sys.modules, "pypardiso", sys)
        limits.progress(step)
        assert set(threads().values()) == {1}
    assert set(threads().values()) == {2}


def test_the_scenario_in_a_run_directory_names_the_kernels(swing, tmp_path):
    """Run again it gives the same digits, whatever has been compiled since."""
    overrides = ("numerics.kernels=auto", *SHORT)
    report = simulate(swing / "swing.yaml", overrides=overrides, out=tmp_path / "out")
    manifest = load_manifest(tmp_path / "out")
    assert manifest.kernels == report.composition.plan.kernels == "numpy"
    again = load(tmp_path / "out" / "scenario.resolved.yaml")
    assert again.scenario.numerics.kernels == "numpy"
