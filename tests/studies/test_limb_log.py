"""A hardware log replayed: a robot of two limbs that shape-memory wires bend, seen by a camera."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from cli_call import call

from dismech_cli import simulate
from dismech_cli.arrays import FloatArray
from dismech_cli.scenario.load import load_mapping

__all__ = ["call"]

LOG = np.load(Path(__file__).parents[1] / "data" / "limb_log.npz")
FRAMES, EDGE = len(LOG["frames"]), 0.15 / 48
# as measured between tags [px]
SPACING = np.array([77.0, 65.0, 65.0, 73.0, 77.0, 65.0, 55.0, 59.0])


def replay() -> dict[str, Any]:
    """One static step per frame: 2 tan(bend / 48) over the edge at every joint of a limb."""
    t = (np.arange(FRAMES) + 1.0) / FRAMES
    curvature = 2.0 * np.tan(np.radians(LOG["bends"]) / 48.0) / EDGE

    def bent(limb: int, joints: list[int]) -> dict[str, Any]:
        rows = [[0.0, curvature[0, limb]], *np.column_stack((t, curvature[:, limb])).tolist()]
        return {"type": "curvature_1", "rod": "arm", "joints": joints, "value": {"table": rows}}

    line = {"shape": "line", "from": [0, 0, 0], "to": [0.15, 0, 0], "nodes": 49}
    rod = {"type": "rod", "name": "arm", "material": "limb", "radius": 0.01, "generate": line}
    down = {"table": [[0.0, -9.8], [1.0, -9.8]]}  # the weight is there from the first step on
    return {
        "schema_version": 1,
        "name": "limb_log",
        "dimension": 2,
        "materials": {"limb": {"youngs_modulus": 1.793e6, "poisson_ratio": 0.5, "density": 1240.0}},
        "geometry": [rod],
        "motions": [{"type": "clamp", "where": "arm.start", "at": "edge"}],
        "forces": [{"type": "gravity", "acceleration": [0, 0, down]}],
        "actuation": [bent(0, [0, 22]), bent(1, [24, 46])],
        "numerics": {"integrator": {"type": "static", "load_steps": FRAMES}},
    }


def curvatures(x: FloatArray, first: int) -> FloatArray:
    """Mean discrete curvature of a limb, of chords over six edges, shape (F,)."""
    found = []
    for a, b, c in ((0, 6, 12), (6, 12, 18), (12, 18, 24)):
        e, f = x[:, first + b] - x[:, first + a], x[:, first + c] - x[:, first + b]
        turn = np.arctan2(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0], (e * f).sum(axis=1))
        found.append(2.0 * np.tan(0.5 * turn))
    return np.asarray(np.mean(found, axis=0))


def test_the_schedule_gives_the_curvatures_that_it_was_made_for() -> None:
    frames = simulate(load_mapping(replay())).frames[1:]
    x = np.array([frame.positions[:, [0, 2]] for frame in frames])
    off = sum(np.abs(curvatures(x, 24 * limb) - LOG["curvatures"][:, limb]) for limb in (0, 1))
    # the authors stopped at a sum of 2.5e-3
    assert off.max() < 1.05 * 2.5e-3


def test_a_camera_placed_by_even_frames_predicts_the_odd_ones(call: Any) -> None:
    names = ["t", *(f"{letter}_{i}" for i in range(101, 110) for letter in "uv")]
    rows = np.column_stack(((np.arange(FRAMES) + 1.0) / FRAMES, LOG["tags"]))
    Path("tags.csv").write_text(
        "\n".join([",".join(names), *(",".join(f"{x:.12g}" for x in row) for row in rows)])
    )
    arcs = 0.15 * np.concatenate(([0.0], np.cumsum(SPACING))) / SPACING.sum()
    columns = {"x": "u_{i}", "z": "v_{i}"}
    markers = {"of": "arm", "arc": arcs.tolist(), "columns": columns, "first": 101, "camera": True}
    table = {"file": "tags.csv", "time": "t", "unit": "1", "hold_out": 2, "markers": markers}
    Path("log.yaml").write_text(json.dumps(replay() | {"calibrate": {"fit": [], "data": [table]}}))
    done = call("calibrate", "log.yaml", "-o", "fit", "--json", "-q")
    assert done.code == 0, done.stderr
    (found,) = json.loads(done.stdout)["data"]
    # of the whole log: 0.2795 mm per pixel, and 1.8 mm between tags and model in the mean
    assert abs(1e3 / found["scale"] - 0.2795) < 0.005
    assert 1e3 * found["held_out_rms"] / found["scale"] < 3.0
