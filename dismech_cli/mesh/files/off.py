"""Object File Format: vertices, then faces by vertex numbers; colours and normals are dropped."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...errors import MeshError
from ..allowed import PLAIN, Allowed
from ..limits import check_count
from ..mesh import Mesh
from .cells import Cells, mesh_of_cells
from .source import load_text, parse_float, parse_int

# Texture, colour and normal follow the place; 4 and n mean spaces of other dimension.
_TITLE = re.compile(r"(ST)?(C)?(N)?OFF")


def read_off(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read an OFF mesh, in text.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_off(load_text(path), str(path), allowed)


def parse_off(text: str, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the text of an OFF file; ``where`` names it in messages.

    Raises:
        MeshError: If the text is malformed or describes an unusable mesh.
    """
    rows = _rows(text)
    line, tokens = next(rows, (1, []))
    if not tokens or _TITLE.fullmatch(tokens[0]) is None or tokens[1:2] == ["BINARY"]:
        shown = " ".join(tokens)[:40]
        raise MeshError(f"{where}:{line}: {shown!r}; expected OFF, COFF, NOFF or CNOFF, in text")
    line, tokens = (line, tokens[1:]) if tokens[1:] else next(rows, (line, []))
    counts = [parse_int(token, f"{where}:{line}") for token in tokens]
    if not 2 <= len(counts) <= 3:
        raise MeshError(f"{where}:{line}: {len(counts)} numbers; expected those of vertices, faces and edges")
    n_nodes, n_faces = (
        check_count(n, what, where) for n, what in zip(counts, ("nodes", "faces"), strict=False)
    )
    nodes, extra = [], False
    for line, tokens in _take(rows, n_nodes, "vertices", where):
        if len(tokens) < 3:
            raise MeshError(f"{where}:{line}: vertex with {len(tokens)} numbers; expected x y z")
        nodes.append([parse_float(token, f"{where}:{line}") for token in tokens[:3]])
        extra |= len(tokens) > 3
    corners: list[int] = []
    ends, lines = [], []
    for line, tokens in _take(rows, n_faces, "faces", where):
        size = parse_int(tokens[0], f"{where}:{line}")
        if not 0 <= size < len(tokens):
            raise MeshError(f"{where}:{line}: a face of {size} corners with {len(tokens) - 1} numbers")
        corners += [parse_int(token, f"{where}:{line}") for token in tokens[1 : size + 1]]
        ends.append(len(corners))
        lines.append(line)
        extra |= len(tokens) > size + 1
    return mesh_of_cells(
        np.array(nodes, dtype=np.float64).reshape(-1, 3),
        Cells(
            nodes=np.array(corners, dtype=np.int64),
            ends=np.array(ends, dtype=np.int64),
            lines=np.array(lines, dtype=np.int64),
        ),
        Cells(),
        ("Colours, normals and texture dropped.",) if extra else (),
        where,
        allowed,
    )


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Lines that hold something, as number and tokens."""
    for number, line in enumerate(text.split("\n"), start=1):
        if tokens := line.partition("#")[0].split():
            yield number, tokens


def _take(
    rows: Iterator[tuple[int, list[str]]], count: int, what: str, where: str
) -> Iterator[tuple[int, list[str]]]:
    for found in range(count):
        row = next(rows, None)
        if row is None:
            raise MeshError(f"{where}: {count} {what} announced, {found} follow")
        yield row
