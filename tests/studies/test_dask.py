"""A sweep on a Dask scheduler and two workers of this machine, one of which is killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import pytest
from cli_call import call
from cli_process import Nursery, environment, nursery, wait_until
from sweeps import arm, left_over, published, rows_of, timeless

__all__ = ["arm", "call", "nursery"]

SIXTEEN = ("--over", "parameters.E=1 MPa:4 MPa:4", "--over", "parameters.load=4:10:4")

needs_dask = pytest.mark.skipif(
    find_spec("distributed") is None, reason="needs pip install 'dismech[cluster]'"
)


@dataclass(frozen=True)
class Cluster:
    """A scheduler and its workers."""

    address: str
    scheduler: subprocess.Popen[bytes]
    workers: tuple[subprocess.Popen[bytes], ...]

    @property
    def executor(self) -> tuple[str, str]:
        return "--executor", self.address.replace("tcp://", "dask://")


@pytest.fixture
def cluster(arm: Path) -> Iterator[Cluster]:
    file = arm / "scheduler.json"
    options = ("--scheduler-file", str(file), "--no-dashboard")
    path = os.pathsep.join([str(arm / "trouble"), environment()["PYTHONPATH"]])
    more = environment(PYTHONPATH=path, TROUBLE="", SLOWLY="0.3", PYTHONWARNINGS="default")

    def started(module: str, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{module}", *options, *arguments]
        with (arm / f"{module}.log").open("ab") as log:
            return subprocess.Popen(command, env=more, stdout=log, stderr=log, cwd=arm)

    scheduler = started("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
    workers: list[subprocess.Popen[bytes]] = []
    try:
        wait_until(lambda: file.is_file() and file.stat().st_size > 0, timeout=120)
        for name in ("one", "two"):
            given = (
                "--nthreads",
                "1",
                "--no-nanny",
                "--memory-limit",
                "0",
                "--local-directory",
                str(arm / name),
            )
            workers.append(started("dask_worker", *given))
        wait_until(lambda: (arm / "dask_worker.log").read_text().count("Registered to") == 2, timeout=120)
        yield Cluster(json.loads(file.read_text())["address"], scheduler, tuple(workers))
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


@needs_dask
@pytest.mark.slow
def test_a_worker_is_killed_and_every_point_is_published_once(nursery: Nursery, arm: Path, cluster: Cluster):
    sweep = nursery.start(arm, "sweep", "arm.yaml", "-o", "out", *SIXTEEN, *cluster.executor, "-v")
    wait_until(lambda: len(published(arm / "out")) >= 5, timeout=240)
    cluster.workers[0].send_signal(signal.SIGKILL)
    done = sweep.wait(timeout=300)
    assert done.code == 0, done.stderr
    told = [line for line in done.stderr.splitlines() if line.startswith("done: ")]
    assert len(told) == len(set(told)) == 16
    assert len(published(arm / "out")) == len(rows_of(arm / "out")) == 16
    assert not left_over(arm / "out")
    assert not list((arm / "out").glob(".token*"))

    local = nursery.start(arm, "sweep", "arm.yaml", "-o", "local", *SIXTEEN).wait(timeout=300)
    assert local.code == 0, local.stderr
    for part in ("1/2", "2/2"):
        parts = ("-o", "parts", *SIXTEEN, "--resume", "--shard", part)
        assert nursery.start(arm, "sweep", "arm.yaml", *parts).wait(timeout=300).code == 0
    assert timeless(arm / "out") == timeless(arm / "local") == timeless(arm / "parts")
    again = nursery.call(arm, "sweep", "arm.yaml", "-o", "out", *SIXTEEN, *cluster.executor, "--resume")
    assert "16 of 16 points have a result already" in again.stderr


@needs_dask
@pytest.mark.slow
def test_results_come_by_network_and_bad_points_are_told(nursery: Nursery, arm: Path, cluster: Cluster):
    two = ("--over", "numerics.newton.max_iterations=1,100")
    failing = ("--set", "numerics.step.max_cuts=0")
    options = (*two, *failing, *cluster.executor, "--gather")
    done = nursery.start(arm, "sweep", "arm.yaml", "-o", "out", *options).wait(timeout=240)
    assert done.code == 3, done.stderr
    statuses = [row["status"] for row in rows_of(arm / "out")]
    assert statuses == ["failed", "done"]
    assert len(list((arm / "out").glob("points/*/run.vtkhdf"))) == 2
    assert not left_over(arm / "out")


@needs_dask
@pytest.mark.slow
def test_a_signal_stops_what_workers_run(nursery: Nursery, arm: Path, cluster: Cluster):
    sweep = nursery.start(arm, "sweep", "arm.yaml", "-o", "out", *SIXTEEN, *cluster.executor)
    wait_until(lambda: published(arm / "out"), timeout=240)
    sweep.signal(signal.SIGINT)
    done = sweep.wait(timeout=60)
    assert done.code == 130, done.stderr
    count = len(published(arm / "out"))
    wait_until(lambda: not left_over(arm / "out"), timeout=30)
    assert len(published(arm / "out")) <= count + 2
    assert count < 16


@needs_dask
@pytest.mark.slow
def test_a_lost_scheduler_breaks_no_point(nursery: Nursery, arm: Path, cluster: Cluster):
    sweep = nursery.start(arm, "sweep", "arm.yaml", "-o", "out", *SIXTEEN, *cluster.executor)
    wait_until(lambda: published(arm / "out"), timeout=240)
    cluster.scheduler.kill()
    done = sweep.wait(timeout=120)
    assert done.code == 130, done.stderr
    assert "the Dask scheduler is gone: --resume goes on" in done.stderr
    for worker in cluster.workers:
        worker.kill()
        worker.wait()
    assert {row["status"] for row in rows_of(arm / "out")} == {"done"}
    local = nursery.start(arm, "sweep", "arm.yaml", "-o", "out", *SIXTEEN, "--resume").wait(timeout=300)
    assert local.code == 0, local.stderr
    assert len(rows_of(arm / "out")) == 16
    assert not left_over(arm / "out")


@needs_dask
def test_no_scheduler_is_a_message(call, arm: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("dismech_cli.studies.sweep.dask_pool._CONNECT", "0.5s")
    done = call("sweep", "arm.yaml", "-o", "out", *SIXTEEN, "--executor", "dask://127.0.0.1:9")
    assert done.code == 2
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in done.stderr


def test_without_dask_the_extra_is_named(call, arm: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = call("sweep", "arm.yaml", "-o", "out", *SIXTEEN, "--executor", "dask://127.0.0.1:9")
    assert done.code == 2
    assert "pip install 'dismech[cluster]'" in done.stderr
    assert not (arm / "out").exists()
