"""What a writer receives: the fixed topology once, then one frame after another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Literal, Protocol

from ..arrays import FloatArray, IntArray
from ..frozen import frozen

Location = Literal["node", "cell"]


@frozen(kw_only=True)
class FieldSpec:
    """One field that every frame of a run carries.

    Attributes:
        name: Key in :attr:`Frame.fields`, e.g. ``"velocity"`` or ``"curvature"``.
        unit: SI unit, e.g. ``"m/s"``; ``"1"`` if dimensionless.
        long_name: One human phrase.
        location: ``node`` (N values) or ``cell`` (rod edges first, then triangles: E + T values).
        components: 1 for scalars, 3 for vectors.
    """

    name: str
    unit: str
    long_name: str
    location: Location
    components: int = 1


@frozen(kw_only=True)
class Topology:
    """What does not change during a run.

    Attributes:
        rest_positions: Rest positions [m], shape (N, 3).
        edges: Rod edges, shape (E, 2).
        triangles: Shell triangles, shape (T, 3).
        edge_radius: Drawing radius of each rod edge [m], shape (E,).
        triangle_thickness: Shell thickness [m], shape (T,).
        bodies: Names of the bodies.
        edge_body: Index into ``bodies``, shape (E,).
        triangle_body: Index into ``bodies``, shape (T,).
        fields: Fields carried by each frame.
        state: Names, shapes and units of the raw state arrays of :attr:`Frame.state`.
        scalars: Names and units of :attr:`Frame.scalars`, in column order.
    """

    rest_positions: FloatArray
    edges: IntArray
    triangles: IntArray
    edge_radius: FloatArray
    triangle_thickness: FloatArray
    bodies: tuple[str, ...]
    edge_body: IntArray
    triangle_body: IntArray
    fields: tuple[FieldSpec, ...] = ()
    state: Mapping[str, tuple[tuple[int, ...], str]] = field(default_factory=dict)
    scalars: Mapping[str, str] = field(default_factory=dict)


@frozen(kw_only=True)
class Frame:
    """The robot at one time.

    Attributes:
        index: Number of the frame, from 0.
        t: Time [s].
        positions: Node positions [m], shape (N, 3), in planar scenes too.
        fields: One array per :class:`FieldSpec`, shape (count,) or (count, components).
        state: Raw state arrays, e.g. ``theta`` (E,).
        scalars: The row of the scalar table at this time.
    """

    index: int
    t: float
    positions: FloatArray
    fields: Mapping[str, FloatArray] = field(default_factory=dict)
    state: Mapping[str, FloatArray] = field(default_factory=dict)
    scalars: Mapping[str, float] = field(default_factory=dict)


class Writer(Protocol):
    """Receives the topology once, then all frames in order, durable when ``write`` returns."""

    def open(self, topology: Topology, metadata: Mapping[str, str]) -> None:
        """Create the file or folder; raise ``OutputError`` if that is impossible."""

    def write(self, *frames: Frame) -> None:
        """Append frames; raise ``OutputError`` if one could not be made durable."""

    def close(self) -> None:
        """Finish; safe to call twice."""
