"""The DiSMech text format: sections ``*Nodes``, ``*Edges``, ``*Triangles`` of comma-separated rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...arrays import IntArray
from ...errors import MeshError
from ..allowed import PLAIN, Allowed
from ..limits import check_count
from ..mesh import Mesh
from ..validate import Lines, validate
from .source import in_space, load_text, parse_float, parse_int

_WIDTH = {"nodes": 3, "edges": 2, "triangles": 3}
_SECTIONS = {
    "nodes": "nodes",
    "rodnodes": "nodes",
    "shellnodes": "nodes",
    "edges": "edges",
    "rodedges": "edges",
    "triangles": "triangles",
    "facenodes": "triangles",
}
"""Rows of each section, by its name in lower case: older files call them otherwise."""


def read_text(path: Path, allowed: Allowed = PLAIN) -> Mesh:
    """Read a DiSMech text mesh.

    Node numbers count from 1; sections come in any order, ``#`` starts a comment, blank lines are
    skipped.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_text(load_text(path), str(path), allowed)


def parse_text(text: str, where: str, allowed: Allowed = PLAIN) -> Mesh:
    """Parse the text of a DiSMech mesh; ``where`` names it in messages.

    Raises:
        MeshError: If the text is malformed or describes an unusable mesh.
    """
    rows: dict[str, list[list[str]]] = {name: [] for name in _WIDTH}
    lines: dict[str, list[int]] = {name: [] for name in _WIDTH}
    section, nodes_of = "", ""
    for number, line in enumerate(text.split("\n"), start=1):
        entry = line.partition("#")[0].strip()
        if not entry:
            continue
        if entry.startswith("*"):
            name = entry[1:].strip().lower()
            if name not in _SECTIONS:
                raise MeshError(
                    f"{where}:{number}: section {entry[:40]!r}; expected *Nodes, *Edges or *Triangles"
                )
            section = _SECTIONS[name]
            if section == "nodes":
                if nodes_of not in ("", name):
                    raise MeshError(
                        f"{where}:{number}: nodes in *{nodes_of} and in {entry[:40]}: which of them a number "
                        "means is open; give all in one *Nodes and renumber"
                    )
                nodes_of = name
            continue
        if not section:
            raise MeshError(
                f"{where}:{number}: data before the first section; expected *Nodes, *Edges or *Triangles"
            )
        tokens = [token.strip() for token in entry.split(",")]
        if len(tokens) != _WIDTH[section] and (section, len(tokens)) != ("nodes", 2):
            raise MeshError(
                f"{where}:{number}: {len(tokens)} comma-separated entries in *{section.capitalize()}; "
                f"expected {_WIDTH[section]}"
            )
        rows[section].append(tokens)
        lines[section].append(number)
    for name, entries in rows.items():
        check_count(len(entries), name, where)
    points = [
        [parse_float(token, f"{where}:{line}") for token in row]
        for row, line in zip(rows["nodes"], lines["nodes"], strict=True)
    ]
    nodes, notes = in_space(points, lines["nodes"], where)
    mesh = Mesh(
        nodes=nodes,
        edges=_indices(rows["edges"], lines["edges"], 2, where),
        triangles=_indices(rows["triangles"], lines["triangles"], 3, where),
        notes=notes,
    )
    return validate(
        mesh,
        where,
        Lines(
            nodes=np.array(lines["nodes"], dtype=np.int64),
            edges=np.array(lines["edges"], dtype=np.int64),
            triangles=np.array(lines["triangles"], dtype=np.int64),
        ),
        allowed,
    )


def _indices(rows: list[list[str]], lines: list[int], width: int, where: str) -> IntArray:
    """Convert 1-based rows of node numbers to 0-based indices, shape (len(rows), width)."""
    numbers = [
        [parse_int(token, f"{where}:{line}") for token in row] for row, line in zip(rows, lines, strict=True)
    ]
    return np.array(numbers, dtype=np.int64).reshape(-1, width) - 1
