"""gmsh files, versions 2.2 and 4.1: lines become rod edges, triangles and quads become shells.

Read here, not through meshio, which cannot read files where only some entities are in a physical
group, takes node number 0 for the last node, and allocates whatever a header claims.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from ..errors import MeshError
from .gmsh_assemble import Names, assemble
from .gmsh_cursor import ByteCursor, Cursor, TextCursor
from .gmsh_sections import (
    Block,
    Entities,
    Nodes,
    read_binary_elements22,
    read_binary_nodes22,
    read_elements41,
    read_entities41,
    read_nodes41,
    read_text_elements22,
    read_text_nodes22,
)
from .mesh import Mesh
from .source import load_bytes

_NAME = re.compile(rb'\s*(\d{1,9})\s+(\d{1,9})\s+"([^"\n]*)"\s*')
_COUNT = re.compile(rb"[ \t]*(\d{1,18})[ \t]*\r?\n")


def read_gmsh(path: Path) -> Mesh:
    """Read a gmsh mesh, version 2.2 or 4.1, text or binary.

    Physical groups become groups of nodes, edges and triangles. A line that is a side of a
    triangle is a boundary, not a rod: it gives its nodes to the group and nothing else.

    Raises:
        MeshError: If the file cannot be read or describes an unusable mesh.
    """
    return parse_gmsh(load_bytes(path), str(path))


def parse_gmsh(data: bytes, where: str) -> Mesh:
    """Parse the bytes of a gmsh file; ``where`` names it in messages.

    Raises:
        MeshError: If the bytes are malformed or describe an unusable mesh.
    """
    return _Parser(data, where).mesh()


@dataclass(slots=True)
class _Parser:
    """Walks from section to section; what a section holds is read by ``gmsh_sections``."""

    data: bytes
    where: str
    version: Literal["2.2", "4.1"] = "4.1"
    binary: bool = False
    size_bytes: Literal[4, 8] = 8
    names: Names = field(default_factory=dict)
    entities: Entities = field(default_factory=dict)
    nodes: Nodes | None = None
    blocks: list[Block] | None = None

    def mesh(self) -> Mesh:
        """Read all sections and put the mesh together."""
        position, formatted = 0, False
        while (found := self._next_section(position)) is not None:
            name, body = found
            if not formatted and name not in ("MeshFormat", "Comments"):
                break
            formatted = formatted or name == "MeshFormat"
            end = self._read(name, body)
            close = self.data.find(b"$End" + name.encode(), end)
            if close < 0:
                raise MeshError(f"{self._place(body)}: section ${name} is not closed by $End{name}")
            position = close + 4 + len(name)
        if not formatted:
            raise MeshError(f"{self.where}:1: no $MeshFormat section; not a gmsh file")
        if self.nodes is None or self.blocks is None:
            raise MeshError(
                f"{self.where}: section ${'Nodes' if self.nodes is None else 'Elements'} is missing"
            )
        return assemble(self.nodes, self.blocks, self.names, self.where)

    def _next_section(self, position: int) -> tuple[str, int] | None:
        """Return the name of the next section and where its body starts."""
        match = re.compile(rb"\$([A-Za-z]{1,40})[ \t]*\r?\n").search(self.data, position)
        return None if match is None else (match[1].decode(), match.end())

    def _place(self, position: int) -> str:
        return f"{self.where}:{self._line(position)}"

    def _line(self, position: int) -> int:
        return self.data.count(b"\n", 0, position) + 1

    def _read(self, name: str, body: int) -> int:
        """Read one section; return where the search for its end may start."""
        match name:
            case "MeshFormat":
                return self._read_format(body)
            case "PhysicalNames":
                return self._read_names(body)
            case "Entities" if self.version == "4.1":
                cursor = self._cursor(name, body)
                self.entities = read_entities41(cursor)
            case "Nodes":
                cursor, count = self._counted(name, body)
                if self.version == "4.1":
                    self.nodes = read_nodes41(cursor)
                elif count is None:
                    self.nodes = read_text_nodes22(cursor)
                else:
                    self.nodes = read_binary_nodes22(cursor, count)
            case "Elements":
                cursor, count = self._counted(name, body)
                if self.version == "4.1":
                    self.blocks = read_elements41(cursor, self.entities)
                elif count is None:
                    self.blocks = read_text_elements22(cursor)
                else:
                    self.blocks = read_binary_elements22(cursor, count)
            case "PartitionedEntities" | "Parametrizations" if self.version == "4.1":
                raise MeshError(f"{self._place(body)}: section ${name}; save an unpartitioned mesh")
            case _:
                # Periodicity, data and comments do not change the mesh.
                return body
        return cursor.position if self.binary else body

    def _cursor(self, name: str, body: int) -> Cursor:
        if self.binary:
            return ByteCursor(self.data, body, self.size_bytes, self.where)
        close = self.data.find(b"$End" + name.encode(), body)
        stop = close if close >= 0 else len(self.data)
        return TextCursor(self.data[body:stop], self._line(body), self.where)

    def _counted(self, name: str, body: int) -> tuple[Cursor, int | None]:
        """Open a section; binary 2.2 sections start with their count in text."""
        if not (self.binary and self.version == "2.2"):
            return self._cursor(name, body), None
        match = _COUNT.match(self.data, body)
        if match is None:
            raise MeshError(f"{self._place(body)}: no count after ${name}")
        return self._cursor(name, match.end()), int(match[1])

    def _read_format(self, body: int) -> int:
        end = self.data.find(b"\n", body) + 1
        fields = self.data[body:end].split()
        if not end or len(fields) != 3 or fields[1] not in (b"0", b"1") or fields[2] not in (b"4", b"8"):
            raise MeshError(f"{self._place(body)}: expected the format as in '4.1 0 8'")
        version = fields[0].decode("ascii", errors="replace")[:20]
        if version in ("2", "2.0", "2.1", "2.2"):
            self.version = "2.2"
        elif version in ("4", "4.1"):
            self.version = "4.1"
        else:
            raise MeshError(f"{self._place(body)}: gmsh format {version}; expected 2.2 or 4.1")
        self.binary = fields[1] == b"1"
        self.size_bytes = 4 if fields[2] == b"4" else 8
        if self.binary and self.data[end : end + 4] != np.array([1], dtype="<i4").tobytes():
            raise MeshError(f"{self._place(end)}: binary gmsh file of the other byte order; save it as text")
        return end

    def _read_names(self, body: int) -> int:
        close = self.data.find(b"$EndPhysicalNames", body)
        rows = self.data[body : close if close >= 0 else len(self.data)].split(b"\n")
        first = self._line(body)
        for number, row in enumerate(rows[1:], start=first + 1):
            if not row.strip():
                continue
            match = _NAME.fullmatch(row)
            if match is None:
                raise MeshError(f'{self.where}:{number}: physical name; expected: dimension tag "name"')
            self.names[int(match[1]), int(match[2])] = match[3].decode("utf-8", errors="replace")
        return body
