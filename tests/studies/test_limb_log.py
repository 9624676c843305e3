"""A hardware log replayed: a robot of two limbs that shape-memory wires bend, seen by a camera."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_call import call
from limb_log import FRAMES, LOG, curvatures, marked, posed, replay, seen, table

from dismech_cli import simulate
from dismech_cli.arrays import FloatArray
from dismech_cli.scenario.load import load_mapping

__all__ = ["call"]


def shapes(deck: dict[str, Any]) -> FloatArray:
    """Places of the nodes in the plane in all frames [m], shape (F, 49, 2)."""
    frames = simulate(load_mapping(deck)).frames[1:]
    return np.array([frame.positions[:, [0, 2]] for frame in frames])


@pytest.fixture(scope="module")
def published() -> FloatArray:
    return shapes(replay())


def test_the_schedule_gives_the_curvatures_that_it_was_made_for(published: FloatArray) -> None:
    """In all frames; the authors stopped at a sum of 2.5e-3."""
    off = np.abs(curvatures(published) - LOG.curvatures).sum(axis=1)
    assert len(off) == FRAMES
    assert off.max() < 1.05 * 2.5e-3


def test_the_tip_of_odd_frames_is_predicted(published: FloatArray) -> None:
    model, picture = marked(published), seen()
    factor, offset = posed(model[::2], picture[::2])
    off = np.abs(factor * picture + offset - model)
    assert 1e3 * off[1::2, -1].mean() == pytest.approx(3.4, abs=0.2)
    assert 1e3 * off[1::2].mean() == pytest.approx(1.80, abs=0.05)


def test_a_camera_placed_by_even_frames_predicts_the_odd_ones(call: Any) -> None:
    data = table(Path("tags.csv"), LOG.tags, hold_out=2)
    Path("log.yaml").write_text(json.dumps(replay() | {"calibrate": {"fit": [], "data": [data]}}))
    done = call("calibrate", "log.yaml", "-o", "fit", "--json", "-q")
    assert done.code == 0, done.stderr
    (found,) = json.loads(done.stdout)["data"]
    assert 1e3 / found["scale"] == pytest.approx(0.2795, abs=5e-4)
    # root mean square of both coordinates: 1.80 mm is the mean distance
    assert 1e3 * found["held_out_rms"] / found["scale"] == pytest.approx(1.8, abs=0.2)
