"""Runs that are interrupted, killed, starved of disk or raced: nothing finished is lost."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from cli_process import Nursery, Process, environment, nursery, swing, wait_until
from numpy.testing import assert_array_equal

from dismech_cli.output.events import read_events
from dismech_cli.output.read import read
from dismech_cli.output.table import read_table

__all__ = ["nursery", "swing"]

# A second and more, in which frames reach the files some times.
LONG = ("--set", "numerics.t_end=4.8")
ENDLESS = ("--set", "numerics.t_end=1e4", "--set", "output.every=0.1", "--progress", "none")


def rows(run_dir: Path) -> int:
    file = run_dir / "scalars.csv"
    return file.read_bytes().count(b"\n") - 1 if file.exists() else 0


def manifest(run_dir: Path) -> dict[str, object]:
    return json.loads((run_dir / "manifest.json").read_text())


def assert_same_run(one: Path, other: Path) -> None:
    """Every number of both runs is the same, bit by bit, but the wall time."""
    with read(one) as a, read(other) as b:
        assert len(a) == len(b) > 1
        assert_array_equal(a.t, b.t)
        assert_array_equal(np.asarray(a.positions), np.asarray(b.positions))
        for name in a.topology.state:
            assert_array_equal(np.asarray(a.state(name)), np.asarray(b.state(name)))
        for field in a.topology.fields:
            assert_array_equal(np.asarray(a.field(field.name)), np.asarray(b.field(field.name)))
    first, second = (read_table(run / "scalars.csv")[0] for run in (one, other))
    assert list(first) == list(second)
    for name in first.keys() - {"wall"}:
        assert_array_equal(first[name], second[name], err_msg=name)


@pytest.fixture(scope="module")
def straight(nursery: Nursery, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that nothing disturbs."""
    from cli_process import EXPECT, SWING

    folder = tmp_path_factory.mktemp("straight")
    (folder / "swing.yaml").write_text(SWING + EXPECT)
    done = nursery.call(folder, "run", "swing.yaml", *LONG, "-o", "run")
    assert done.code == 0, done.stderr
    return folder / "run"


def interrupted(nursery: Nursery, folder: Path, number: int) -> Process:
    process = nursery.start(folder, "run", "swing.yaml", *LONG, "-o", "run")
    wait_until(lambda: rows(folder / "run") > 30)
    process.signal(number)
    return process


def test_interrupt_then_resume_is_the_straight_run(nursery, swing, straight):
    done = interrupted(nursery, swing, signal.SIGINT).wait()
    assert done.code == 130, done.stderr
    assert "resume with: dismech resume run" in done.stderr
    record = manifest(swing / "run")
    assert (record["status"], record["exit_code"]) == ("interrupted", 130)
    assert rows(swing / "run") < rows(straight)
    again = nursery.call(swing, "resume", "run")
    assert again.code == 0, again.stderr
    assert "pass" in again.stdout
    assert_same_run(swing / "run", straight)
    assert manifest(swing / "run")["counters"] == manifest(straight)["counters"] | {
        "analyses": manifest(swing / "run")["counters"]["analyses"]
    }


def test_until_then_resume_from_elsewhere_is_the_straight_run(nursery, swing, straight, tmp_path_factory):
    done = nursery.call(swing, "run", "swing.yaml", *LONG, "-o", "run", "--until", "101 ms")
    assert done.code == 0, done.stderr
    with read(swing / "run") as run:
        assert run.t[-1] == pytest.approx(0.102)
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    shutil.move(swing / "run", elsewhere / "moved")
    again = nursery.call(swing, "resume", elsewhere / "moved")
    assert again.code == 0, again.stderr
    assert_same_run(elsewhere / "moved", straight)
    finished = nursery.call(swing, "resume", elsewhere / "moved")
    assert finished.code == 0
    assert "is finished" in finished.stderr


def test_second_interrupt_stops_at_once(nursery, swing):
    process = nursery.start(swing, "run", "swing.yaml", *ENDLESS, "-o", "run")
    wait_until(lambda: rows(swing / "run") > 2)
    # Stopped, the process finds both signals when it goes on: the second falls into the same step.
    process.signal(signal.SIGSTOP)
    process.signal(signal.SIGINT)
    process.signal(signal.SIGTERM)
    process.signal(signal.SIGCONT)
    done = process.wait()
    assert done.code in (130, 143), done.stderr
    assert "stopped at once" in done.stderr
    assert manifest(swing / "run")["status"] == "interrupted"
    assert not (swing / "run" / "checkpoints").exists()
    with read(swing / "run") as run:
        assert len(run) > 2


def test_wall_limit_keeps_a_checkpoint(nursery, swing):
    done = nursery.call(swing, "run", "swing.yaml", *ENDLESS, "-o", "run", "--wall-limit", "300ms")
    assert done.code == 130, done.stderr
    assert "wall-clock limit" in done.stderr
    assert list((swing / "run" / "checkpoints").iterdir())
    # The limit is that of one process: the continuation gets its own.
    before = rows(swing / "run")
    again = nursery.call(swing, "resume", "run", "--progress", "none", "--wall-limit", "300ms")
    assert again.code == 130
    assert rows(swing / "run") > before


def check_kills(nursery: Nursery, folder: Path, straight: Path, trials: int) -> None:
    counts = set()
    for trial in range(trials):
        run_dir = folder / str(trial)
        process = nursery.start(
            folder, "run", "swing.yaml", *LONG, "-o", run_dir.name, "--checkpoint-every", "100ms"
        )
        wait_until(lambda: rows(run_dir) > 0)  # noqa: B023 - called at once
        time.sleep(random.Random(trial).uniform(0.0, 0.8))
        finished = rows(run_dir)
        process.signal(signal.SIGKILL)
        code = process.wait().code
        assert code == -signal.SIGKILL or rows(run_dir) == rows(straight)
        with read(run_dir) as run, read(straight) as reference:
            assert len(run) >= finished
            counts.add(len(run))
            assert_array_equal(np.asarray(run.positions), reference.positions[: len(run)])
        done = nursery.call(folder, "resume", run_dir.name, "--progress", "none")
        assert done.code == 0, done.stderr
        assert_same_run(run_dir, straight)
    assert len(counts) > min(trials // 2, 10), "the kills must fall at different moments"


def test_kill_loses_no_finished_frame_and_resumes(nursery, swing, straight):
    check_kills(nursery, swing, straight, trials=5)


@pytest.mark.slow
def test_fifty_kills(nursery, swing, straight):
    check_kills(nursery, swing, straight, trials=50)


def test_killed_before_the_first_checkpoint_starts_again(nursery, swing, straight):
    process = nursery.start(swing, "run", "swing.yaml", *LONG, "-o", "run")
    wait_until(lambda: rows(swing / "run") > 5)
    process.signal(signal.SIGKILL)
    process.wait()
    assert manifest(swing / "run")["status"] == "running"
    again = nursery.call(swing, "resume", "run")
    assert again.code == 0, again.stderr
    assert "starting again" in again.stderr
    assert_same_run(swing / "run", straight)


def test_disk_full_ends_with_5_and_keeps_the_frames(nursery, swing):
    process = nursery.start(swing, "run", "swing.yaml", *ENDLESS, "-o", "run", file_limit=600_000)
    done = process.wait()
    assert done.code == 5, done.stderr
    assert "file size limit" in done.stderr
    assert "Traceback" not in done.stderr
    assert manifest(swing / "run")["exit_code"] == 5
    with read(swing / "run") as run:
        assert len(run) > 5
        assert np.isfinite(np.asarray(run.positions)).all()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_full_standard_output_ends_with_5(nursery, swing):
    process = nursery.start(swing, "schema", stdout=Path("/dev/full"))
    assert process.code() == 5
    assert "standard output" in process.stderr()


def test_two_runs_at_once_get_two_directories(nursery, swing):
    processes = [nursery.start(swing, "run", "swing.yaml", "-q") for _ in range(2)]
    done = [process.wait() for process in processes]
    assert [d.code for d in done] == [0, 0]
    first, second = (swing / d.stdout.strip() for d in done)
    assert first != second
    assert_same_run(first, second)


def test_a_directory_in_use_is_left_alone(nursery, swing):
    process = nursery.start(swing, "run", "swing.yaml", *ENDLESS, "-o", "run")
    wait_until(lambda: rows(swing / "run") > 0)
    for command in (
        ("run", "swing.yaml", "-o", "run", "--overwrite"),
        ("resume", "run"),
    ):
        done = nursery.call(swing, *command)
        assert done.code == 5
        assert "another process is writing" in done.stderr
    process.signal(signal.SIGTERM)
    assert process.wait().code == 143


@pytest.fixture
def nobody() -> Iterator[int]:
    """The writing end of a pipe whose reader is gone."""
    source, sink = os.pipe()
    os.close(source)
    yield sink
    os.close(sink)


def test_closed_pipe_is_quiet(nobody):
    command = [sys.executable, "-m", "dismech_cli", "schema"]
    done = subprocess.run(command, env=environment(), stdout=nobody, stderr=subprocess.PIPE, check=False)
    assert (done.returncode, done.stderr) == (141, b"")


def test_nobody_reading_the_progress_does_not_stop_a_run(swing, nobody):
    command = [sys.executable, "-m", "dismech_cli", "run", "swing.yaml", "-o", "run", "--progress", "lines"]
    done = subprocess.run(
        command, cwd=swing, env=environment(), stdout=subprocess.PIPE, stderr=nobody, text=True, check=False
    )
    assert done.returncode == 0
    assert done.stdout.splitlines()[-1] == "run"


def test_damaged_newest_checkpoint_falls_back(nursery, swing, straight):
    interrupted(nursery, swing, signal.SIGINT).wait()
    folder = swing / "run" / "checkpoints"
    newest = max(folder.iterdir())
    shutil.copy(newest, folder / "checkpoint-000099.npz")
    with (folder / "checkpoint-000099.npz").open("r+b") as file:
        file.seek(200)
        file.write(b"\x00" * 64)
    assert nursery.call(swing, "resume", "run").code == 0
    assert_same_run(swing / "run", straight)


def test_unreadable_checkpoints_are_told(nursery, swing):
    interrupted(nursery, swing, signal.SIGINT).wait()
    for file in (swing / "run" / "checkpoints").iterdir():
        file.write_bytes(b"not a checkpoint")
    done = nursery.call(swing, "resume", "run")
    assert done.code == 5
    assert "damaged" in done.stderr
    assert "Traceback" not in done.stderr


def test_another_scenario_is_refused_with_the_difference(nursery, swing):
    nursery.call(swing, "run", "swing.yaml", "-o", "run", "--until", "0.05")
    file = swing / "run" / "scenario.resolved.yaml"
    file.write_text(file.read_text().replace("2000000.0", "3000000.0"))
    done = nursery.call(swing, "resume", "run")
    assert done.code == 2
    assert "another scenario" in done.stderr
    assert any(line.strip().startswith("-") and "2000000.0" in line for line in done.stderr.splitlines())
    assert any(line.strip().startswith("+") and "3000000.0" in line for line in done.stderr.splitlines())


def test_a_failing_solver_ends_with_3_and_can_be_resumed(nursery, swing):
    wishes = ("newton.max_iterations=1", "newton.tolerance=1e-12", "step.max_cuts=2")
    hopeless = [part for wish in wishes for part in ("--set", f"numerics.{wish}")]
    done = nursery.call(swing, "run", "swing.yaml", "-o", "run", *hopeless)
    assert done.code == 3, done.stderr
    for text in ("the solver gave up at t =", "last steps", "advice:", "resume with: dismech resume run"):
        assert text in done.stderr
    assert "Traceback" not in done.stderr
    assert manifest(swing / "run")["exit_code"] == 3
    assert [event["kind"] for event in read_events(swing / "run" / "events.jsonl")].count("step_cut") == 2
    with read(swing / "run") as run:
        assert len(run) >= 1
    again = nursery.call(swing, "resume", "run")
    assert again.code == 3
