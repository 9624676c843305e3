"""A run as one binary glTF file: the surfaces of all bodies, moving, for Blender, slides and web pages.

The first frame is the shape; every later one is a morph target, and an animation blends from each to the
next. Reference: Khronos, "glTF 2.0 specification", 2021.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from ..errors import OutputError
from ..output.durable import staged
from ..output.read import Run
from .coloring import Painter
from .parts import Part, make_parts
from .timeline import stored

MOST_FRAMES = 100
"""Viewers hold every morph target in memory."""

_SIDES = 12
_FLOAT, _UNSIGNED, _BYTE = 5126, 5125, 5121
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
_VERTICES, _INDICES = 34962, 34963
_QUARTER = 0.5**0.5


def write_glb(run: Run, file: Path) -> int:
    """Write the whole frames of a run, at most :data:`MOST_FRAMES` of them in even steps.

    Returns:
        The number of frames written.

    Raises:
        OutputError: If no frame is whole, or the file cannot be written.
    """
    frames = [frame for frame in range(len(run)) if np.isfinite(run.positions[frame]).all()]
    if not frames:
        raise OutputError(f"{run.path} has no whole frame to export")
    if len(frames) > MOST_FRAMES:
        frames = [frames[k] for k in np.linspace(0, len(frames) - 1, MOST_FRAMES).round().astype(int)]
    positions = [run.positions[frame] for frame in frames]
    times = run.t[frames]
    painter = Painter(run.topology, [], None, None, {}, "stored")
    binary = _Binary()
    meshes, nodes, channels, samplers = [], [], [], []
    for part in make_parts(run, 0.0, _SIDES):
        colors = painter.colors(part, stored(times, 0))
        origin = positions[0].mean(axis=0)
        meshes.append(_mesh(binary, part, times, positions, origin, colors))
        nodes.append({"mesh": len(meshes) - 1, "translation": origin.tolist()})
        if len(frames) > 1:
            samplers.append(_sampler(binary, times))
            channels.append(
                {"sampler": len(samplers) - 1, "target": {"node": len(nodes) - 1, "path": "weights"}}
            )
    # glTF has y upwards
    upright = [-_QUARTER, 0.0, 0.0, _QUARTER]
    nodes.append({"name": run.path.name, "rotation": upright, "children": list(range(len(nodes)))})
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "dismech"},
        "scene": 0,
        "scenes": [{"nodes": [len(nodes) - 1]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.55}}],
        "accessors": binary.accessors,
        "bufferViews": binary.views,
        "buffers": [{"byteLength": len(binary.data)}],
    }
    if channels:
        document["animations"] = [{"name": "run", "channels": channels, "samplers": samplers}]
    with staged(file) as temporary:
        temporary.write_bytes(_container(document, bytes(binary.data)))
    return len(frames)


class _Binary:
    """Arrays one after another, and where each is."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(
        self,
        values: NDArray[Any],
        kind: int,
        *,
        target: int | None = None,
        bounds: bool = False,
        **more: bool,
    ) -> int:
        """Append an array, shape (count,) or (count, components); returns the number of its accessor."""
        values = np.ascontiguousarray(values)
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.views.append(view if target is None else {**view, "target": target})
        self.data += values.tobytes()
        self.data += bytes(-len(self.data) % 4)
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": kind,
            "count": len(values),
            "type": _KINDS[1 if values.ndim == 1 else values.shape[1]],
            **more,
        }
        if bounds:
            low, high = np.atleast_1d(values.min(axis=0)), np.atleast_1d(values.max(axis=0))
            accessor |= {"min": low.tolist(), "max": high.tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _mesh(
    binary: _Binary,
    part: Part,
    times: FloatArray,
    positions: Sequence[FloatArray],
    origin: FloatArray,
    colors: NDArray[np.uint8],
) -> dict[str, Any]:
    """The surface of a part in the first frame, and how it differs in the others."""
    placed = [part.place(float(t), at) for t, at in zip(times, positions, strict=True)]
    first = [(placed[0][0] - origin).astype(np.float32), placed[0][1].astype(np.float32)]
    # vertex colours are linear, ours are those of a screen
    linear = np.column_stack((_linear(colors), np.full(len(colors), 255, dtype=np.uint8)))
    attributes = {
        "POSITION": binary.add(first[0], _FLOAT, target=_VERTICES, bounds=True),
        "NORMAL": binary.add(first[1], _FLOAT, target=_VERTICES),
        "COLOR_0": binary.add(linear, _BYTE, target=_VERTICES, normalized=True),
    }
    indices = binary.add(part.faces.reshape(-1).astype(np.uint32), _UNSIGNED, target=_INDICES)
    targets = [
        {
            "POSITION": binary.add((at - origin - first[0]).astype(np.float32), _FLOAT, bounds=True),
            "NORMAL": binary.add((normals - first[1]).astype(np.float32), _FLOAT),
        }
        for at, normals in placed[1:]
    ]
    primitive = {"attributes": attributes, "indices": indices, "material": 0}
    if not targets:
        return {"primitives": [primitive]}
    return {"primitives": [{**primitive, "targets": targets}], "weights": [0.0] * len(targets)}


def _linear(colors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    share = colors / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return (linear * 255).round().astype(np.uint8)


def _sampler(binary: _Binary, times: FloatArray) -> dict[str, Any]:
    """At the time of each frame its own target counts alone; the first frame has none."""
    weights = np.eye(len(times), dtype=np.float32)[:, 1:].reshape(-1)
    return {
        "input": binary.add((times - times[0]).astype(np.float32), _FLOAT, bounds=True),
        "output": binary.add(weights, _FLOAT),
        "interpolation": "LINEAR",
    }


def _container(document: dict[str, Any], data: bytes) -> bytes:
    """The two chunks of a GLB file."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
