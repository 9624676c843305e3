"""The program in processes of its own, at the price of one start-up for many.

A nursery process imports everything once and forks a child for each command line; the child calls the
entry point of the program, so signals, exit codes and the end of the interpreter are the real ones.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

NURSERY = """
import json, os, resource, signal, sys
import h5py
import matplotlib.backends.backend_svg, matplotlib.figure
import dismech_cli.output.writers, dismech_cli.session.start, dismech_cli.session.resume
import dismech_cli.studies.sweep.sweep
from dismech_cli.cli.app import main

def become(job):
    os.setsid()
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # which tests under nohup would ignore
    for number, name, flags in (
        (0, os.devnull, os.O_RDONLY),
        (1, job["stdout"], os.O_WRONLY | os.O_CREAT | os.O_APPEND),
        (2, job["stderr"], os.O_WRONLY | os.O_CREAT | os.O_APPEND),
    ):
        os.dup2(os.open(name, flags), number)
    os.chdir(job["folder"])
    os.environ.update(job["environment"])
    if job["file_limit"]:
        resource.setrlimit(resource.RLIMIT_FSIZE, (job["file_limit"], job["file_limit"]))
    sys.argv = ["dismech", *job["arguments"]]
    main()

for line in sys.stdin:
    job = json.loads(line)
    if "wait" in job:
        print(os.waitstatus_to_exitcode(os.waitpid(job["wait"], 0)[1]), flush=True)
        continue
    child = os.fork()
    if child == 0:
        break
    print(child, flush=True)
else:
    sys.exit()
become(job)
"""


def environment(**more: str) -> dict[str, str]:
    """The environment of a process that finds this checkout, without terminal or thread settings."""
    ours = {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1", "PYTHONWARNINGS": "error"}
    kept = {k: v for k, v in os.environ.items() if not k.endswith("_NUM_THREADS") and k != "MKL_CBWR"}
    return kept | ours | more


@dataclass(frozen=True)
class Done:
    """A process that ended."""

    code: int
    stdout: str
    stderr: str


class Process:
    """A running command line."""

    def __init__(self, nursery: Nursery, pid: int, stdout: Path, stderr: Path) -> None:
        self.pid = pid
        self._nursery, self._stdout, self._stderr = nursery, stdout, stderr

    def signal(self, number: int) -> None:
        os.kill(self.pid, number)

    def code(self, timeout: float = 60.0) -> int:
        timer = threading.Timer(timeout, os.kill, (self.pid, signal.SIGKILL))
        timer.start()
        try:
            return int(self._nursery.ask({"wait": self.pid}))
        finally:
            timer.cancel()

    def stderr(self) -> str:
        return self._stderr.read_text()

    def wait(self, timeout: float = 60.0) -> Done:
        return Done(self.code(timeout), self._stdout.read_text(), self.stderr())


class Nursery:
    """Forks command lines off a process that has imported everything."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", NURSERY],
            env=environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._count = 0

    def ask(self, job: dict[str, object]) -> str:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(job) + "\n")
        self._process.stdin.flush()
        return self._process.stdout.readline()

    def start(
        self,
        folder: Path,
        *arguments: object,
        stdout: Path | None = None,
        file_limit: int = 0,
        **more: str,
    ) -> Process:
        self._count += 1
        out = stdout or folder / f".{self._count}.out"
        err = folder / f".{self._count}.err"
        job = {
            "folder": str(folder),
            "arguments": [str(argument) for argument in arguments],
            "stdout": str(out),
            "stderr": str(err),
            "file_limit": file_limit,
            "environment": more,
        }
        return Process(self, int(self.ask(job)), out, err)

    def call(self, folder: Path, *arguments: object, **more: str) -> Done:
        return self.start(folder, *arguments, **more).wait()

    def close(self) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait(30)
        assert self._process.stdout is not None
        self._process.stdout.close()


@pytest.fixture(scope="session")
def nursery() -> Iterator[Nursery]:
    nursery = Nursery()
    yield nursery
    nursery.close()


def wait_until(condition, timeout: float = 30.0):
    """Poll until ``condition()`` is true, and return it."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        if result := condition():
            return result
        time.sleep(0.005)
    raise AssertionError("timed out")


# A small swinging rod: about a hundred short steps, a frame at each.
SWING = """\
schema_version: 1
name: swing
dimension: 2
materials:
  silicone: {youngs_modulus: 2 MPa, poisson_ratio: 0.5, density: 1200}
geometry:
  - type: rod
    name: beam
    material: silicone
    radius: 1 mm
    generate: {shape: line, from: [0, 0, 0], to: [100 mm, 0, 0], nodes: 11}
motions:
  - {type: clamp, where: beam.start}
forces:
  - {type: gravity, acceleration: [0, 0, -9.81]}
numerics: {dt: 2 ms, t_end: 0.2 s, kernels: numpy}
output:
  every: 2 ms
  probes:
    tip: {displacement: beam.end, component: z}
"""

EXPECT = """\
expect:
  tip:
    probe: {displacement: beam.end, component: z}
    value: -4 cm
    tolerance: 20 cm
    source: anything that falls
"""


@pytest.fixture
def swing(tmp_path: Path) -> Path:
    """A folder with ``swing.yaml``."""
    (tmp_path / "swing.yaml").write_text(SWING + EXPECT)
    return tmp_path
