"""The camera log of a robot of two limbs that shape-memory wires bend, and its replay."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

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
    """Factor and offset, both complex, that lay a picture on a model best, or a model on a picture."""
    columns = np.stack((picture.ravel(), np.ones(picture.size)), axis=1)
    factor, offset = np.linalg.lstsq(columns, model.ravel(), rcond=None)[0]
    return complex(factor), complex(offset)
