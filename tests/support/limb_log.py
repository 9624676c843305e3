"""The camera log of a robot of two limbs that shape-memory wires bend, and its replay."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dismech_cli.arrays import FloatArray


class Log(NamedTuple):
    """All frames of the log.

    Attributes:
        tags: Pixels of nine tags, across and down, from base to tip, shape (169, 18).
        bends: Bend of each limb that the authors of the log found for it [deg], shape (169, 2).
        curvatures: Mean discrete curvature of each limb that the camera saw [1], shape (169, 2).
    """

    tags: FloatArray
    bends: FloatArray
    curvatures: FloatArray


with np.load(Path(__file__).parents[1] / "data" / "limb_log.npz") as _log:
    LOG = Log(_log["tags"], _log["bends"], _log["curvatures"])
FRAMES, LENGTH, EDGES = len(LOG.tags), 0.15, 48
# as measured between tags [px]
_SPACING = np.array([77.0, 65.0, 65.0, 73.0, 77.0, 65.0, 55.0, 59.0])
ARCS = LENGTH * np.concatenate(([0.0], np.cumsum(_SPACING))) / _SPACING.sum()


def replay(curvature: FloatArray | None = None) -> dict[str, Any]:
    """One static step per frame, under curvatures (F, 2) of every joint of each limb [1/m].

    Without any they are those that were published: 2 tan(bend / 48) over the edge.
    """
    if curvature is None:
        curvature = 2.0 * np.tan(np.radians(LOG.bends) / EDGES) / (LENGTH / EDGES)
    frames = len(curvature)
    t = (np.arange(frames) + 1.0) / frames

    def bent(limb: int, joints: list[int]) -> dict[str, Any]:
        rows = np.column_stack((t, curvature[:, limb])).tolist()
        return {"type": "curvature_1", "rod": "arm", "joints": joints, "value": {"table": rows}}

    line = {"shape": "line", "from": [0, 0, 0], "to": [LENGTH, 0, 0], "nodes": EDGES + 1}
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
        "numerics": {"integrator": {"type": "static", "load_steps": frames}},
    }


def table(path: Path, tags: FloatArray, *, count: int = 9, **keys: Any) -> dict[str, Any]:
    """A table of the first tags of frames (F, 18), written to a file, as a fit takes it."""
    names = ["t", *(f"{letter}_{i}" for i in range(101, 101 + count) for letter in "uv")]
    t = (np.arange(len(tags)) + 1.0) / len(tags)
    rows = np.column_stack((t, tags[:, : 2 * count]))
    path.write_text("\n".join([",".join(names), *(",".join(f"{x:.12g}" for x in row) for row in rows)]))
    columns = {"x": "u_{i}", "z": "v_{i}"}
    markers = {"of": "arm", "arc": ARCS[:count].tolist(), "columns": columns, "first": 101, "camera": True}
    return {"file": path.name, "time": "t", "unit": "1", "markers": markers} | keys


def curvatures(x: FloatArray) -> FloatArray:
    """Mean of three discrete curvatures 2 tan(phi / 2) on every sixth node of each limb, shape (F, 2).

    Args:
        x: Places of the nodes in the plane, shape (F, 49, 2).
    """
    found = []
    for first in (0, 24):
        e = np.diff(x[:, first : first + 25 : 6], axis=1)
        turn = e[:, :-1, 0] * e[:, 1:, 1] - e[:, :-1, 1] * e[:, 1:, 0]
        size = np.linalg.norm(e, axis=2)
        along = (e[:, :-1] * e[:, 1:]).sum(axis=2)
        found.append((2.0 * turn / (size[:, :-1] * size[:, 1:] + along)).mean(axis=1))
    return np.stack(found, axis=1)


def marked(x: FloatArray) -> FloatArray:
    """Where the tags of a model are in its plane, as complex numbers, shape (F, 9)."""
    node = ARCS / (LENGTH / EDGES)
    return np.array(
        [
            np.interp(node, np.arange(EDGES + 1), one[:, 0])
            + 1j * np.interp(node, np.arange(EDGES + 1), one[:, 1])
            for one in x
        ]
    )


def seen() -> FloatArray:
    """The tags in the picture, up counted upwards, as complex numbers, shape (F, 9)."""
    return np.asarray(LOG.tags[:, 0::2] - 1j * LOG.tags[:, 1::2])


def posed(model: FloatArray, picture: FloatArray) -> tuple[complex, complex]:
    """Factor and offset, both complex, that lay a picture on a model best."""
    columns = np.stack((picture.ravel(), np.ones(picture.size)), axis=1)
    factor, offset = np.linalg.lstsq(columns, model.ravel(), rcond=None)[0]
    return complex(factor), complex(offset)


def main() -> None:
    """Write the scenes of the docs into the folder named on the command line.

    ``published.yaml`` fits the camera alone to even frames, ``all.yaml`` two curvatures of each frame to all
    tags, ``no_tip.yaml`` the same without the tag at the tip.
    """
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    bends = [{"of": f"actuation[{limb}].value.table[*][1]"} for limb in (0, 1)]
    scenes: dict[str, tuple[int, list[dict[str, str]], dict[str, int]]] = {
        "published": (9, [], {"hold_out": 2}),
        "all": (9, bends, {}),
        "no_tip": (8, bends, {}),
    }
    for name, (count, fit, keys) in scenes.items():
        data = table(folder / f"{name}.csv", LOG.tags, count=count, **keys)
        deck = replay() | {"name": name, "calibrate": {"fit": fit, "data": [data]}}
        (folder / f"{name}.yaml").write_text(json.dumps(deck), encoding="utf-8")


if __name__ == "__main__":
    main()
