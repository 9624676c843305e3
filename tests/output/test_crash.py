"""Killed processes and full disks: what was finished stays readable, and the failure is told."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.testing import assert_array_equal
from output_cases import sheet

from dismech_cli.output.read import read
from dismech_cli.output.table import read_table
from dismech_cli.output.vtu import _ENTRY

# One process pays for the imports; each trial is a fork of it that is killed while it writes.
KILLER = """
import json, os, random, signal, sys, time
from pathlib import Path
from output_cases import sheet
from dismech_cli.output.writers import WRITERS, make_writer
import h5py, meshio

folder, trials = Path(sys.argv[1]), int(sys.argv[2])
topology, frames = sheet(frames=400)
for trial in range(trials):
    run_dir = folder / str(trial)
    run_dir.mkdir()
    source, sink = os.pipe()
    child = os.fork()
    if child == 0:
        writers = [make_writer(name, run_dir) for name in sorted(WRITERS)]
        for writer in writers:
            writer.open(topology, {})
        for frame in frames:
            for writer in writers:
                writer.write(frame)
            os.write(sink, b".")
        os._exit(0)
    os.close(sink)
    random.seed(trial)
    finished = len(os.read(source, 1))
    time.sleep(random.uniform(0.0, 0.15))
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    while chunk := os.read(source, 4096):
        finished += len(chunk)
    os.close(source)
    print(json.dumps({"run": str(run_dir), "finished": finished}), flush=True)
"""

TRIALS = 20

FILLER = """
import os, resource, sys, time
from pathlib import Path
from output_cases import sheet
from dismech_cli.errors import OutputError
from dismech_cli.output.writers import make_writer

name, run_dir, limit, batch = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
topology, frames = sheet(frames=3000)
writer = make_writer(name, run_dir)
writer.open(topology, {})
count = 0
try:
    for first in range(0, len(frames), batch):
        writer.write(*frames[first : first + batch])
        count += batch
    print("never full")
except OutputError as error:
    print(count, error, sep="|", flush=True)
    os._exit(error.exit_code)
"""


def run_python(code: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    tests = Path(__file__).parents[1]
    environment = dict(os.environ)
    environment["PYTHONPATH"] = os.pathsep.join([str(tests / "support"), str(tests.parent)])
    environment["OPENBLAS_NUM_THREADS"] = "1"
    command = [sys.executable, "-c", code, *(str(argument) for argument in arguments)]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)


def vtu_entries(run_dir: Path) -> list[tuple[str, str]]:
    text = (run_dir / "series.pvd").read_text()
    assert text.endswith("</Collection>\n</VTKFile>\n")
    return _ENTRY.findall(text)


def frames_readable(name: str, run_dir: Path) -> int:
    """Frames that are whole, each compared with what was written."""
    topology, frames = sheet(frames=1)
    reference = {0: frames[0]}
    if name == "hdf5":
        with read(run_dir) as run:
            count, times = len(run), run.t
            positions = np.asarray(run.positions)
            assert np.asarray(run.field("strain")).shape[0] == count
    elif name == "vtu":
        entries = vtu_entries(run_dir)
        count, times = len(entries), np.array([float(t) for t, _ in entries])
        positions = np.stack([meshio.read(run_dir / file).points for _, file in entries])
    else:
        table, _ = read_table(run_dir / "scalars.csv")
        assert_array_equal(table["kinetic_energy"], np.arange(len(table["t"]), dtype=float))
        assert_array_equal(table["t"], np.arange(len(table["t"])) * 0.1)
        return len(table["t"])
    assert_array_equal(positions[0], reference[0].positions)
    # Every frame is the wave that the case describes; a hole in the file would be flat.
    x, y, _ = topology.rest_positions.T
    expected = 0.008 * np.sin(80 * x + 40 * y - 6 * np.arange(count)[:, None] * 0.1)
    assert_array_equal(positions[:, :, 2], expected)
    assert_array_equal(times, np.arange(count) * 0.1)
    return count


def test_kill_loses_no_finished_frame(tmp_path):
    done = run_python(KILLER, tmp_path, TRIALS)
    assert done.returncode == 0, done.stderr
    trials = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(trials) == TRIALS
    assert len({trial["finished"] for trial in trials}) > 3, "the kills must fall at different moments"
    for trial in trials:
        for name in ("hdf5", "vtu", "csv"):
            assert frames_readable(name, Path(trial["run"])) >= trial["finished"], (name, trial)


def check_full(done: subprocess.CompletedProcess[str], name: str, run_dir: Path, reason: str) -> None:
    assert done.returncode == 5, (done.stdout, done.stderr)
    count, message = done.stdout.strip().split("|")
    assert int(count) > 0
    assert str(run_dir) in message
    assert reason in message
    assert frames_readable(name, run_dir) == int(count)


@pytest.mark.skipif(sys.platform == "win32", reason="no file size limit on Windows")
@pytest.mark.parametrize("limit", [700_000, 703_001])
def test_file_size_limit_is_an_output_error(tmp_path, limit):
    check_full(run_python(FILLER, "hdf5", tmp_path, limit, 1), "hdf5", tmp_path, "size limit")


@pytest.mark.skipif(sys.platform == "win32", reason="no file size limit on Windows")
def test_of_frames_that_are_written_together_those_with_room_are_kept(tmp_path):
    done = run_python(FILLER, "hdf5", tmp_path, 700_000, 3000)
    assert done.returncode == 5, (done.stdout, done.stderr)
    alone = tmp_path / "alone"
    alone.mkdir()
    check_full(run_python(FILLER, "hdf5", alone, 700_000, 1), "hdf5", alone, "size limit")
    assert frames_readable("hdf5", tmp_path) == frames_readable("hdf5", alone)


@pytest.mark.skipif(sys.platform == "win32", reason="no file size limit on Windows")
def test_file_size_limit_stops_the_table(tmp_path):
    check_full(run_python(FILLER, "csv", tmp_path, 5_000, 1), "csv", tmp_path, "size limit")


@pytest.mark.skipif(sys.platform == "win32", reason="no file size limit on Windows")
def test_file_size_limit_stops_the_series(tmp_path):
    # A frame has 22 kB, so that the list of the series reaches the limit first.
    check_full(run_python(FILLER, "vtu", tmp_path, 30_000, 1), "vtu", tmp_path, "size limit")


@pytest.fixture
def small_disk(tmp_path):
    mount = ["mount", "-t", "tmpfs", "-o", "size=1200k", "tmpfs", str(tmp_path)]
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        pytest.skip("mounting a small disk needs root")
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("this system does not let root mount a small disk")
    yield tmp_path
    subprocess.run(["umount", "-l", str(tmp_path)], check=True)


@pytest.mark.parametrize("name", ["hdf5", "vtu", "csv"])
def test_full_disk_is_an_output_error(small_disk, name):
    if name == "csv":
        (small_disk / "ballast").write_bytes(bytes(1_200_000))
    check_full(run_python(FILLER, name, small_disk, 0, 1), name, small_disk, "disk is full")
