"""A hardware log replayed: a robot of two limbs that shape-memory wires bend, seen by a camera."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from cli_call import call
from limb_log import EDGES, FRAMES, LENGTH, LOG, curvatures, marked, posed, replay, seen, table

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


@pytest.mark.slow
def test_two_curvatures_of_each_frame_are_fitted_to_its_tags(call: Any) -> None:
    """By the command, every 13th frame: with the whole log it takes many minutes."""
    some = slice(None, None, 13)
    start = 2.0 * np.tan(np.radians(LOG.bends[some]) / EDGES) / (LENGTH / EDGES)
    off = {}
    for count in (9, 8):
        data = table(Path("tags.csv"), LOG.tags[some], count=count)
        fit = [{"of": f"actuation[{limb}].value.table[*][1]"} for limb in (0, 1)]
        Path("log.yaml").write_text(json.dumps(replay(start) | {"calibrate": {"fit": fit, "data": [data]}}))
        done = call("calibrate", "log.yaml", "-o", f"fit{count}", "--no-dt-check", "--json", "-q")
        assert done.code == 0, done.stderr
        model = marked(shapes(yaml.safe_load((Path(f"fit{count}") / "fitted.yaml").read_text())))
        # the camera is that of the tags that were fitted
        factor, offset = posed(model[:, :count], seen()[some, :count])
        off[count] = 1e3 * np.abs(factor * seen()[some] + offset - model)
    # mean distances [mm]: of the tip, of all tags, and of a tip that was not fitted
    assert off[9][:, -1].mean() < 0.7
    assert off[8][:, -1].mean() < 1.8


def fitted_together(count: int, picture: FloatArray, *, camera: bool) -> tuple[FloatArray, FloatArray]:
    """Two curvatures of each of all frames by Gauss-Newton, and the pose of the camera.

    At rest frames do not depend on each other: three runs give the slopes of all.

    Args:
        count: How many tags are fitted.
        picture: All tags, shape (F, 9).
        camera: Whether its pose is sought; if not the picture lies as it is.

    Returns:
        Tags of the model and of the picture as it is laid on it at last, shape (F, 9) [m].
    """
    curvature = 2.0 * np.tan(np.radians(LOG.bends) / EDGES) / (LENGTH / EDGES)
    model, step, frame = marked(shapes(replay(curvature))), 1e-3, np.arange(FRAMES)
    factor, offset = posed(model, picture) if camera else (1.0 + 0.0j, 0.0j)
    for _ in range(4):
        slopes = np.zeros((FRAMES, count, 2 * FRAMES + 4), dtype=complex)
        for k, side in enumerate(np.eye(2)):
            beside = marked(shapes(replay(curvature + step * side)))
            slopes[frame, :, 2 * frame + k] = (beside - model)[:, :count] / step
        for k, column in enumerate((-picture[:, :count], -1j * picture[:, :count], -1.0, -1.0j)):
            slopes[:, :, 2 * FRAMES + k] = column if camera else 0.0
        left = (factor * picture + offset - model)[:, :count].ravel()
        rows = slopes.reshape(len(left), -1)
        change = np.linalg.lstsq(
            np.concatenate((rows.real, rows.imag)), np.concatenate((left.real, left.imag))
        )[0]
        curvature = curvature + change[: 2 * FRAMES].reshape(FRAMES, 2)
        factor += complex(*change[-4:-2])
        offset += complex(*change[-2:])
        model = marked(shapes(replay(curvature)))
    return model, np.asarray(factor * picture + offset)


@pytest.mark.slow
def test_two_curvatures_of_every_frame_of_the_whole_log() -> None:
    """Fitted to all tags; and to all but the tip, which is predicted, seen by the same camera."""
    model, picture = fitted_together(9, seen(), camera=True)
    off = 1e3 * np.abs(picture - model)
    assert off[:, -1].mean() < 0.7
    assert off.mean() == pytest.approx(0.63, abs=0.03)
    model, _ = fitted_together(8, picture, camera=False)
    assert 1e3 * np.abs(picture - model)[:, -1].mean() < 1.8
