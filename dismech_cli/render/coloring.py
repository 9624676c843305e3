"""Colours of bodies and of fields."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..errors import ScenarioError
from ..output.frame import FieldSpec
from ..output.read import Run

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

Colors = NDArray[np.uint8]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """How values become colours, the same in every frame.

    Attributes:
        field: Name of the field.
        label: What the colour bar says.
        lower: Value of the first colour.
        upper: Value of the last colour.
        colormap: Matplotlib name.
    """

    field: str
    label: str
    lower: float
    upper: float
    colormap: str

    def colors(self, values: FloatArray) -> Colors:
        """Colours of ``values`` (count,), shape (count, 3); grey where a value is not finite."""
        from matplotlib import colormaps

        share = (values - self.lower) / (self.upper - self.lower)
        colors = (colormaps[self.colormap](np.nan_to_num(share))[:, :3] * 255).round().astype(np.uint8)
        colors[~np.isfinite(values)] = 160
        return colors


def make_scale(run: Run, name: str) -> Scale:
    """Find the range of a field over the whole run.

    A field of both signs gets a diverging map centred on zero. Vectors are shown by their length.

    Raises:
        ScenarioError: If the run has no such field.
    """
    spec = find_field(run, name)
    lower, upper = np.inf, -np.inf
    for values in run.field(name):
        shown = magnitude(values)
        finite = shown[np.isfinite(shown)]
        lower = min(lower, float(finite.min(initial=np.inf)))
        upper = max(upper, float(finite.max(initial=-np.inf)))
    if not np.isfinite([lower, upper]).all():
        lower, upper = 0.0, 1.0
    signed = lower < 0.0 < upper
    if signed:
        upper = max(-lower, upper)
        lower = -upper
    elif upper - lower <= 1e-12 * max(abs(lower), abs(upper)):
        # A constant field still needs a range.
        lower, upper = lower - (abs(lower) or 1.0) / 2, upper + (abs(upper) or 1.0) / 2
    unit = "" if spec.unit == "1" else f" [{spec.unit}]"
    return Scale(
        field=name,
        label=spec.long_name + unit,
        lower=lower,
        upper=upper,
        colormap="RdBu_r" if signed else "viridis",
    )


def find_field(run: Run, name: str) -> FieldSpec:
    """Look a field up by name.

    Raises:
        ScenarioError: If the run has no such field.
    """
    fields = run.topology.fields
    for spec in fields:
        if spec.name == name:
            return spec
    known = ", ".join(spec.name for spec in fields) or "none; ask for fields under 'output: fields'"
    raise ScenarioError(f"cannot colour by {name!r}: {run.path} has the fields {known}")


def magnitude(values: FloatArray) -> FloatArray:
    """Lengths of vectors, or the scalars themselves; shape (count,)."""
    return values if values.ndim == 1 else np.linalg.norm(values, axis=1)


def body_colors(bodies: IntArray) -> Colors:
    """Colours of bodies by index, shape (count, 3)."""
    return _BODY_COLORS[bodies % len(_BODY_COLORS)]


def cells_to_nodes(values: FloatArray, cells: IntArray, nodes: int) -> FloatArray:
    """Average the values of the cells around each node.

    Args:
        values: One value per cell, shape (C,).
        cells: Node indices, shape (C, k).
        nodes: Number of nodes.

    Returns:
        One value per node, shape (nodes,); zero at nodes without a cell.
    """
    count = np.bincount(cells.ravel(), minlength=nodes)
    total = np.bincount(cells.ravel(), weights=np.repeat(values, cells.shape[1]), minlength=nodes)
    return np.asarray(total / np.maximum(count, 1))


def field_colors(run: Run, scale: Scale, frame: int) -> tuple[Colors, Colors]:
    """Colours of a field at the nodes, for the rods and for the shells; shape (N, 3) each."""
    on_rods, on_shells = _node_values(run, scale.field, frame)
    return scale.colors(on_rods), scale.colors(on_shells)


def _node_values(run: Run, name: str, frame: int) -> tuple[FloatArray, FloatArray]:
    """Values of a field at the nodes, as the rods see them and as the shells see them.

    Returns:
        Two arrays of shape (N,): they differ where a field of cells jumps between rod and shell.
    """
    spec = find_field(run, name)
    values = magnitude(run.field(name)[frame])
    if spec.location == "node":
        return values, values
    topology = run.topology
    edges, nodes = len(topology.edges), len(topology.rest_positions)
    return (
        cells_to_nodes(values[:edges], topology.edges, nodes),
        cells_to_nodes(values[edges:], topology.triangles, nodes),
    )
