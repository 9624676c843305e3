"""Colours of bodies and of fields."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..errors import ScenarioError
from ..frozen import frozen
from ..output.frame import FieldSpec, Topology
from ..output.read import Run
from ..words import hint
from .parts import Part
from .settings import Background, Ends, Known, Rgb
from .shell_solid import cells_to_nodes
from .timeline import Frames, Shot

# Muted and of similar lightness, told apart by colour-blind eyes too.
_BODY_COLORS = np.array(
    [
        [0x2E, 0x7D, 0xA6],
        [0xE0, 0x7A, 0x4F],
        [0x5F, 0xA8, 0x8B],
        [0xD9, 0xA4, 0x41],
        [0x8A, 0x6F, 0xB0],
        [0xC9, 0x6A, 0x8C],
    ],
    dtype=np.uint8,
)
_START, _END = (0x24, 0x2C, 0x38), (0xD6, 0x45, 0x2B)
_NOT_FINITE = 160
_UNKNOWN = 178
_PALE = 0.72  # share of the background in a ghost

PAPER: Mapping[Background, Rgb] = {
    "white": (255, 255, 255),
    "grey": (236, 239, 242),
    "dark": (30, 34, 42),
    "transparent": (255, 255, 255),
}
"""Colours of backgrounds; what is transparent is drawn as on white paper."""

INK: Mapping[Background, Rgb] = {
    "white": (38, 46, 56),
    "grey": (38, 46, 56),
    "dark": (222, 228, 236),
    "transparent": (38, 46, 56),
}
"""Colours of labels."""

Colors = NDArray[np.uint8]


@frozen(kw_only=True)
class Scale:
    """How values become colours, the same in every frame.

    Attributes:
        label: What the colour bar says.
        lower: Value of the first colour.
        upper: Value of the last colour.
        least: Least value of the run.
        largest: Largest value of the run.
        table: Colours from the first to the last, shape (256, 3).
    """

    label: str
    lower: float
    upper: float
    least: float
    largest: float
    table: Colors

    def colors(self, values: FloatArray) -> Colors:
        """Colours of ``values`` (count,), shape (count, 3); grey where a value is not finite."""
        # in halves: the difference of two numbers may be too large to be one
        share = (values / 2 - self.lower / 2) / (self.upper / 2 - self.lower / 2)
        colors = self.table[np.clip(np.nan_to_num(share) * 255.0 + 0.5, 0, 255).astype(np.int64)]
        colors[~np.isfinite(values)] = _NOT_FINITE
        return colors


@frozen(kw_only=True)
class Field:
    """A field of every frame, stored by the run or computed after it.

    Attributes:
        spec: Its description.
        file: Where its values lie if the run does not have them, a NumPy file of shape (F, ...).
    """

    spec: FieldSpec
    file: Path | None = None

    def values(self, run: Run) -> Frames:
        """Values of each frame."""
        if self.file is None:
            return run.field(self.spec.name)
        computed: Frames = np.load(self.file, mmap_mode="r")
        return computed


def stored_field(run: Run, name: str) -> Field:
    """A field of a run by name.

    Raises:
        ScenarioError: If the run does not have it.
    """
    fields = {spec.name: spec for spec in run.topology.fields}
    if name not in fields:
        known = ", ".join(fields) or "none; ask for fields under 'output: fields'"
        raise ScenarioError(
            f"cannot colour by {name!r}{hint(name, fields)}: {run.path} has the fields {known}"
        )
    return Field(spec=fields[name])


def magnitude(values: FloatArray) -> FloatArray:
    """Lengths of vectors, or the scalars themselves; shape (count,)."""
    return values if values.ndim == 1 else np.linalg.norm(values, axis=1)


class Painter:
    """Gives every vertex its colour: that of its body, or that of the field."""

    def __init__(
        self,
        topology: Topology,
        values: Frames,
        field: Field | None,
        scale: Scale | None,
        colors: Mapping[int, Rgb],
        ends: Ends,
        known: Known = "all",
    ) -> None:
        """Prepare what is the same in all frames.

        Args:
            topology: Of the run.
            values: Of the field in each frame; empty without one.
            field: The field, or None.
            scale: Its colours.
            colors: Of bodies, in place of the usual ones.
            ends: What ends of rods look like.
            known: What the field is of.
        """
        self._topology = topology
        self._values = values
        self._field = field
        self._scale = scale
        self._bodies = bodies = _BODY_COLORS[np.arange(len(topology.bodies)) % len(_BODY_COLORS)]
        for body, color in colors.items():
            bodies[body] = color
        self._ends = ends
        self._known = known
        starts, stops, self._open, self._beside = find_ends(topology.edges)
        self._marks = ((starts, _START), (stops, _END)) if ends == "marked" else ()

    def colors(self, part: Part, shot: Shot) -> Colors:
        """Colours of the vertices of a part, shape (V, 3)."""
        unknown = self._known == ("rods" if part.meshed else "shells")
        own = part.color or ((_UNKNOWN,) * 3 if unknown and self._scale is not None else None)
        if own is not None:
            return np.tile(np.array(own, dtype=np.uint8), (len(part.source), 1))
        if self._scale is None:
            colors = self._bodies[part.body]
        else:
            colors = self._scale.colors(self._node_values(shot, part.meshed))[part.source]
        for nodes, color in () if part.meshed else self._marks:
            colors[np.isin(part.source, nodes)] = color
        return colors

    def _node_values(self, shot: Shot, on_shells: bool) -> FloatArray:
        """The field at the nodes, as the rods or the shells see it: cells may jump between them."""
        assert self._field is not None
        topology, values = self._topology, magnitude(shot.between(self._values))
        edges, nodes = len(topology.edges), len(topology.rest_positions)
        if self._field.spec.location == "node":
            return self._finished(values)
        if on_shells:
            return cells_to_nodes(values[edges:], topology.triangles, nodes)
        return cells_to_nodes(values[:edges], topology.edges, nodes)

    def _finished(self, values: FloatArray) -> FloatArray:
        """Ends have no joint and thus no curvature, which is stored as zero: that beside them is shown."""
        if self._ends == "stored" or self._field is None or self._field.spec.components > 1:
            return values
        bare = values[self._open] == 0.0
        extended = values.copy()
        extended[self._open[bare]] = values[self._beside[bare]]
        return extended


def find_ends(edges: IntArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Nodes of one edge only: where it begins there, where it ends there; both, and the nodes beside them."""
    count = np.bincount(edges.ravel(), minlength=int(edges.max(initial=-1)) + 1)
    first, second = (edges[count[edges[:, k]] == 1] for k in (0, 1))
    return (
        first[:, 0],
        second[:, 1],
        np.concatenate((first[:, 0], second[:, 1])),
        np.concatenate((first[:, 1], second[:, 0])),
    )


def paled(colors: Colors | FloatArray, background: Background) -> Colors:
    """Colours of an earlier shape, nearly those of the background."""
    mixed = (1.0 - _PALE) * colors + _PALE * np.array(PAPER[background])
    return mixed.round().astype(np.uint8)
