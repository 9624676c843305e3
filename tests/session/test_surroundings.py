"""What surrounds a run: damaged and foreign files, folders of killed runs, streams and signals."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from cli_process import Nursery, environment, nursery, swing, wait_until

from dismech_cli.errors import OutputError
from dismech_cli.output.events import read_events

__all__ = ["nursery", "swing"]

ENDLESS = ("--set", "numerics.t_end=1e4", "--set", "output.every=0.1", "--progress", "none")


@pytest.fixture
def paused(nursery: Nursery, swing: Path) -> Path:
    """A run with a checkpoint at a tenth of a second."""
    assert nursery.call(swing, "run", "swing.yaml", "-o", "out", "--until", "0.1 s").code == 0
    return swing / "out"


@pytest.mark.parametrize(
    "damage",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b"\xff\xfe",
        b'{"name": "a"}',
        b'{"name": 1, "run_id": "a", "status": "happy"}',
    ],
)
def test_a_damaged_manifest_is_told_and_nothing_is_lost(nursery, paused, damage):
    (paused / "manifest.json").write_bytes(damage)
    done = nursery.call(paused.parent, "resume", "out")
    assert done.code == 5
    assert "cannot read out/manifest.json: it is damaged" in done.stderr
    assert (paused / "checkpoints").is_dir()


@pytest.mark.parametrize("entry", ['"exit_code": "x"', '"counters": {"steps": "many"}', '"versions": 3'])
def test_a_manifest_of_wrong_kinds_is_damaged(nursery, paused, entry):
    text = (paused / "manifest.json").read_text().rstrip().removesuffix("}")
    (paused / "manifest.json").write_text(f"{text}, {entry}}}")
    done = nursery.call(paused.parent, "resume", "out")
    assert (done.code, "makes no sense" in done.stderr) == (5, True)


def test_damaged_events_are_told_with_their_line(nursery, paused):
    with (paused / "events.jsonl").open("ab") as file:
        file.write(b"not json\n")
    count = (paused / "events.jsonl").read_bytes().count(b"\n")
    with pytest.raises(OutputError, match=f"line {count} is damaged"):
        read_events(paused / "events.jsonl")
    done = nursery.call(paused.parent, "resume", "out")
    assert (done.code, f"events.jsonl: line {count} is damaged" in done.stderr) == (5, True)


def test_stray_files_among_the_checkpoints_are_left_alone(nursery, paused):
    strays = [
        paused / "checkpoints" / name for name in ("checkpoint-9x.npz", "checkpoint-copy.npz", ".x.npz")
    ]
    for stray in strays:
        stray.write_bytes(b"mine")
    assert nursery.call(paused.parent, "resume", "out").code == 0
    assert all(stray.read_bytes() == b"mine" for stray in strays)


def test_a_folder_of_a_run_killed_before_its_manifest_is_as_good_as_empty(nursery, swing):
    for name, more in (("a", ()), ("b", ("--overwrite",))):
        (swing / name).mkdir()
        (swing / name / ".lock").touch()
        (swing / name / ".manifest.4321.json").write_text("{")
        assert nursery.call(swing, "run", "swing.yaml", "-o", name, *more).code == 0
    (swing / "c").mkdir()
    (swing / "c" / ".lock").touch()
    done = nursery.call(swing, "resume", "c")
    assert (done.code, "is no run directory" in done.stderr) == (2, True)


def test_overwrite_leaves_the_manifest_of_other_programs_alone(nursery, swing):
    (swing / "web").mkdir()
    (swing / "web" / "manifest.json").write_text(json.dumps({"name": "extension", "manifest_version": 3}))
    done = nursery.call(swing, "run", "swing.yaml", "-o", "web", "--overwrite")
    assert (done.code, "is not that of a run" in done.stderr) == (5, True)
    assert (swing / "web" / "manifest.json").is_file()


def test_a_run_whose_manifest_is_damaged_can_be_overwritten(nursery, paused):
    (paused / "manifest.json").write_text("{")
    assert nursery.call(paused.parent, "run", "swing.yaml", "-o", "out", "--overwrite").code == 0


def test_no_folder_is_not_the_folder_one_is_in(nursery, swing):
    done = nursery.call(swing, "run", "swing.yaml", "-o", "")
    assert (done.code, "expected the name of a folder" in done.stderr) == (2, True)


def test_resume_until_the_same_time_stops_there_again(nursery, paused):
    done = nursery.call(paused.parent, "resume", "out", "--until", "0.1 s", "--json")
    assert done.code == 0
    assert json.loads(done.stdout)["status"] == "interrupted"
    assert nursery.call(paused.parent, "resume", "out").code == 0


def test_a_closed_terminal_keeps_a_checkpoint(nursery, swing):
    process = nursery.start(swing, "run", "swing.yaml", "-o", "out", *ENDLESS)
    wait_until(lambda: (swing / "out" / "scalars.csv").exists() and (swing / "out" / "run.vtkhdf").exists())
    process.signal(signal.SIGHUP)
    assert process.code() == 128 + signal.SIGHUP
    assert list((swing / "out" / "checkpoints").glob("*.npz"))


def test_closed_standard_output_is_told(swing):
    command = f"{sys.executable} -m dismech_cli run swing.yaml -o out --set numerics.t_end=0.01 >&-"
    done = subprocess.run(
        ["sh", "-c", command], cwd=swing, env=environment(), stderr=subprocess.PIPE, text=True, timeout=60
    )
    assert done.returncode == 5
    assert "cannot write to standard output: it is closed" in done.stderr
    assert json.loads((swing / "out" / "manifest.json").read_text())["status"] == "done"


def test_half_written_files_of_killed_processes_are_removed(nursery, paused):
    half = [
        *(".manifest.4321.json", ".scenario.resolved.4321.yaml", "checkpoints/.checkpoint-000002.4321.npz"),
        *("frames/.000007.4321.vtu", "inputs/.bell.4321.obj", "render/.old.4321.mp4"),
    ]
    kept = [".mine.json", ".notes.4321.txt", "checkpoints/.mine.4321.npz", "render/.young.4321.mp4"]
    for name in (*half, *kept):
        (paused / name).parent.mkdir(exist_ok=True)
        (paused / name).write_bytes(b"half")
    os.utime(paused / "render/.old.4321.mp4", (0, 0))
    done = nursery.call(paused.parent, "resume", "out")
    assert done.code == 0
    assert "removed what a killed process left half written: .manifest.4321.json, " in done.stderr
    assert not any((paused / name).exists() for name in half)
    assert all((paused / name).read_bytes() == b"half" for name in kept)
