"""A hardware log replayed: a robot of two limbs that shape-memory wires bend, seen by a camera."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_call import call
from limb_log import ARCS, EDGES, FRAMES, LENGTH, LOG, curvatures, marked, posed, seen
from numpy.testing import assert_allclose

from dismech_cli import load, simulate
from dismech_cli.csv_columns import read_columns

__all__ = ["call"]

SCENARIOS = Path(__file__).parents[2] / "scenarios"


def fitted(call: Any, name: str, *sets: str) -> tuple[dict[str, Any], ...]:
    """What the command says of each table of a scene."""
    words = [word for text in sets for word in ("--set", text)]
    done = call("calibrate", SCENARIOS / f"{name}.yaml", *words, "-o", "fit", "--json", "-q")
    assert done.code == 0, done.stderr
    return tuple(json.loads(done.stdout)["data"])


def test_the_shipped_log_is_the_published_one() -> None:
    names = [f"{letter}_{i}" for i in range(101, 110) for letter in "uv"]
    columns = read_columns(SCENARIOS / "data" / "limb_log.csv", [*names, "limb_1", "limb_2"])
    assert_allclose(np.stack(columns[:18], axis=1), LOG.tags, rtol=1e-8)
    assert_allclose(np.stack(columns[18:], axis=1), LOG.curvatures, rtol=1e-8)
    scene = load(SCENARIOS / "limb_log.yaml").scenario
    for limb, part in enumerate(scene.actuation):
        rows = np.array(part.value.table)  # type: ignore[union-attr]
        assert_allclose(rows[:, 0], (np.arange(FRAMES) + 1.0) / FRAMES, rtol=1e-11)
        bent = 2.0 * np.tan(np.radians(LOG.bends[:, limb]) / EDGES) / (LENGTH / EDGES)
        assert_allclose(rows[:, 1], bent, rtol=1e-8)
    assert scene.calibrate is not None
    assert scene.calibrate.data[0].markers is not None
    assert_allclose(scene.calibrate.data[0].markers.arc, ARCS, atol=1e-7)


def test_the_schedule_gives_what_it_was_made_for_and_predicts_the_tip(call: Any) -> None:
    """In all frames, where its authors stopped at a sum of 2.5e-3; the camera is placed by the even ones."""
    tags, bends = fitted(call, "limb_log")
    together = bends["parts"][-1]
    assert bends["samples"] == 2 * FRAMES
    assert together["worst"] < 1.05 * 2.5e-3
    assert 1e3 / tags["scale"] == pytest.approx(0.2795, abs=5e-4)
    predicted = 1e3 / tags["scale"] * np.array([part["held_out_mean"] for part in tags["parts"]])
    assert predicted[-1] == pytest.approx(3.4, abs=0.2)
    assert predicted.mean() == pytest.approx(1.80, abs=0.05)
    # what the command says is what the frames say, whose balances are solved less exactly
    x = np.array([frame.positions[:, [0, 2]] for frame in simulate(SCENARIOS / "limb_log.yaml").frames[1:]])
    off = np.abs(curvatures(x) - LOG.curvatures).sum(axis=1)
    assert together["worst"] == pytest.approx(off.max(), rel=1e-5)
    assert together["mean"] == pytest.approx(off.mean(), rel=1e-5)
    model, picture = marked(x), seen()
    factor, offset = posed(picture[::2], model[::2])
    far = 1e3 * np.abs(factor * model + offset - picture)[1::2].mean(axis=0) / abs(factor)
    assert predicted == pytest.approx(far, rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sets", "measure", "most"),
    [((), "mean", 0.7), (("calibrate.data[0].markers.predicted=[109]",), "held_out_mean", 1.8)],
)
def test_two_curvatures_of_every_frame_of_the_whole_log(
    call: Any, sets: tuple[str, ...], measure: str, most: float
) -> None:
    """Fitted to all tags; and to all but the tip, which is predicted, camera and all."""
    (tags,) = fitted(call, "limb_log_fit", *sets)
    assert tags["samples"] == 2 * FRAMES * (9 - len(sets))
    assert 1e3 * tags["parts"][-1][measure] / tags["scale"] < most
