"""Small frames reach the files together, none later than a moment after it was made."""

from __future__ import annotations

import numpy as np
import pytest
from output_cases import cantilever

from dismech_cli.output import held
from dismech_cli.output.frame import Frame
from dismech_cli.output.read import read
from dismech_cli.output.run_directory import RUN_FILE
from dismech_cli.run.recorder import Recorder
from dismech_cli.run.sink import Progress


@pytest.fixture
def clock(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(held.time, "monotonic", lambda: now[0])
    return now


def frame(nodes: int = 2) -> Frame:
    return Frame(index=0, t=0.0, positions=np.zeros((nodes, 3)))


def test_the_first_is_due_at_once_and_others_after_a_quarter_of_a_second(clock):
    frames = held.Held()
    assert not frames.due
    frames.add(frame())
    assert frames.due
    assert len(frames.take()) == 1
    for _ in range(3):
        clock[0] += 0.08
        frames.add(frame())
        assert not frames.due
    clock[0] += 0.02
    assert frames.due
    assert len(frames.take()) == 3
    assert not frames.due


def test_large_ones_do_not_wait(clock):
    frames = held.Held()
    frames.add(frame())
    frames.take()
    frames.add(frame(nodes=50_000))
    assert frames.due


def test_a_recorder_has_written_all_at_a_checkpoint_a_little_later_and_at_its_end(tmp_path, clock):
    topology, frames = cantilever(frames=8)
    recorder = Recorder(tmp_path, ["hdf5", "csv"], {})
    recorder.open(topology, {})

    def written() -> int:
        with read(tmp_path) as run:
            lines = (tmp_path / "scalars.csv").read_text().splitlines()
            assert len(lines) - 1 == len(run), RUN_FILE
            return len(run)

    recorder.frame(frames[0])
    assert written() == 1
    recorder.frame(frames[1])
    assert written() == 1
    recorder.checkpoint({}, {"state.t": frames[1].t})
    assert written() == 2
    recorder.frame(frames[2])
    recorder.progress(Progress(0.0, 1.0, 0.1, 1, 1))
    assert written() == 2
    clock[0] += 0.25
    recorder.progress(Progress(0.0, 1.0, 0.1, 1, 1))
    assert written() == 3
    for late in frames[3:]:
        recorder.frame(late)
    assert written() == 3
    recorder.close()
    recorder.close()
    assert written() == 8
