"""STL files, text or binary: triangles that each bring their own corners."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...arrays import FloatArray, IntArray, distinct
from ...errors import MeshError
from ...file_text import decode
from ..allowed import PLAIN, Allowed
from ..limits import check_count
from ..mesh import Mesh
from ..validate import Lines, validate
from .groups import GroupBuilder
from .source import load_bytes, parse_float

_HEAD, _FACET = 84, 50
_FRAME = frozenset(("facet", "outer", "endfacet", "endsolid", "color"))


def read_stl(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read an STL mesh; corners at the same place are one node, named solids are groups.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_stl(load_bytes(path), str(path), allowed)


def parse_stl(data: bytes, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the bytes of an STL file; ``where`` names it in messages.

    Raises:
        MeshError: If the bytes are malformed or describe an unusable mesh.
    """
    if allowed.slits:
        raise MeshError(f"{where}: corners at one place are one node in STL files: their slits are lost")
    if data.lstrip()[:5].lower() != b"solid" or _announced(data) == len(data):
        return validate(_joined(_binary(data, where))[0], where, allowed=allowed)
    return _text(decode(data, "replace"), where, allowed)


def _announced(data: bytes) -> int:
    """Length [bytes] of a binary file with as many facets as it announces, -1 if it has no head."""
    return _HEAD + _FACET * int.from_bytes(data[80:_HEAD], "little") if len(data) >= _HEAD else -1


def _binary(data: bytes, where: str) -> FloatArray:
    """Corners, shape (3 T, 3)."""
    # Some programs pad the file.
    if not 0 <= len(data) - _announced(data) < _FACET or len(data) < _HEAD:
        raise MeshError(
            f"{where}: {len(data)} bytes are no STL file: neither text, which starts with 'solid', nor "
            "binary with as many facets as it announces"
        )
    facets = np.frombuffer(data[: _announced(data)], np.uint8, offset=_HEAD).reshape(-1, _FACET)
    check_count(len(facets), "triangles", where)
    # After the normal of each facet follow its corners, single precision.
    corners = np.ascontiguousarray(facets[:, 12:48]).view("<f4").reshape(-1, 3)
    with np.errstate(invalid="ignore"):  # what is not finite is told with its place
        return corners.astype(np.float64)


def _text(text: str, where: str, allowed: Allowed) -> Mesh:
    corners: list[list[float]] = []
    lines: list[int] = []
    members = GroupBuilder()
    solid = ""
    for number, line in enumerate(text.split("\n"), start=1):
        keyword, *tokens = line.split() or [""]
        keyword, place = keyword.lower(), f"{where}:{number}"
        if keyword == "vertex":
            if len(tokens) != 3:
                raise MeshError(f"{place}: vertex with {len(tokens)} numbers; expected x y z")
            corners.append([parse_float(token, place) for token in tokens])
        elif keyword == "endloop":
            if len(corners) != 3 * (len(lines) + 1):
                raise MeshError(f"{place}: a facet with {len(corners) - 3 * len(lines)} corners; expected 3")
            lines.append(number)
            members.add((solid,) if solid else (), (len(lines) - 1,))
        elif keyword == "solid":
            solid = " ".join(tokens)
        elif keyword and keyword not in _FRAME:
            raise MeshError(f"{place}: keyword {keyword[:40]!r}; expected solid, facet, outer loop or vertex")
    if len(corners) != 3 * len(lines):
        raise MeshError(f"{where}: ends within a facet")
    check_count(len(lines), "triangles", where)
    mesh, kept = _joined(np.array(corners, dtype=np.float64).reshape(-1, 3), members.build())
    return validate(mesh, where, Lines(triangles=np.array(lines, dtype=np.int64)[kept]), allowed)


def _joined(corners: FloatArray, groups: dict[str, IntArray] | None = None) -> tuple[Mesh, IntArray]:
    """Triangles of corners, shape (3 T, 3), in which equal corners are one node, and which are kept.

    A facet with two corners at one place is left out: its other two sides lie on each other, and so join
    its neighbours as it did.
    """
    # Zeros of either sign are one place.
    nodes, index = np.unique(corners + 0.0, axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    kept = np.flatnonzero((np.diff(np.sort(triangles, axis=1), axis=1) != 0).all(axis=1))
    place = np.full(len(triangles), -1)
    place[kept] = np.arange(len(kept))
    found = {name: place[group][place[group] >= 0] for name, group in (groups or {}).items()}
    gone = len(triangles) - len(kept)
    what = "facet" if gone == 1 else "facets"
    triangles = triangles[kept]
    mesh = Mesh(
        nodes=nodes,
        triangles=triangles,
        node_groups={name: distinct(triangles[group]) for name, group in found.items()},
        triangle_groups=found,
        notes=(f"{gone} {what} with two corners at one place left out.",) if gone else (),
    )
    return mesh, kept
